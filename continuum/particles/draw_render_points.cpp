// The part of render_points.h that pictures need: where points are, and their normals.
#include <algorithm>

#include "continuum/grid/stencil.h"
#include "continuum/parallel.h"
#include "continuum/particles/render_points.h"
#include "continuum/particles/sample_ellipsoid.h"

namespace talus {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr std::ptrdiff_t particles_in_block = 256;
constexpr std::ptrdiff_t cells_in_block = 1024;

/// The change of fill per cell, at the centres of the region's cells and of those around them.
class FillGradient {
 public:
  FillGradient(const ActiveRegion& region, const DomainSides& sides, const Openings& openings,
               const Field& fill)
      : region_(region), sides_(sides), openings_(openings), fill_(fill) {
    const Grid& grid = region.grid;
    index_ = SparseIndex(static_cast<std::size_t>(grid.cells.prod()));
    std::vector<int> dense_cells;
    for (const int dense : region.dense_of_cell) {
      for (int k = 0; k < 27; ++k) {
        const Vector3i place = grid.cell_of_index(dense) + Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
        if (!holds_wrapped(place)) continue;
        const auto at = static_cast<std::size_t>(grid.cell_index(place));
        if (index_[at] >= 0) continue;
        index_.set(at, static_cast<int>(dense_cells.size()));
        dense_cells.push_back(static_cast<int>(at));
      }
    }
    gradients_.setZero(3, static_cast<Eigen::Index>(dense_cells.size()) + 1);
    for_each_block(static_cast<std::ptrdiff_t>(dense_cells.size()), cells_in_block,
                   [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
                     for (std::ptrdiff_t i = begin; i < end; ++i)
                       gradients_.col(i) =
                           at_cell(grid.cell_of_index(dense_cells[static_cast<std::size_t>(i)]));
                   });
  }

  /// 0 beyond the cells around the region; a position outside the domain is seen from the nearest inside.
  Vector3d at(const Vector3d& position) const {
    const Grid& grid = region_.grid;
    const double inset = 1e-9 * grid.spacing;
    const Vector3d inside = grid.wrapped_position(position)
                                .cwiseMax((grid.origin.array() + inset).matrix())
                                .cwiseMin((grid.upper().array() - inset).matrix());
    const auto lookup = [&](int dense) {
      if (is_solid(dense)) return is_closed;
      const int found = index_[static_cast<std::size_t>(dense)];
      return found < 0 ? is_empty : found;
    };
    const auto nothing = static_cast<int>(gradients_.cols()) - 1;
    const Stencil stencil = cell_stencil(grid, place_of(grid, inside), lookup, nothing);
    Vector3d gradient = Vector3d::Zero();
    for (std::size_t k = 0; k < 8; ++k) {
      if (stencil.index[k] >= 0) gradient += stencil.weight[k] * gradients_.col(stencil.index[k]);
    }
    return gradient;
  }

 private:
  bool is_solid(int dense) const { return openings_.cell_share(dense) < smallest_opening; }
  bool holds_wrapped(const Vector3i& place) const {
    const Grid& grid = region_.grid;
    return grid.holds({grid.wrapped(0, place[0]), grid.wrapped(1, place[1]), grid.wrapped(2, place[2])});
  }

  double fill_at(const Vector3i& place) const {
    const int cell = region_.cell_of_dense[static_cast<std::size_t>(region_.grid.cell_index(place))];
    return cell < 0 ? 0.0 : fill_[cell];
  }

  Vector3d at_cell(const Vector3i& place) const {
    const double here = fill_at(place);
    const auto beside = [&](int axis, std::size_t end) {
      const Vector3i next = place + (end == 0 ? -1 : 1) * Vector3i::Unit(axis);
      if (!holds_wrapped(next)) return sides_[static_cast<std::size_t>(axis)][end].wall ? here : 0.0;
      return is_solid(region_.grid.cell_index(next)) ? here : fill_at(next);
    };
    Vector3d gradient;
    for (int axis = 0; axis < 3; ++axis) gradient[axis] = 0.5 * (beside(axis, 1) - beside(axis, 0));
    return gradient;
  }

  const ActiveRegion& region_;
  const DomainSides& sides_;
  const Openings& openings_;
  const Field& fill_;
  SparseIndex index_;
  Eigen::Matrix3Xd gradients_;  // the last one is 0
};

/// use(point, position) for each point.
template <class Use>
void for_each_point(const Grid& grid, const Particles& particles, const RenderPoints& drawn, const Use& use) {
  for_each_block(particles.count(), particles_in_block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto p = static_cast<std::size_t>(begin); p < static_cast<std::size_t>(end); ++p) {
      for (std::int64_t k = drawn.first[p]; k < drawn.first[p + 1]; ++k) {
        const Vector3d offset = drawn.offsets[static_cast<std::size_t>(k)].cast<double>();
        use(k, grid.wrapped_position(particles.positions.col(static_cast<Eigen::Index>(p)) + offset));
      }
    }
  });
}

}  // namespace

Eigen::Matrix3Xf render_positions(const Grid& grid, const Particles& particles, const RenderPoints& drawn) {
  Eigen::Matrix3Xf positions(3, drawn.count());
  for_each_point(grid, particles, drawn, [&](std::int64_t k, const Vector3d& position) {
    positions.col(k) = position.cast<float>();
  });
  return positions;
}

Eigen::Matrix3Xf render_normals(const ActiveRegion& region, const DomainSides& sides,
                                const Openings& openings, const Field& fill, const Particles& particles,
                                const RenderPoints& drawn, double jitter) {
  const FillGradient gradient(region, sides, openings, fill);
  Eigen::Matrix3Xf normals(3, drawn.count());
  for_each_point(region.grid, particles, drawn, [&](std::int64_t k, const Vector3d& position) {
    Draws draws(drawn.seed, 0, drawn.identities[static_cast<std::size_t>(k)]);  // no hand-over has number 0
    const Vector3d normal = jitter * draws.in_ball() - gradient.at(position);
    normals.col(k) = normal.normalized().cast<float>();
  });
  return normals;
}

}  // namespace talus
