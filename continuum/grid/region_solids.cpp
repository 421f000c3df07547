// What solids leave open of the active region, and their contacts with the sand (active_region.h).
#include <Eigen/Geometry>
#include <algorithm>

#include "continuum/grid/region_draft.h"

namespace talus {
namespace {

using Eigen::Vector3i;

/// Fill in slivers is measured against no less than this share of the kernel.
constexpr double smallest_kernel_share = 0.25;

/// The area vector of the solid's wall in a cell, into the sand.
Eigen::Vector3d wall_area(const RegionDraft& draft, const Vector3i& at) {
  Eigen::Vector3d area;
  for (int axis = 0; axis < 3; ++axis) {
    area[axis] = draft.openings.face_share(axis, draft.grid().face_index(axis, at + Vector3i::Unit(axis))) -
                 draft.openings.face_share(axis, draft.grid().face_index(axis, at));
  }
  return area;
}

/// Where a solid closes a face of the contact's cell along `axis`.
void close(RegionDraft& draft, const Contact& contact, int axis) {
  ActiveRegion& region = draft.region;
  const Vector3i at = draft.place(contact.cell);
  bool closed = false;
  for (int side = 0; side < 2; ++side) {
    const Vector3i index = at + side * Vector3i::Unit(axis);
    closed = closed || draft.openings.face_share(axis, draft.grid().face_index(axis, index)) == 0.0;
  }
  if (!closed) return;
  const auto& faces = region.cell_faces[static_cast<std::size_t>(contact.cell)];
  Closure closure{contact.cell, axis, contact.body, std::abs(contact.normal[axis]), contact.normal,
                  faces,        {}};
  for (std::size_t along = 0; along < 3; ++along) {
    const bool lower = faces[2 * along] != region.null_face();
    const bool upper = faces[2 * along + 1] != region.null_face();
    const double share = lower && upper ? 0.5 : 1.0;
    for (const std::size_t face : {2 * along, 2 * along + 1})
      closure.weight[face] = -closure.normal_share * contact.normal[static_cast<int>(along)] * share;
  }
  for (int side = 0; side < 2; ++side) {
    const int face = faces[static_cast<std::size_t>(2 * axis + side)];
    if (face != region.null_face())
      region.face_strained_cells[static_cast<std::size_t>(face)][static_cast<std::size_t>(1 - side)] =
          region.null_cell();
  }
  region.closures.push_back(closure);
}

void find_contact(RegionDraft& draft, int cell) {
  ActiveRegion& region = draft.region;
  const Vector3i at = draft.place(cell);
  const Eigen::Vector3d area = wall_area(draft, at);
  if (area.norm() < smallest_opening) return;
  const auto& faces = region.cell_faces[static_cast<std::size_t>(cell)];
  const int dense = draft.grid().cell_index(at);
  const double friction = draft.openings.friction[dense];
  Contact contact{cell, area.normalized(), area.norm(), friction, draft.openings.body[dense], {}, {}};
  const auto face_or_opposite = [&](int axis, int side) {
    const int face = faces[static_cast<std::size_t>(2 * axis + side)];
    return face == region.null_face() ? faces[static_cast<std::size_t>(2 * axis + 1 - side)] : face;
  };
  for (int copy = 0; copy < copies_per_contact; ++copy) {
    const auto corner = copy_corner(region.cell_parity[static_cast<std::size_t>(cell)], copy);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      contact.faces[static_cast<std::size_t>(copy)][axis] =
          face_or_opposite(static_cast<int>(axis), corner[axis]);
    }
  }
  contact.tangents.col(0) = contact.normal.unitOrthogonal();
  contact.tangents.col(1) = contact.normal.cross(contact.tangents.col(0));
  for (int axis = 0; axis < 3; ++axis) close(draft, contact, axis);
  // Sand moves bodies without friction, too.
  if (friction != 0.0 || contact.body >= 0) region.contacts.push_back(contact);
}

}  // namespace

void measure_solids(RegionDraft& draft) {
  ActiveRegion& region = draft.region;
  const int cells = region.cell_count();
  region.face_strained_cells = region.face_cells;
  region.cell_share = region.cell_kernel = Eigen::ArrayXd::Ones(cells + 1);
  region.face_area = region.face_kernel = Eigen::ArrayXd::Ones(region.open_faces + 1);
  region.face_area[region.null_face()] = 0.0;
  if (!draft.openings.any()) return;
  for (int face = 0; face < region.open_faces; ++face) {
    const auto f = static_cast<std::size_t>(face);
    const int dense = draft.face_dense[f];
    region.face_area[face] = draft.openings.face_share(region.face_axis[f], dense);
    region.face_kernel[face] = draft.openings.face_kernel_share(region.face_axis[f], dense);
  }
  for (int cell = 0; cell < cells; ++cell) {
    const int dense = region.dense_of_cell[static_cast<std::size_t>(cell)];
    region.cell_share[cell] = draft.openings.cell_share(dense);
    region.cell_kernel[cell] = std::max(smallest_kernel_share, draft.openings.cell_kernel_share(dense));
    find_contact(draft, cell);
  }
}

}  // namespace talus
