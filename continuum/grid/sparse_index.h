// A map from dense indices over the domain to compact ones, in pages: it takes memory, and time to make, for what is in
// use, and hardly any for the rest of the domain.
#pragma once

#include <cstddef>
#include <vector>

namespace talus {

class SparseIndex {
 public:
  SparseIndex() = default;
  /// Of dense indices below `size`; each maps to -1.
  explicit SparseIndex(std::size_t size) { reset(size); }

  /// The same, in the memory it has.
  void reset(std::size_t size) {
    size_ = size;
    page_.assign((size + page_size - 1) / page_size, 0);
    values_.assign(page_size, -1);
  }

  std::size_t size() const { return size_; }
  int operator[](std::size_t dense) const {
    return values_[page_[dense / page_size] + static_cast<unsigned>(dense % page_size)];
  }
  void set(std::size_t dense, int value) {
    unsigned& page = page_[dense / page_size];
    if (page == 0) {
      page = static_cast<unsigned>(values_.size());
      values_.resize(values_.size() + page_size, -1);
    }
    values_[page + static_cast<unsigned>(dense % page_size)] = value;
  }

 private:
  static constexpr std::size_t page_size = 128;
  std::size_t size_ = 0;
  std::vector<unsigned> page_;  // where its values start; 0 for the page that is all -1
  std::vector<int> values_;
};

}  // namespace talus
