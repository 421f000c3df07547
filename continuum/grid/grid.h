// Index space of the staggered grid (figure 5.8 of the source): cell centres, faces normal to each axis,
// edges along each axis. Indices here are dense, over the whole domain; active_region.h numbers what is in
// use.
//
// Axes are 0, 1, 2 for x, y, z. For an axis a its followers are b = (a+1) mod 3 and c = (a+2) mod 3. A face
// of axis a is normal to a. An edge of axis a runs along a and carries the shear stress s_bc.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

namespace talus {

constexpr int next_axis(int axis) { return (axis + 1) % 3; }
constexpr int last_axis(int axis) { return (axis + 2) % 3; }

struct Grid {
  Eigen::Vector3d origin;        // m, lower corner of the domain
  double spacing;                // h, m
  Eigen::Vector3i cells;         // number of cells along each axis
  std::array<bool, 3> periodic;  // axes whose two ends are joined

  Eigen::Vector3d upper() const { return origin + spacing * cells.cast<double>(); }
  double cell_volume() const { return spacing * spacing * spacing; }

  /// Brings an index on a periodic axis into range; leaves others alone.
  int wrapped(int axis, int i) const {
    if (!periodic[static_cast<std::size_t>(axis)]) return i;
    const int n = cells[axis];
    return ((i % n) + n) % n;
  }
  bool holds(const Eigen::Vector3i& cell) const {
    return (cell.array() >= 0).all() && (cell.array() < cells.array()).all();
  }
  /// Cell that holds a position; may lie outside the domain.
  Eigen::Vector3i cell_at(const Eigen::Vector3d& position) const {
    return ((position - origin) / spacing).array().floor().cast<int>();
  }
  /// Whether a position lies in the domain; false where it is not finite.
  bool contains(const Eigen::Vector3d& position) const {
    const Eigen::Array3d lower = ((position - origin) / spacing).array().floor();
    return (lower >= 0.0).all() && (lower < cells.cast<double>().array()).all();
  }
  /// Brings a position into the domain along periodic axes; leaves others alone.
  Eigen::Vector3d wrapped_position(Eigen::Vector3d position) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (!periodic[static_cast<std::size_t>(axis)]) continue;
      const double length = spacing * cells[axis];
      double offset = position[axis] - origin[axis];
      offset -= length * std::floor(offset / length);
      position[axis] = origin[axis] + (offset < length ? offset : 0.0);
    }
    return position;
  }

  /// Number of points of a kind along each axis: one more than cells where `nodal`, unless the axis is
  /// periodic.
  Eigen::Vector3i extent(const std::array<bool, 3>& nodal) const {
    Eigen::Vector3i n = cells;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      if (nodal[a] && !periodic[a]) ++n[axis];
    }
    return n;
  }
  static std::array<bool, 3> nodal_of_face(int axis) { return {axis == 0, axis == 1, axis == 2}; }
  static std::array<bool, 3> nodal_of_edge(int axis) { return {axis != 0, axis != 1, axis != 2}; }

  int cell_index(const Eigen::Vector3i& i) const { return dense(i, cells); }
  int face_index(int axis, const Eigen::Vector3i& i) const { return dense(i, extent(nodal_of_face(axis))); }
  int edge_index(int axis, const Eigen::Vector3i& i) const { return dense(i, extent(nodal_of_edge(axis))); }
  Eigen::Vector3i cell_of_index(int index) const {
    return {index % cells[0], index / cells[0] % cells[1], index / (cells[0] * cells[1])};
  }

 private:
  /// Every index is wrapped on periodic axes first.
  int dense(const Eigen::Vector3i& i, const Eigen::Vector3i& n) const {
    return wrapped(0, i[0]) + n[0] * (wrapped(1, i[1]) + n[1] * wrapped(2, i[2]));
  }
};

}  // namespace talus
