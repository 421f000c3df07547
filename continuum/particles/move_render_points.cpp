// The part of render_points.h that moves them: cell by cell of the particles, and within a cell by the cell that each point
// lies in, so that the faces around a cell are read once for all of its points.
#include <algorithm>
#include <cmath>

#include "continuum/grid/stencil.h"
#include "continuum/parallel.h"
#include "continuum/particles/gather.h"
#include "continuum/particles/render_points.h"

namespace talus {
namespace {

constexpr std::ptrdiff_t cells_in_block = 16;
constexpr int neighbours = 27, own = local_neighbour(0, 0, 0);

/// The place of a point in a cell, in [0, 1] along each axis, and which of the 27 around its parent's it is.
struct Located {
  std::array<double, 3> place;
  int neighbour;
  int parent;  // its place among the cell's particles
  std::int64_t point;
};

/// What the points of one cell's particles need, again and again.
struct CellWork {
  std::vector<Eigen::Vector3d> parent_velocities;
  std::vector<Located> located;
  // By neighbour: those of k are [first[k], first[k + 1]).
  std::array<int, neighbours + 1> first;
  std::array<std::vector<double>, 3> places;  // and lane_count more, of any value
  std::vector<int> parents;
  std::vector<std::int64_t> points;
};

/// By the parent's place in its cell and the point's offset, in cells.
Located locate(const std::array<int, neighbours>& cells, const Eigen::Vector3d& parent,
               const Eigen::Vector3d& offset) {
  Located at{};
  at.neighbour = own;
  std::array<int, 3> step;
  bool near = true;
  for (std::size_t a = 0; a < 3; ++a) {
    at.place[a] = parent[static_cast<Eigen::Index>(a)] + offset[static_cast<Eigen::Index>(a)];
    step[a] = static_cast<int>(std::floor(std::min(std::max(-2.0, at.place[a]), 2.0)));  // not finite: -2
    near = near & (step[a] >= -1) & (step[a] <= 1);
  }
  if (!near) step = {};
  const int neighbour = local_neighbour(step[0], step[1], step[2]);
  if (near && cells[static_cast<std::size_t>(neighbour)] >= 0) {
    at.neighbour = neighbour;
    for (std::size_t a = 0; a < 3; ++a) at.place[a] -= step[a];
  } else {
    for (double& place : at.place) place = std::clamp(place, 0.0, 1.0);
  }
  return at;
}

void sort_located(CellWork& work) {
  work.first.fill(0);
  for (const Located& at : work.located) ++work.first[static_cast<std::size_t>(at.neighbour) + 1];
  for (std::size_t k = 0; k < neighbours; ++k) work.first[k + 1] += work.first[k];
  for (auto& axis : work.places) axis.resize(work.located.size() + lane_count);
  work.parents.resize(work.located.size());
  work.points.resize(work.located.size());
  std::array<int, neighbours + 1> next = work.first;
  for (const Located& at : work.located) {
    const auto to = static_cast<std::size_t>(next[static_cast<std::size_t>(at.neighbour)]++);
    for (std::size_t axis = 0; axis < 3; ++axis) work.places[axis][to] = at.place[axis];
    work.parents[to] = at.parent;
    work.points[to] = at.point;
  }
}

class Mover {
 public:
  Mover(const ActiveRegion& region, const PointsByCell& points, const Field& velocity, double dt,
        const Particles& particles, RenderPoints& drawn)
      : region_(region),
        points_(points),
        velocity_(velocity),
        dt_(dt),
        particles_(particles),
        drawn_(drawn) {}

  /// The points of the particles in one cell, by its number among those that hold particles.
  void move(std::size_t c, CellWork& work) const {
    const auto cell =
        static_cast<std::size_t>(region_.cell_of_dense[static_cast<std::size_t>(points_.cells[c])]);
    find(c, region_.cell_neighbours[cell], work);
    if (work.located.empty()) return;
    find_parent_velocities(c, cell, work);
    sort_located(work);
    for (std::size_t k = 0; k < neighbours; ++k) {
      if (work.first[k] == work.first[k + 1]) continue;
      CellFaces faces;
      read_faces(region_.cell_stencils[static_cast<std::size_t>(region_.cell_neighbours[cell][k])], velocity_,
                 faces);
      for (int begin = work.first[k]; begin < work.first[k + 1]; begin += lane_count)
        move_four(faces, work, begin, std::min(begin + lane_count, work.first[k + 1]));
    }
  }

 private:
  void find(std::size_t c, const std::array<int, neighbours>& cells, CellWork& work) const {
    work.located.clear();
    const double per_metre = 1.0 / region_.grid.spacing;
    for (int i = points_.first[c]; i < points_.first[c + 1]; ++i) {
      const int p = points_.point(i);
      const auto owner = static_cast<std::size_t>(particles_.origins(0, p));
      const Place place = place_of(region_.grid, particles_.positions.col(p));
      for (std::int64_t k = drawn_.first[owner]; k < drawn_.first[owner + 1]; ++k) {
        Located at = locate(cells, place.local,
                            drawn_.offsets[static_cast<std::size_t>(k)].cast<double>() * per_metre);
        at.parent = i - points_.first[c];
        at.point = k;
        work.located.push_back(at);
      }
    }
  }

  void find_parent_velocities(std::size_t c, std::size_t cell, CellWork& work) const {
    work.parent_velocities.resize(static_cast<std::size_t>(points_.first[c + 1] - points_.first[c]));
    CellFaces faces;
    read_faces(region_.cell_stencils[cell], velocity_, faces);
    std::size_t next = 0;
    const auto at = static_cast<std::ptrdiff_t>(c);
    for_each_four(region_, points_, at, at + 1, [&](const LaneParticles& four, int) {
      const std::array<Lanes, 3> velocity =
          velocity_of(faces, local_places(region_.grid, particles_.positions, four));
      for (int lane = 0; lane < four.count; ++lane)
        work.parent_velocities[next++] = {velocity[0][lane], velocity[1][lane], velocity[2][lane]};
    });
  }

  void move_four(const CellFaces& faces, const CellWork& work, int begin, int end) const {
    std::array<Lanes, 3> places;
    for (std::size_t axis = 0; axis < 3; ++axis)
      places[axis] = Eigen::Map<const Lanes>(work.places[axis].data() + begin);
    const std::array<Lanes, 3> velocity = velocity_of(faces, places);
    for (int lane = 0; lane < end - begin; ++lane) {
      const auto at = static_cast<std::size_t>(begin + lane);
      const Eigen::Vector3d own_velocity(velocity[0][lane], velocity[1][lane], velocity[2][lane]);
      const Eigen::Vector3d& parent = work.parent_velocities[static_cast<std::size_t>(work.parents[at])];
      drawn_.offsets[static_cast<std::size_t>(work.points[at])] +=
          (dt_ * (own_velocity - parent)).cast<float>();
    }
  }

  static std::array<Lanes, 3> velocity_of(const CellFaces& faces, const std::array<Lanes, 3>& places) {
    const KernelLanes kernel = kernel_at(places);
    return {value_of(faces[0], kernel, 0), value_of(faces[1], kernel, 1), value_of(faces[2], kernel, 2)};
  }

  const ActiveRegion& region_;
  const PointsByCell& points_;
  const Field& velocity_;
  double dt_;
  const Particles& particles_;
  RenderPoints& drawn_;
};

}  // namespace

void move_render_points(const ActiveRegion& region, const PointsByCell& points, const Field& velocity,
                        double dt, const Particles& particles, RenderPoints& drawn) {
  require_inside(region, points, particles.count());
  if (particles.count() > 0 && !particles.has_origins())
    throw std::invalid_argument("particles do not know which render points are theirs");
  const Mover mover(region, points, velocity, dt, particles, drawn);
  for_each_block(points.cell_count(), cells_in_block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    static thread_local CellWork work;  // keeps its memory
    for (auto c = static_cast<std::size_t>(begin); c < static_cast<std::size_t>(end); ++c)
      mover.move(c, work);
  });
}

}  // namespace talus
