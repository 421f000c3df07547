// Reading in a child process, for libraries that crash, hang or overwrite memory over damaged files: none of them runs in this one, which
// takes plain bytes from a pipe.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <type_traits>

namespace talus::analysis {

/// The child's end of the pipe.
class Sink {
 public:
  explicit Sink(int descriptor) : descriptor_(descriptor) {}
  void put(const void* bytes, std::size_t size) const;
  template <class Value>
  void put(const Value& value) const {
    static_assert(std::is_trivially_copyable_v<Value>);
    put(&value, sizeof value);
  }
  /// Their count, and they.
  template <class Value>
  void put_list(const Value* values, std::size_t count) const {
    put(count);
    put(values, count * sizeof(Value));
  }

 private:
  int descriptor_;
};

/// This process's end.
class Source {
 public:
  explicit Source(int descriptor) : descriptor_(descriptor) {}
  void take(void* bytes, std::size_t size) const;
  template <class Value>
  Value take() const {
    static_assert(std::is_trivially_copyable_v<Value>);
    Value value{};
    take(&value, sizeof value);
    return value;
  }
  /// Of a list, whose values are to be taken next. Throws std::bad_alloc where no memory could hold them.
  std::size_t take_count() const;

 private:
  int descriptor_;
};

/// Says what the child threw.
struct ChildRefused : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The child crashed, or took too long.
struct ChildDied : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Seconds of processor time that reading a file may take: far more than it does.
double reading_patience(const std::filesystem::path& file);

/// Runs `give` in a copy of this process, within so many seconds of processor time, and `take` here, on what it puts into its sink. Throws
/// ChildRefused, ChildDied, what `take` throws, std::system_error where no process can be made.
void read_in_child(const std::function<void(const Sink&)>& give,
                   const std::function<void(const Source&)>& take, double seconds);

}  // namespace talus::analysis
