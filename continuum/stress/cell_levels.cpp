#include "continuum/stress/cell_levels.h"

#include <algorithm>

#include "continuum/parallel.h"

namespace talus {
namespace {

using Eigen::Vector3i;

constexpr int smallest_level = 8;  // cells; levels are not made coarser than this

/// Where the cells of a level lie: at[i] in a grid of `cells`; and back, -1 where there is none.
struct Places {
  Vector3i cells;
  std::vector<Vector3i> at;
  std::vector<int> index;  // not of level 0

  int dense(const Vector3i& i) const { return i[0] + cells[0] * (i[1] + cells[1] * i[2]); }
};

/// Axes along which a chessboard does not close.
std::array<bool, 3> seams_of(const Places& places, const std::array<bool, 3>& periodic) {
  std::array<bool, 3> seams{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int n = places.cells[static_cast<int>(axis)];
    seams[axis] = periodic[axis] && n > 1 && n % 2 == 1;
  }
  return seams;
}

int colour_of(const Places& places, const std::array<bool, 3>& seams, const Vector3i& at) {
  int on_seams = 0;
  for (int axis = 0; axis < 3; ++axis)
    on_seams += seams[static_cast<std::size_t>(axis)] && at[axis] == places.cells[axis] - 1;
  return 2 * on_seams + (at.sum() & 1);
}

/// The place of each cell when they are ordered by colour, otherwise as they are.
std::vector<int> order_by_colour(const Places& places, const std::array<bool, 3>& periodic,
                                 std::vector<int>& colour_begin) {
  constexpr std::size_t most_colours = 8;
  const std::array<bool, 3> seams = seams_of(places, periodic);
  std::vector<unsigned char> colour(places.at.size());
  std::array<int, most_colours + 1> begin{};
  for (std::size_t i = 0; i < colour.size(); ++i) {
    colour[i] = static_cast<unsigned char>(colour_of(places, seams, places.at[i]));
    ++begin[colour[i] + 1U];
  }
  colour_begin = {0};
  for (std::size_t c = 0; c < most_colours; ++c) {
    if (begin[c + 1] > 0) colour_begin.push_back(colour_begin.back() + begin[c + 1]);
    begin[c + 1] += begin[c];
  }
  std::vector<int> order(colour.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = begin[colour[i]]++;
  return order;
}

Places in_order(const Places& places, const std::vector<int>& order) {
  Places ordered{places.cells, std::vector<Vector3i>(places.at.size()), {}};
  for (std::size_t i = 0; i < order.size(); ++i)
    ordered.at[static_cast<std::size_t>(order[i])] = places.at[i];
  return ordered;
}

/// Places of the next level, in the order of the dense grid, and which of them each cell belongs to.
Places find_parents(const Places& fine, const std::array<bool, 3>& halved, std::vector<int>& parent) {
  const Vector3i shift = Vector3i(halved[0], halved[1], halved[2]);
  const auto halve = [&](const Vector3i& at) {
    return Vector3i(at[0] >> shift[0], at[1] >> shift[1], at[2] >> shift[2]);
  };
  Places coarse{halve(fine.cells + shift), {}, {}};
  std::vector<int>& index = coarse.index;
  index.assign(static_cast<std::size_t>(coarse.cells.prod()), -1);
  parent.resize(fine.at.size());
  for (std::size_t i = 0; i < parent.size(); ++i) {
    parent[i] = coarse.dense(halve(fine.at[i]));
    index[static_cast<std::size_t>(parent[i])] = 0;
  }
  std::size_t dense = 0;
  Vector3i at;
  for (at[2] = 0; at[2] < coarse.cells[2]; ++at[2]) {
    for (at[1] = 0; at[1] < coarse.cells[1]; ++at[1]) {
      for (at[0] = 0; at[0] < coarse.cells[0]; ++at[0], ++dense) {
        if (index[dense] < 0) continue;
        index[dense] = static_cast<int>(coarse.at.size());
        coarse.at.push_back(at);
      }
    }
  }
  for (int& p : parent) p = index[static_cast<std::size_t>(p)];
  return coarse;
}

void list_children(const CellLevel& fine, CellLevel& coarse) {
  coarse.children_begin.assign(static_cast<std::size_t>(coarse.count) + 1, 0);
  for (const int p : fine.parent) ++coarse.children_begin[static_cast<std::size_t>(p) + 1];
  for (std::size_t p = 1; p < coarse.children_begin.size(); ++p)
    coarse.children_begin[p] += coarse.children_begin[p - 1];
  std::vector<int> next = coarse.children_begin;
  coarse.children.resize(fine.parent.size());
  for (int i = 0; i < fine.count; ++i)
    coarse.children[static_cast<std::size_t>(
        next[static_cast<std::size_t>(fine.parent[static_cast<std::size_t>(i)])]++)] = i;
}

/// Of parents, those side by side; what parts their children leaves no link between them (multigrid.h).
void find_neighbours(const Places& places, const std::vector<int>& order, const std::array<bool, 3>& periodic,
                     const std::vector<int>& directions, CellLevel& level) {
  const auto n = static_cast<std::size_t>(level.count);
  level.neighbours.assign(directions.size() * n, level.count);
  for (std::size_t i = 0; i < n; ++i) {
    const int dense = places.dense(places.at[i]);
    for (std::size_t k = 0; k < directions.size(); ++k) {
      const int axis = directions[k] / 2, length = places.cells[axis];
      const int stride = axis == 0 ? 1 : axis == 1 ? places.cells[0] : places.cells[0] * places.cells[1];
      int move = directions[k] % 2 == 0 ? -1 : 1;
      const int to = places.at[i][axis] + move;
      if (to < 0 || to >= length) {
        if (!periodic[static_cast<std::size_t>(axis)] || length == 1) continue;
        move -= move * length;
      }
      const int found = places.index[static_cast<std::size_t>(dense + move * stride)];
      if (found < 0) continue;
      level.neighbours[k * n + static_cast<std::size_t>(order[i])] = order[static_cast<std::size_t>(found)];
    }
  }
}

/// Where the region's cells lie. A row of cells shares its division.
Places places_of(const ActiveRegion& region) {
  Places places{region.grid.cells, {}, {}};
  places.at.reserve(region.dense_of_cell.size());
  Vector3i row = Vector3i::Zero();
  int row_begin = 0, row_end = 0;
  for (const int dense : region.dense_of_cell) {
    if (dense >= row_end) {
      row = region.grid.cell_of_index(dense);
      row_begin = dense - row[0];
      row_end = row_begin + places.cells[0];
    }
    places.at.emplace_back(dense - row_begin, row[1], row[2]);
  }
  return places;
}

/// The places are put in the order of the level.
CellLevel finest_level(const ActiveRegion& region, CellLevels& all, Places& places) {
  CellLevel level;
  level.count = region.cell_count();
  all.order = order_by_colour(places, region.grid.periodic, level.colour_begin);
  places = in_order(places, all.order);
  const auto n = static_cast<std::size_t>(level.count);
  std::vector<int> place = all.order;
  place.push_back(level.count);  // of the null cell
  level.neighbours.resize(all.directions.size() * n);
  for_each_block(level.count, cells_per_block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto cell = static_cast<std::size_t>(begin); cell < static_cast<std::size_t>(end); ++cell) {
      for (std::size_t k = 0; k < all.directions.size(); ++k) {
        const auto direction = static_cast<std::size_t>(all.directions[k]);
        const auto face = static_cast<std::size_t>(region.cell_faces[cell][direction]);
        const int other =
            face < region.face_cells.size() ? region.face_cells[face][direction % 2] : region.null_cell();
        level.neighbours[k * n + static_cast<std::size_t>(place[cell])] =
            place[static_cast<std::size_t>(other)];
      }
    }
  });
  return level;
}

}  // namespace

CellLevels make_cell_levels(const ActiveRegion& region) {
  CellLevels all;
  for (int axis = 0; axis < 3; ++axis) {
    if (region.grid.cells[axis] == 1) continue;
    all.directions.push_back(2 * axis);
    all.directions.push_back(2 * axis + 1);
  }
  Places places = places_of(region);
  all.levels.push_back(finest_level(region, all, places));
  while (all.levels.back().count > smallest_level) {
    std::array<bool, 3> halved{};
    for (int axis = 0; axis < 3; ++axis) halved[static_cast<std::size_t>(axis)] = places.cells[axis] > 1;
    CellLevel& fine = all.levels.back();
    Places parents = find_parents(places, halved, fine.parent);
    CellLevel coarse;
    coarse.count = static_cast<int>(parents.at.size());
    const std::vector<int> order = order_by_colour(parents, region.grid.periodic, coarse.colour_begin);
    for (int& p : fine.parent) p = order[static_cast<std::size_t>(p)];
    list_children(fine, coarse);
    find_neighbours(parents, order, region.grid.periodic, all.directions, coarse);
    places = in_order(parents, order);
    all.halved.push_back(halved);
    all.levels.push_back(std::move(coarse));
  }
  return all;
}

}  // namespace talus
