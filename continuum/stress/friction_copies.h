// Where the copies of cells stand on rows, and how they come there from the order of FrictionOperator and go back.
#pragma once

#include "continuum/stress/friction_fields.h"

namespace talus {

constexpr bool even_sits_above(int slot) { return slot == 1 || slot == 2; }

inline int slot_of(int parity, int copy) {
  const auto corner = copy_corner(parity, copy);
  return corner[1] + 2 * corner[2];
}

/// Values of one slot and component in the cells of a row, to be indexed by node.
template <class Value>
Value* run(Value* cells, const Row& row, int slot, int component) {
  return cells + values_per_cell * static_cast<std::ptrdiff_t>(row.begin) +
         (components_per_copy * slot + component) * row.length() - row.begin;
}

/// f(value as FrictionOperator numbers them, where it is in RowCopies::cells) for the copies of cells.
template <class Function>
void for_each_value(const ActiveRegion& region, const RowLayout& layout, const Function& f) {
  for (std::size_t cell = 0; cell < layout.node_of_cell.size(); ++cell) {
    const Row& row = layout.rows[static_cast<std::size_t>(layout.row_of_cell[cell])];
    const int node = layout.node_of_cell[cell];
    const auto first = values_per_cell * static_cast<std::ptrdiff_t>(row.begin) + node - row.begin;
    for (int copy = 0; copy < copies_per_cell; ++copy) {
      const int slot = slot_of(region.cell_parity[cell], copy);
      for (int component = 0; component < components_per_copy; ++component) {
        f(static_cast<Eigen::Index>(values_per_cell * cell) + components_per_copy * copy + component,
          static_cast<std::size_t>(first + (components_per_copy * slot + component) * row.length()));
      }
    }
  }
}

/// Zeros, as many as the region asks for.
template <class Real>
void reset_copies(const ActiveRegion& region, const RowLayout& layout, RowCopies<Real>& copies) {
  copies.cells.assign(values_per_cell * static_cast<std::size_t>(layout.nodes), Real{});
  copies.walls.assign(2 * copies_per_wall_face * region.wall_faces.size(), Real{});
  copies.contacts.assign(values_per_contact * region.contacts.size(), Real{});
}

template <class Real>
void read_copies(const ActiveRegion& region, const RowLayout& layout, const Eigen::ArrayXd& from,
                 RowCopies<Real>& copies) {
  for_each_value(region, layout, [&](Eigen::Index value, std::size_t at) {
    copies.cells[at] = static_cast<Real>(from[value]);
  });
  const Eigen::Index cells = values_per_cell * region.cell_count(), walls = std::ssize(copies.walls);
  for (Eigen::Index v = 0; v < walls; ++v)
    copies.walls[static_cast<std::size_t>(v)] = static_cast<Real>(from[cells + v]);
  for (Eigen::Index v = 0; v < std::ssize(copies.contacts); ++v)
    copies.contacts[static_cast<std::size_t>(v)] = static_cast<Real>(from[cells + walls + v]);
}

template <class Real>
void write_copies(const ActiveRegion& region, const RowLayout& layout, const RowCopies<Real>& copies,
                  Eigen::ArrayXd& to) {
  for_each_value(region, layout, [&](Eigen::Index value, std::size_t at) {
    to[value] = static_cast<double>(copies.cells[at]);
  });
  const Eigen::Index cells = values_per_cell * region.cell_count(), walls = std::ssize(copies.walls);
  for (Eigen::Index v = 0; v < walls; ++v) to[cells + v] = copies.walls[static_cast<std::size_t>(v)];
  for (Eigen::Index v = 0; v < std::ssize(copies.contacts); ++v)
    to[cells + walls + v] = copies.contacts[static_cast<std::size_t>(v)];
}

}  // namespace talus
