#include "continuum/grid/active_region.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "continuum/grid/stencil.h"

namespace talus {
namespace {

using Eigen::Vector3i;

/// For each parity and local edge, the one copy that touches it.
constexpr auto corner_table = [] {
  std::array<std::array<std::array<int, 3>, copies_per_cell>, 2> corners{};
  constexpr std::array<std::array<int, 3>, copies_per_cell> even{
      {{0, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}}};
  for (std::size_t copy = 0; copy < copies_per_cell; ++copy) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      corners[0][copy][axis] = even[copy][axis];
      corners[1][copy][axis] = 1 - even[copy][axis];
    }
  }
  return corners;
}();

int copy_touching(int parity, int axis, int at_next, int at_last) {
  const auto& corners = corner_table[static_cast<std::size_t>(parity)];
  for (int copy = 0; copy < copies_per_cell; ++copy) {
    const auto& corner = corners[static_cast<std::size_t>(copy)];
    if (corner[static_cast<std::size_t>(next_axis(axis))] == at_next &&
        corner[static_cast<std::size_t>(last_axis(axis))] == at_last) {
      return copy;
    }
  }
  return -1;  // not reached: every edge is touched by one corner of each parity
}

/// Fill in slivers is measured against no less than this share of the kernel.
constexpr double smallest_kernel_share = 0.25;

int parity_of(const Vector3i& cell) { return cell.sum() & 1; }

class Builder {
 public:
  Builder(const Grid& grid, const DomainSides& sides, const Openings& openings)
      : sides_(sides), openings_(openings) {
    region_.grid = grid;
  }

  ActiveRegion build(const Eigen::Matrix3Xd& positions) {
    find_cells(positions);
    find_faces();
    find_edges();
    tabulate();
    measure();
    return std::move(region_);
  }

 private:
  const Grid& grid() const { return region_.grid; }

  /// Compact index of the active cell at `i`, or the null cell.
  int cell_at(const Vector3i& i) const {
    Vector3i w;
    for (int axis = 0; axis < 3; ++axis) w[axis] = grid().wrapped(axis, i[axis]);
    if (!grid().holds(w)) return region_.null_cell();
    const int cell = region_.cell_of_dense[static_cast<std::size_t>(grid().cell_index(w))];
    return cell < 0 ? region_.null_cell() : cell;
  }
  /// The domain side that a face of `axis` at index i lies on, or null when it lies inside or on an open
  /// side.
  const Side* wall_at(int axis, const Vector3i& i) const {
    const auto a = static_cast<std::size_t>(axis);
    if (grid().periodic[a]) return nullptr;
    if (i[axis] == 0 && sides_[a][0].wall) return &sides_[a][0];
    if (i[axis] == grid().cells[axis] && sides_[a][1].wall) return &sides_[a][1];
    return nullptr;
  }
  /// Solver's index of a face: open faces as they are, everything else null.
  int open_face_at(int axis, const Vector3i& i) const {
    for (int other = 0; other < 3; ++other) {
      const int w = grid().wrapped(other, i[other]);
      if (w < 0 || w >= grid().cells[other] + (other == axis ? 1 : 0)) return region_.null_face();
    }
    const int face = region_.face_of_dense[static_cast<std::size_t>(axis)]
                                          [static_cast<std::size_t>(grid().face_index(axis, i))];
    return face >= 0 && face < region_.open_faces ? face : region_.null_face();
  }

  void find_cells(const Eigen::Matrix3Xd& positions) {
    region_.cell_of_dense.assign(static_cast<std::size_t>(grid().cells.prod()), is_empty);
    if (openings_.any()) {
      for (int dense = 0; dense < grid().cells.prod(); ++dense) {
        if (openings_.cell_share(dense) == 0.0)
          region_.cell_of_dense[static_cast<std::size_t>(dense)] = is_closed;
      }
    }
    for (Eigen::Index p = 0; p < positions.cols(); ++p) {
      const int dense = grid().cell_index(grid().cell_at(positions.col(p)));
      region_.cell_of_dense[static_cast<std::size_t>(dense)] = 0;
    }
    for (std::size_t dense = 0; dense < region_.cell_of_dense.size(); ++dense) {
      if (region_.cell_of_dense[dense] < 0) continue;
      region_.cell_of_dense[dense] = region_.cell_count();
      region_.dense_of_cell.push_back(static_cast<int>(dense));
      region_.cell_parity.push_back(parity_of(grid().cell_of_index(static_cast<int>(dense))));
    }
  }

  void find_faces() {
    struct Found {
      int axis;
      Vector3i index;
      const Side* wall;
      bool upper;
      int cell;
    };
    std::vector<Found> walls;
    for (int axis = 0; axis < 3; ++axis) {
      auto& face_of_dense = region_.face_of_dense[static_cast<std::size_t>(axis)];
      face_of_dense.assign(static_cast<std::size_t>(grid().extent(Grid::nodal_of_face(axis)).prod()), -1);
      for (int cell = 0; cell < region_.cell_count(); ++cell) {
        const Vector3i at = grid().cell_of_index(region_.dense_of_cell[static_cast<std::size_t>(cell)]);
        for (int side = 0; side < 2; ++side) {
          const Vector3i index = at + side * Vector3i::Unit(axis);
          int& face = face_of_dense[static_cast<std::size_t>(grid().face_index(axis, index))];
          if (face >= 0 || openings_.face_share(axis, grid().face_index(axis, index)) == 0.0) continue;
          if (const Side* wall = wall_at(axis, index)) {
            walls.push_back({axis, index, wall, side == 1, cell});
            continue;
          }
          face = region_.open_faces++;
          region_.face_axis.push_back(axis);
          region_.face_cells.push_back({cell_at(index - Vector3i::Unit(axis)), cell_at(index)});
          face_positions_.push_back(index);
        }
      }
    }
    for (const Found& wall : walls) {
      const int face = region_.face_count();
      region_.face_of_dense[static_cast<std::size_t>(wall.axis)]
                           [static_cast<std::size_t>(grid().face_index(wall.axis, wall.index))] = face;
      region_.wall_faces.push_back({face,
                                    wall.cell,
                                    wall.axis,
                                    wall.upper ? -1.0 : 1.0,
                                    wall.wall->friction,
                                    openings_.face_share(wall.axis, grid().face_index(wall.axis, wall.index)),
                                    {next_axis(wall.axis), last_axis(wall.axis)},
                                    {}});
      wall_positions_.push_back(wall.index);
    }
  }

  /// The four faces around the edge of `axis` at index i.
  std::array<int, 4> faces_around(int axis, const Vector3i& i) const {
    const int b = next_axis(axis), c = last_axis(axis);
    return {open_face_at(b, i - Vector3i::Unit(c)), open_face_at(b, i),
            open_face_at(c, i - Vector3i::Unit(b)), open_face_at(c, i)};
  }

  void add_edge(int axis, const Vector3i& i, const std::array<int, 4>& faces,
                const std::array<int, 4>& copies) {
    int& edge = region_.edge_of_dense[static_cast<std::size_t>(axis)]
                                     [static_cast<std::size_t>(grid().edge_index(axis, i))];
    edge = region_.edge_count();
    region_.edge_axis.push_back(axis);
    region_.edge_faces.push_back(faces);
    region_.edge_copies.push_back(copies);
  }

  void find_edges() {
    for (int axis = 0; axis < 3; ++axis) {
      auto& edge_of_dense = region_.edge_of_dense[static_cast<std::size_t>(axis)];
      edge_of_dense.assign(static_cast<std::size_t>(grid().extent(Grid::nodal_of_edge(axis)).prod()), -1);
      for (int cell = 0; cell < region_.cell_count(); ++cell) {
        const Vector3i at = grid().cell_of_index(region_.dense_of_cell[static_cast<std::size_t>(cell)]);
        for (int corner = 0; corner < 4; ++corner)
          try_inner_edge(axis, at + offset(axis, corner & 1, corner >> 1));
      }
    }
    region_.inner_edges = region_.edge_count();
    for (std::size_t w = 0; w < region_.wall_faces.size(); ++w) {
      if (region_.wall_faces[w].friction != 0.0) find_wall_edges(static_cast<int>(w));
    }
  }

  static Vector3i offset(int axis, int at_next, int at_last) {
    return at_next * Vector3i::Unit(next_axis(axis)) + at_last * Vector3i::Unit(last_axis(axis));
  }

  void try_inner_edge(int axis, const Vector3i& i) {
    if (edge_at(axis, i) >= 0) return;
    const auto faces = faces_around(axis, i);
    if (std::count(faces.begin(), faces.end(), region_.null_face()) > 0) return;
    std::array<int, 4> copies{};
    for (int corner = 0; corner < 4; ++corner) {
      const int at_next = corner & 1, at_last = corner >> 1;
      const int cell = cell_at(i - offset(axis, at_next, at_last));
      copies[static_cast<std::size_t>(corner)] =
          cell == region_.null_cell()
              ? -1
              : cell * copies_per_cell + copy_touching(region_.cell_parity[static_cast<std::size_t>(cell)],
                                                       axis, at_next, at_last);
    }
    add_edge(axis, i, faces, copies);
  }

  int edge_at(int axis, const Vector3i& i) const {
    return region_
        .edge_of_dense[static_cast<std::size_t>(axis)][static_cast<std::size_t>(grid().edge_index(axis, i))];
  }

  /// A wall face's traction along t lives on its two edges along the other tangential axis.
  void find_wall_edges(int w) {
    WallFace& wall = region_.wall_faces[static_cast<std::size_t>(w)];
    const Vector3i at = wall_positions_[static_cast<std::size_t>(w)];
    const int parity = parity_of(at);
    for (std::size_t t = 0; t < 2; ++t) {
      const int tangent = wall.along[t], axis = wall.along[1 - t];
      for (int copy = 0; copy < copies_per_wall_face; ++copy) {
        // Copies sit at opposite corners of the face: (0,0) and (1,1), or (0,1) and (1,0) for the other
        // parity.
        const int corner = t == 0 ? copy : copy ^ parity;
        const Vector3i i = at + corner * Vector3i::Unit(tangent);
        // The one unknown face beside this edge is tangential, half a cell inside the wall.
        const Vector3i beside = wall.inward > 0 ? i : Vector3i(i - Vector3i::Unit(wall.axis));
        int& edge = wall.edges[t][static_cast<std::size_t>(copy)];
        edge = -1;
        if (open_face_at(tangent, beside) == region_.null_face()) continue;
        edge = edge_at(axis, i);
        if (edge < 0) {
          add_edge(axis, i, faces_around(axis, i), {-1, -1, -1, -1});
          edge = edge_at(axis, i);
        }
        auto& touching = region_.edge_copies[static_cast<std::size_t>(edge)];
        *std::find(touching.begin(), touching.end(), -1) = w * copies_per_wall_face + copy;
      }
    }
  }

  void tabulate() {
    const int null_edge = region_.null_edge();
    region_.cell_faces.resize(region_.dense_of_cell.size());
    region_.cell_edges.resize(region_.dense_of_cell.size());
    for (std::size_t cell = 0; cell < region_.dense_of_cell.size(); ++cell) {
      const Vector3i at = grid().cell_of_index(region_.dense_of_cell[cell]);
      for (int axis = 0; axis < 3; ++axis) {
        for (int side = 0; side < 2; ++side) {
          region_.cell_faces[cell][static_cast<std::size_t>(2 * axis + side)] =
              open_face_at(axis, at + side * Vector3i::Unit(axis));
        }
        for (int corner = 0; corner < 4; ++corner) {
          const int edge = edge_at(axis, at + offset(axis, corner & 1, corner >> 1));
          region_.cell_edges[cell][static_cast<std::size_t>(local_edge(axis, corner & 1, corner >> 1))] =
              edge >= 0 && edge < region_.inner_edges ? edge : null_edge;
        }
      }
    }
    region_.face_edges.resize(static_cast<std::size_t>(region_.open_faces));
    for (std::size_t face = 0; face < region_.face_edges.size(); ++face) {
      const int axis = region_.face_axis[face], b = next_axis(axis), c = last_axis(axis);
      const Vector3i i = face_positions_[face];
      const auto edge = [&](int along, const Vector3i& at) {
        const int found = edge_at(along, at);
        return found < 0 ? null_edge : found;
      };
      region_.face_edges[face] = {edge(c, i), edge(c, i + Vector3i::Unit(b)), edge(b, i),
                                  edge(b, i + Vector3i::Unit(c))};
    }
    for (WallFace& wall : region_.wall_faces) {
      for (auto& edges : wall.edges) {
        for (int& edge : edges) edge = wall.friction != 0.0 && edge >= 0 ? edge : null_edge;
      }
    }
  }

  /// What solids leave open, and their contacts with the sand.
  void measure() {
    const int cells = region_.cell_count();
    region_.face_strained_cells = region_.face_cells;
    region_.cell_share = region_.cell_kernel = Eigen::ArrayXd::Ones(cells + 1);
    region_.face_area = region_.face_kernel = Eigen::ArrayXd::Ones(region_.open_faces + 1);
    region_.face_area[region_.null_face()] = 0.0;
    if (!openings_.any()) return;
    for (int face = 0; face < region_.open_faces; ++face) {
      const auto f = static_cast<std::size_t>(face);
      const int dense = grid().face_index(region_.face_axis[f], face_positions_[f]);
      region_.face_area[face] = openings_.face_share(region_.face_axis[f], dense);
      region_.face_kernel[face] = openings_.face_kernel_share(region_.face_axis[f], dense);
    }
    for (int cell = 0; cell < cells; ++cell) {
      const int dense = region_.dense_of_cell[static_cast<std::size_t>(cell)];
      region_.cell_share[cell] = openings_.cell_share(dense);
      region_.cell_kernel[cell] = std::max(smallest_kernel_share, openings_.cell_kernel_share(dense));
      find_contact(cell, grid().cell_of_index(dense));
    }
  }

  /// The area vector of the solid's wall in a cell, into the sand.
  Eigen::Vector3d wall_area(const Vector3i& at) const {
    Eigen::Vector3d area;
    for (int axis = 0; axis < 3; ++axis) {
      area[axis] = openings_.face_share(axis, grid().face_index(axis, at + Vector3i::Unit(axis))) -
                   openings_.face_share(axis, grid().face_index(axis, at));
    }
    return area;
  }

  void find_contact(int cell, const Vector3i& at) {
    const Eigen::Vector3d area = wall_area(at);
    if (area.norm() < smallest_opening) return;
    const auto& faces = region_.cell_faces[static_cast<std::size_t>(cell)];
    const double friction = openings_.friction[grid().cell_index(at)];
    Contact contact{cell, area.normalized(), area.norm(), friction, {}, {}};
    const auto face_or_opposite = [&](int axis, int side) {
      const int face = faces[static_cast<std::size_t>(2 * axis + side)];
      return face == region_.null_face() ? faces[static_cast<std::size_t>(2 * axis + 1 - side)] : face;
    };
    for (int copy = 0; copy < copies_per_contact; ++copy) {
      const auto corner = copy_corner(region_.cell_parity[static_cast<std::size_t>(cell)], copy);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        contact.faces[static_cast<std::size_t>(copy)][axis] =
            face_or_opposite(static_cast<int>(axis), corner[axis]);
      }
    }
    contact.tangents.col(0) = contact.normal.unitOrthogonal();
    contact.tangents.col(1) = contact.normal.cross(contact.tangents.col(0));
    for (int axis = 0; axis < 3; ++axis) close(contact, axis, at);
    if (friction != 0.0) region_.contacts.push_back(contact);
  }

  /// Where a solid closes a face of the contact's cell along `axis`.
  void close(const Contact& contact, int axis, const Vector3i& at) {
    bool closed = false;
    for (int side = 0; side < 2; ++side) {
      const Vector3i index = at + side * Vector3i::Unit(axis);
      closed = closed || openings_.face_share(axis, grid().face_index(axis, index)) == 0.0;
    }
    if (!closed) return;
    const auto& faces = region_.cell_faces[static_cast<std::size_t>(contact.cell)];
    Closure closure{contact.cell, axis, std::abs(contact.normal[axis]), faces, {}};
    for (std::size_t along = 0; along < 3; ++along) {
      const bool lower = faces[2 * along] != region_.null_face();
      const bool upper = faces[2 * along + 1] != region_.null_face();
      const double share = lower && upper ? 0.5 : 1.0;
      for (const std::size_t face : {2 * along, 2 * along + 1})
        closure.weight[face] = -closure.normal_share * contact.normal[static_cast<int>(along)] * share;
    }
    for (int side = 0; side < 2; ++side) {
      const int face = faces[static_cast<std::size_t>(2 * axis + side)];
      if (face != region_.null_face())
        region_.face_strained_cells[static_cast<std::size_t>(face)][static_cast<std::size_t>(1 - side)] =
            region_.null_cell();
    }
    region_.closures.push_back(closure);
  }

  const DomainSides& sides_;
  const Openings& openings_;
  ActiveRegion region_;
  std::vector<Vector3i> face_positions_, wall_positions_;
};

}  // namespace

std::array<int, 3> copy_corner(int parity, int copy) {
  return corner_table[static_cast<std::size_t>(parity)][static_cast<std::size_t>(copy)];
}

ActiveRegion make_active_region(const Grid& grid, const DomainSides& sides, const Eigen::Matrix3Xd& positions,
                                const Openings& openings) {
  return Builder(grid, sides, openings).build(positions);
}

}  // namespace talus
