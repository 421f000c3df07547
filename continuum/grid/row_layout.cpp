#include "continuum/grid/row_layout.h"

#include <algorithm>
#include <limits>

namespace talus {
namespace {

constexpr int margin = 2;             // nodes kept at either end of a row
constexpr int nodes_per_task = 1024;  // small enough to share out, large enough to be worth it

struct Range {
  int low = std::numeric_limits<int>::max(),
      high = std::numeric_limits<int>::min();  // along x, high excluded

  bool empty() const { return low >= high; }
  void include(const Range& other) {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
};

class Builder {
 public:
  explicit Builder(const ActiveRegion& region) : region_(region), n_(region.grid.cells) {
    width_ = n_[1] + 1;
    depth_ = n_[2] + 1;
  }

  RowLayout build() {
    find_ranges();
    place_rows();
    connect_rows();
    share_out();
    number_items();
    return std::move(layout_);
  }

 private:
  /// Which row (j, k) is, wrapped on periodic axes; -1 outside.
  int row_at(int j, int k) const {
    j = region_.grid.wrapped(1, j);
    k = region_.grid.wrapped(2, k);
    return j < 0 || k < 0 || j >= width_ || k >= depth_ ? -1 : j + width_ * k;
  }
  bool periodic_x() const { return region_.grid.periodic[0]; }
  /// Rows behind the last cells exist only where the axis is not periodic.
  bool exists(int row) const { return row_at(row % width_, row / width_) == row; }

  /// Runs f(row at an offset) over the offsets given.
  template <class Function>
  void for_neighbours(int row, int low, int high, Function&& f) const {
    for (int dk = low; dk <= high; ++dk) {
      for (int dj = low; dj <= high; ++dj) {
        const int other = row_at(row % width_ + dj, row / width_ + dk);
        if (other >= 0) f(dj, dk, other);
      }
    }
  }

  void find_ranges() {
    const auto count = static_cast<std::size_t>(width_ * depth_);
    cells_.resize(count);
    for (const int dense : region_.dense_of_cell) {
      const Eigen::Vector3i at = region_.grid.cell_of_index(dense);
      cells_[static_cast<std::size_t>(at[1] + width_ * at[2])].include({at[0], at[0] + 1});
    }
    items_.resize(count);
    stored_.resize(count);
    for (int row = 0; row < width_ * depth_; ++row) {
      if (!exists(row)) continue;
      Range& items = items_[static_cast<std::size_t>(row)];
      for_neighbours(row, -1, 0,
                     [&](int, int, int other) { items.include(cells_[static_cast<std::size_t>(other)]); });
      if (items.empty()) continue;
      if (periodic_x())
        items = {0, n_[0]};
      else
        ++items.high;  // the upper faces of the last cells
    }
    for (int row = 0; row < width_ * depth_; ++row) {
      if (!exists(row)) continue;
      Range& stored = stored_[static_cast<std::size_t>(row)];
      for_neighbours(row, -1, 1,
                     [&](int, int, int other) { stored.include(items_[static_cast<std::size_t>(other)]); });
    }
  }

  /// Where a range that begins at a node ends, padded.
  static int padded(int begin, const Range& range) {
    return begin + (range.high - range.low + row_padding - 1) / row_padding * row_padding;
  }

  void place_rows() {
    row_number_.assign(items_.size(), 0);
    int longest = 0;
    for (const Range& stored : stored_) {
      if (!stored.empty()) longest = std::max(longest, stored.high - stored.low);
    }
    int next = longest + 2 * margin + row_padding - 1;
    layout_.rows.push_back({0, next, 0, 0, 0, 0, {}, {}});
    place_.push_back(-1);
    origin_.push_back(0);
    for (std::size_t row = 0; row < items_.size(); ++row) {
      if (stored_[row].empty()) continue;
      const Range stored{stored_[row].low - margin, stored_[row].high + margin + row_padding - 1};
      row_number_[row] = static_cast<int>(layout_.rows.size());
      place_.push_back(static_cast<int>(row));
      Row placed{next, next + stored.high - stored.low, next, next, next, next, {}, {}};
      if (!items_[row].empty()) {
        placed.items_begin = next + items_[row].low - stored.low;
        placed.items_end = padded(placed.items_begin, items_[row]);
      }
      if (!cells_[row].empty()) {
        placed.cells_begin = next + cells_[row].low - stored.low;
        placed.cells_end = padded(placed.cells_begin, cells_[row]);
      }
      layout_.rows.push_back(placed);
      origin_.push_back(next - stored.low);
      next = placed.end;
    }
    layout_.nodes = next;
    layout_.period = periodic_x() ? n_[0] : 0;
  }

  void connect_rows() {
    for (std::size_t r = 1; r < layout_.rows.size(); ++r) {
      Row& row = layout_.rows[r];
      for (auto& line : row.step) line.fill(-row.begin);
      for_neighbours(place_[r], -1, 1, [&](int dj, int dk, int other) {
        const int number = row_number_[static_cast<std::size_t>(other)];
        if (number == 0) return;
        row.neighbour[static_cast<std::size_t>(dj + 1)][static_cast<std::size_t>(dk + 1)] = number;
        row.step[static_cast<std::size_t>(dj + 1)][static_cast<std::size_t>(dk + 1)] =
            origin_[static_cast<std::size_t>(number)] - origin_[r];
      });
    }
  }

  void share_out() {
    int work = 0;
    for (std::size_t r = 0; r < layout_.rows.size(); ++r) {
      if (r == 0 || work >= nodes_per_task) {
        layout_.first_row_of_task.push_back(static_cast<int>(r));
        work = 0;
      }
      work += layout_.rows[r].items_end - layout_.rows[r].items_begin;
    }
    layout_.first_row_of_task.push_back(static_cast<int>(layout_.rows.size()));
  }

  struct Spot {
    std::size_t row;
    int node;
  };
  Spot up(const Spot& spot, int axis) const {
    const Row& row = layout_.rows[spot.row];
    if (axis == 0) {
      const int x = spot.node + 1 - origin_[spot.row];
      return {spot.row, layout_.period > 0 && x == layout_.period ? origin_[spot.row] : spot.node + 1};
    }
    const int at = place_[spot.row];
    const int other = row_at(at % width_ + (axis == 1), at / width_ + (axis == 2));
    return {static_cast<std::size_t>(row_number_[static_cast<std::size_t>(other)]),
            spot.node + (axis == 1 ? row.to(1, 0) : row.to(0, 1))};
  }

  /// Cells know their faces, faces their edges.
  void number_items() {
    layout_.node_of_cell.resize(region_.dense_of_cell.size());
    layout_.row_of_cell.resize(region_.dense_of_cell.size());
    layout_.node_of_face.assign(static_cast<std::size_t>(region_.open_faces + 1), 0);
    layout_.node_of_edge.assign(static_cast<std::size_t>(region_.edge_count() + 1), 0);
    for (std::size_t cell = 0; cell < region_.dense_of_cell.size(); ++cell) {
      const Eigen::Vector3i at = region_.grid.cell_of_index(region_.dense_of_cell[cell]);
      const auto row =
          static_cast<std::size_t>(row_number_[static_cast<std::size_t>(at[1] + width_ * at[2])]);
      const Spot own{row, origin_[row] + at[0]};
      layout_.node_of_cell[cell] = own.node;
      layout_.row_of_cell[cell] = static_cast<int>(row);
      for (int axis = 0; axis < 3; ++axis) {
        number_face(region_.cell_faces[cell][static_cast<std::size_t>(2 * axis)], axis, own);
        const int upper = region_.cell_faces[cell][static_cast<std::size_t>(2 * axis + 1)];
        if (upper != region_.null_face()) number_face(upper, axis, up(own, axis));
      }
    }
    layout_.node_of_edge.back() = 0;
  }

  void number_face(int face, int axis, const Spot& spot) {
    if (face == region_.null_face()) return;
    int& node = layout_.node_of_face[static_cast<std::size_t>(face)];
    if (node != 0) return;
    node = spot.node;
    const auto& edges = region_.face_edges[static_cast<std::size_t>(face)];
    const std::array<int, 2> across{next_axis(axis), last_axis(axis)};
    for (std::size_t pair = 0; pair < 2; ++pair) {
      layout_.node_of_edge[static_cast<std::size_t>(edges[2 * pair])] = spot.node;
      const int upper = edges[2 * pair + 1];
      if (upper != region_.null_edge())
        layout_.node_of_edge[static_cast<std::size_t>(upper)] = up(spot, across[pair]).node;
    }
  }

  const ActiveRegion& region_;
  Eigen::Vector3i n_;
  int width_, depth_;                          // rows along y and z
  std::vector<Range> cells_, items_, stored_;  // by j + width k
  std::vector<int> row_number_;                // by j + width k; 0 where there is no row
  std::vector<int> place_;                     // j + width k of each row
  std::vector<int> origin_;                    // of each row: the node of x = 0, were it stored
  RowLayout layout_;
};

}  // namespace

RowLayout make_row_layout(const ActiveRegion& region) { return Builder(region).build(); }

}  // namespace talus
