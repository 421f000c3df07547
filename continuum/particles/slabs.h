// Cells in slabs across one axis, in two colours (three around a periodic axis with an odd number of slabs): what particles
// in slabs of one colour deposit never meets on a face or in a cell, so that they can be worked on at the same time.
#pragma once

#include <span>
#include <vector>

#include "continuum/grid/active_region.h"
#include "continuum/parallel.h"

namespace talus {

/// Rows of cells in a slab. A cell deposits on its own row and the two beside it; so two rows between slabs suffice.
inline constexpr int slab_rows = 4;

struct Slabs {
  std::vector<std::vector<int>> cells;  // of each slab, indices into PointsByCell::cells, ascending
  std::vector<std::vector<int>> of_colour;
};

/// Slabs that hold points, across the axis along which the points reach furthest, in cells.
Slabs make_slabs(const Grid& grid, const PointsByCell& points);

/// f(cells of a slab), colour by colour; within a slab in order, whatever the number of threads.
template <class Function>
void for_each_slab(const Slabs& slabs, const Function& f) {
  for (const auto& colour : slabs.of_colour) {
    for_each_block(static_cast<std::ptrdiff_t>(colour.size()), 1,
                   [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
                     for (std::ptrdiff_t k = begin; k < end; ++k)
                       f(slabs.cells[static_cast<std::size_t>(colour[static_cast<std::size_t>(k)])]);
                   });
  }
}

}  // namespace talus
