// The tables of an active region against what they say they hold, looked up point by point.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <tuple>
#include <type_traits>
#include <utility>

#include "tests/continuum/grid/ragged_region.h"

namespace talus {
namespace {

using Eigen::Vector3i;

template <class Function>
void for_each_index(const Vector3i& extent, const Function& f) {
  for (int z = 0; z < extent[2]; ++z)
    for (int y = 0; y < extent[1]; ++y)
      for (int x = 0; x < extent[0]; ++x) f(Vector3i(x, y, z));
}

class ActiveRegionTables : public ::testing::TestWithParam<testing::Setting> {
 protected:
  int cell_at(const Vector3i& i) const {
    Vector3i w;
    for (int axis = 0; axis < 3; ++axis) w[axis] = grid_.wrapped(axis, i[axis]);
    return grid_.holds(w) ? region_.cell_of_dense[static_cast<std::size_t>(grid_.cell_index(w))] : -1;
  }
  int cell_or_null(const Vector3i& i) const { return cell_at(i) < 0 ? region_.null_cell() : cell_at(i); }
  bool in_range(int axis, const Vector3i& i, bool nodal_along) const {
    for (int other = 0; other < 3; ++other) {
      const int w = grid_.wrapped(other, i[other]);
      if (w < 0 || w >= grid_.cells[other] + ((other == axis) == nodal_along ? 1 : 0)) return false;
    }
    return true;
  }
  /// Among all faces; -1 where there is none.
  int face_at(int axis, const Vector3i& i) const {
    if (!in_range(axis, i, true)) return -1;
    return region_
        .face_of_dense[static_cast<std::size_t>(axis)][static_cast<std::size_t>(grid_.face_index(axis, i))];
  }
  int open_face_at(int axis, const Vector3i& i) const {
    const int face = face_at(axis, i);
    return face >= 0 && face < region_.open_faces ? face : region_.null_face();
  }
  int edge_at(int axis, const Vector3i& i) const {
    return region_
        .edge_of_dense[static_cast<std::size_t>(axis)][static_cast<std::size_t>(grid_.edge_index(axis, i))];
  }
  bool wall_at(int axis, const Vector3i& i) const {
    return !grid_.periodic[static_cast<std::size_t>(axis)] && (i[axis] == 0 || i[axis] == grid_.cells[axis]);
  }

  /// In the memory of another region, as every step but the first makes it: none of that one's entries may be left.
  ActiveRegion in_spent_memory(const testing::RaggedSand& sand) {
    ActiveRegion other = testing::ragged_sand(GetParam(), random_).region();
    return make_active_region(sand.grid, sand.sides, points_by_cell(sand.grid, sand.positions), sand.openings,
                              std::move(other));
  }

  std::mt19937_64 random_{23};
  testing::RaggedSand sand_ = testing::ragged_sand(GetParam(), random_);
  ActiveRegion region_ = in_spent_memory(sand_);
  const Grid& grid_ = region_.grid;
};

TEST_P(ActiveRegionTables, CellsAreThoseThatHoldPoints) {
  std::vector<int> dense;
  for (Eigen::Index p = 0; p < sand_.positions.cols(); ++p)
    dense.push_back(grid_.cell_index(grid_.cell_at(sand_.positions.col(p))));
  std::sort(dense.begin(), dense.end());
  dense.erase(std::unique(dense.begin(), dense.end()), dense.end());
  EXPECT_EQ(region_.dense_of_cell, dense);
  for (int cell = 0; cell < region_.cell_count(); ++cell) {
    const Vector3i place = grid_.cell_of_index(region_.dense_of_cell[static_cast<std::size_t>(cell)]);
    for_each_index({3, 3, 3}, [&](const Vector3i& i) {
      const Vector3i offset = i.array() - 1;
      EXPECT_EQ(region_.cell_neighbours[static_cast<std::size_t>(cell)][static_cast<std::size_t>(
                    local_neighbour(offset[0], offset[1], offset[2]))],
                cell_at(place + offset));
    });
  }
}

TEST_P(ActiveRegionTables, FacesAreAllThoseOfActiveCells) {
  int open = 0, walls = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for_each_index(grid_.extent(Grid::nodal_of_face(axis)), [&](const Vector3i& i) {
      const int below = cell_at(i - Vector3i::Unit(axis)), above = cell_at(i), face = face_at(axis, i);
      const bool closed = sand_.openings.face_share(axis, grid_.face_index(axis, i)) == 0.0;
      if ((below < 0 && above < 0) || closed) {
        EXPECT_EQ(face, -1);
        return;
      }
      if (wall_at(axis, i)) {
        ++walls;
        ASSERT_GT(face, region_.null_face());
        const WallFace& wall = region_.wall_faces[static_cast<std::size_t>(face - region_.open_faces - 1)];
        EXPECT_EQ(wall.face, face);
        EXPECT_EQ(wall.axis, axis);
        EXPECT_EQ(wall.cell, std::max(below, above));
        EXPECT_EQ(wall.inward, i[axis] == 0 ? 1.0 : -1.0);
        return;
      }
      EXPECT_EQ(face, open++);  // axis by axis, in dense order
      const auto f = static_cast<std::size_t>(face);
      EXPECT_EQ(region_.face_axis[f], axis);
      EXPECT_EQ(region_.face_cells[f],
                (std::array<int, 2>{cell_or_null(i - Vector3i::Unit(axis)), cell_or_null(i)}));
      const int b = next_axis(axis), c = last_axis(axis);
      const auto edge = [&](int along, const Vector3i& at) {
        return edge_at(along, at) < 0 ? region_.null_edge() : edge_at(along, at);
      };
      EXPECT_EQ(region_.face_edges[f], (std::array<int, 4>{edge(c, i), edge(c, i + Vector3i::Unit(b)),
                                                           edge(b, i), edge(b, i + Vector3i::Unit(c))}));
    });
  }
  EXPECT_EQ(open, region_.open_faces);
  EXPECT_EQ(walls, static_cast<int>(region_.wall_faces.size()));
  EXPECT_GT(open, 0);
}

TEST_P(ActiveRegionTables, CellsKnowTheirFacesAndEdges) {
  for (int cell = 0; cell < region_.cell_count(); ++cell) {
    const auto c = static_cast<std::size_t>(cell);
    const Vector3i place = grid_.cell_of_index(region_.dense_of_cell[c]);
    EXPECT_EQ(region_.cell_parity[c], place.sum() & 1);
    for (int axis = 0; axis < 3; ++axis) {
      for (int side = 0; side < 2; ++side)
        EXPECT_EQ(region_.cell_faces[c][static_cast<std::size_t>(2 * axis + side)],
                  open_face_at(axis, place + side * Vector3i::Unit(axis)));
      for (int corner = 0; corner < 4; ++corner) {
        const int edge = edge_at(axis, place + (corner & 1) * Vector3i::Unit(next_axis(axis)) +
                                           (corner >> 1) * Vector3i::Unit(last_axis(axis)));
        EXPECT_EQ(region_.cell_edges[c][static_cast<std::size_t>(local_edge(axis, corner & 1, corner >> 1))],
                  edge >= 0 && edge < region_.inner_edges ? edge : region_.null_edge());
      }
    }
  }
}

TEST_P(ActiveRegionTables, InnerEdgesAreThoseWithFourFacesAndWallEdgesHaveOne) {
  int inner = 0, on_walls = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3i b = Vector3i::Unit(next_axis(axis)), c = Vector3i::Unit(last_axis(axis));
    for_each_index(grid_.extent(Grid::nodal_of_edge(axis)), [&](const Vector3i& i) {
      const std::array<int, 4> faces{open_face_at(next_axis(axis), i - c), open_face_at(next_axis(axis), i),
                                     open_face_at(last_axis(axis), i - b), open_face_at(last_axis(axis), i)};
      const int edge = edge_at(axis, i);
      if (std::count(faces.begin(), faces.end(), region_.null_face()) > 0) {
        EXPECT_TRUE(edge < 0 || edge >= region_.inner_edges);
        on_walls += edge >= 0;
      } else {
        EXPECT_EQ(edge, inner++);  // axis by axis, in dense order
      }
      if (edge < 0) return;
      const auto e = static_cast<std::size_t>(edge);
      EXPECT_EQ(region_.edge_axis[e], axis);
      EXPECT_EQ(region_.edge_faces[e], faces);
      if (edge >= region_.inner_edges) return;
      for (int corner = 0; corner < 4; ++corner) {
        const int cell = cell_at(i - (corner & 1) * b - (corner >> 1) * c);
        const int copy = region_.edge_copies[e][static_cast<std::size_t>(corner)];
        EXPECT_EQ(copy < 0 ? -1 : copy / copies_per_cell, cell);
      }
    });
  }
  EXPECT_EQ(inner, region_.inner_edges);
  EXPECT_EQ(inner + on_walls, region_.edge_count());
}

bool same(const Eigen::ArrayXd& a, const Eigen::ArrayXd& b) { return a.size() == b.size() && (a == b).all(); }
bool same(const SparseIndex& a, const SparseIndex& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] != b[i]) return false;
  }
  return true;
}
bool same(const Grid& a, const Grid& b) {
  return a.origin == b.origin && a.spacing == b.spacing && a.cells == b.cells && a.periodic == b.periodic;
}
// Structured bindings take every member, so that one that is added does not compile before it is compared.
bool same(const CellStencil& one, const CellStencil& other) {
  const auto tied = [](const CellStencil& x) {
    const auto& [cells, faces] = x;
    return std::tie(cells, faces);
  };
  return tied(one) == tied(other);
}
bool same(const WallFace& one, const WallFace& other) {
  const auto tied = [](const WallFace& x) {
    const auto& [face, cell, axis, inward, friction, area, along, edges] = x;
    return std::tie(face, cell, axis, inward, friction, area, along, edges);
  };
  return tied(one) == tied(other);
}
bool same(const Contact& one, const Contact& other) {
  const auto tied = [](const Contact& x) {
    const auto& [cell, normal, area, friction, body, faces, tangents] = x;
    return std::tie(cell, normal, area, friction, body, faces, tangents);
  };
  return tied(one) == tied(other);
}
bool same(const Closure& one, const Closure& other) {
  const auto tied = [](const Closure& x) {
    const auto& [cell, axis, body, normal_share, normal, faces, weight] = x;
    return std::tie(cell, axis, body, normal_share, normal, faces, weight);
  };
  return tied(one) == tied(other);
}
bool same(int a, int b) { return a == b; }
template <class Value, std::size_t n>
bool same(const std::array<Value, n>& a, const std::array<Value, n>& b) {
  if constexpr (std::is_same_v<Value, int>) return a == b;
  return std::equal(a.begin(), a.end(), b.begin(), [](const Value& x, const Value& y) { return same(x, y); });
}
template <class Value>
bool same(const std::vector<Value>& a, const std::vector<Value>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Value& x, const Value& y) { return same(x, y); });
}

void expect_same(const ActiveRegion& one, const ActiveRegion& other) {
  const auto tied = [](const ActiveRegion& region) {
    const auto& [grid, dense_of_cell, cell_of_dense, cell_neighbours, cell_stencils, cell_faces, cell_edges,
                 cell_parity, cell_share, cell_kernel, open_faces, face_axis, face_cells, face_strained_cells,
                 face_area, face_kernel, face_edges, face_of_dense, wall_faces, contacts, closures,
                 inner_edges, edge_axis, edge_faces, edge_copies, edge_of_dense] = region;
    return std::tie(grid, dense_of_cell, cell_of_dense, cell_neighbours, cell_stencils, cell_faces,
                    cell_edges, cell_parity, cell_share, cell_kernel, open_faces, face_axis, face_cells,
                    face_strained_cells, face_area, face_kernel, face_edges, face_of_dense, wall_faces,
                    contacts, closures, inner_edges, edge_axis, edge_faces, edge_copies, edge_of_dense);
  };
  const auto first = tied(one), second = tied(other);
  const auto expect = [](bool is_same, std::size_t member) { EXPECT_TRUE(is_same) << "member " << member; };
  [&]<std::size_t... member>(std::index_sequence<member...>) {
    (expect(same(std::get<member>(first), std::get<member>(second)), member), ...);
  }
  (std::make_index_sequence<std::tuple_size_v<decltype(first)>>());
}

TEST_P(ActiveRegionTables, AreTheSameInTheMemoryOfALargerRegionAndOfASmallerOne) {
  testing::RaggedSand few = sand_, more = sand_;
  few.positions = sand_.positions.leftCols(std::max<Eigen::Index>(1, sand_.positions.cols() / 3)).eval();
  const testing::RaggedSand others = testing::ragged_sand(GetParam(), random_);
  more.positions.resize(3, sand_.positions.cols() + others.positions.cols());
  more.positions << sand_.positions, others.positions;
  ASSERT_LT(few.region().cell_count(), sand_.region().cell_count());
  ASSERT_GT(more.region().cell_count(), sand_.region().cell_count());
  const auto spending = [&](ActiveRegion&& spent) {
    return make_active_region(sand_.grid, sand_.sides, points_by_cell(sand_.grid, sand_.positions),
                              sand_.openings, std::move(spent));
  };
  const ActiveRegion fresh = sand_.region();
  for (const testing::RaggedSand* before : {&few, &more}) {
    expect_same(fresh, spending(before->region()));
    ActiveRegion warm = before->region();
    expect_same(fresh, spending(take_tables(warm)));  // as a step does
  }
}

INSTANTIATE_TEST_SUITE_P(Settings, ActiveRegionTables, testing::ragged_settings, testing::name_of_setting);
INSTANTIATE_TEST_SUITE_P(Rings, ActiveRegionTables,
                         ::testing::Values(testing::Setting{"of_two", {true, true, true}, {2, 5, 2}},
                                           testing::Setting{"of_one", {true, true, false}, {5, 1, 4}},
                                           testing::Setting{
                                               "of_many_pages", {false, true, false}, {37, 11, 5}}),
                         testing::name_of_setting);

}  // namespace
}  // namespace talus
