#include "continuum/particles/move.h"

#include "continuum/parallel.h"
#include "continuum/particles/gather.h"

namespace talus {
namespace {

constexpr std::ptrdiff_t cells_in_block = 64;
constexpr std::ptrdiff_t particles_per_block = 4096;

/// A report of one block, added to those before.
struct BlockReport {
  AdvanceReport report;
  BlockReport& operator+=(const BlockReport& later) {
    report.largest_move = std::max(report.largest_move, later.report.largest_move);
    report.deform += later.report.deform;
    return *this;
  }
};

/// The flow around a cell, as its particles see it.
class CellFlow {
 public:
  CellFlow(const ActiveRegion& region, const Field& before, const Field& after, bool changes)
      : region_(region), before_(before), after_(after), changes_(changes) {}

  void read(int cell) {
    if (cell == cell_) return;
    cell_ = cell;
    const CellStencil& stencil = region_.cell_stencils[static_cast<std::size_t>(cell)];
    read_faces(stencil, after_, velocity);
    if (!changes_) return;
    read_faces(stencil, before_, change);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t k = 0; k < 18; ++k) change[axis][k] = velocity[axis][k] - change[axis][k];
    }
  }
  CellFaces velocity, change;  // v~, v~ - v^n

 private:
  const ActiveRegion& region_;
  const Field &before_, &after_;
  bool changes_;
  int cell_ = -1;
};

void write_velocity(const Advance& how, const LaneParticles& four, Eigen::Index axis, const Lanes& velocity,
                    const Lanes& change, Particles& particles) {
  for (int lane = 0; lane < four.count; ++lane) {
    double& v = particles.velocities(axis, four.index[static_cast<std::size_t>(lane)]);
    v = how.transfer == Transfer::apic
            ? velocity[lane]
            : (1.0 - how.pic_share) * (v + change[lane]) + how.pic_share * velocity[lane];
  }
}

void advance_four(const Grid& grid, const CellFlow& flow, const Advance& how,
                  std::span<const Material> materials, const LaneParticles& four, Particles& particles,
                  AdvanceReport& report) {
  const KernelLanes kernel = kernel_at(local_places(grid, particles.positions, four));
  const bool apic = how.transfer == Transfer::apic;
  std::array<Lanes, 9> gradient;  // column-major
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    Lanes velocity, change = Lanes::Zero();
    if (how.deforms || apic) {
      const ValueAndRates found = value_and_rates_of(flow.velocity[axis], kernel, axis);
      velocity = found.value;
      for (std::size_t k = 0; k < 3; ++k)
        gradient[axis + 3 * ((axis + k) % 3)] = found.rate[k] / grid.spacing;
    } else {
      velocity = value_of(flow.velocity[axis], kernel, axis);
    }
    if (!apic) change = value_of(flow.change[axis], kernel, axis);
    write_velocity(how, four, a, velocity, change, particles);
    const Lanes move = how.dt * velocity;
    for (int lane = 0; lane < four.count; ++lane)
      particles.positions(a, four.index[static_cast<std::size_t>(lane)]) += move[lane];
    report.largest_move = std::max(report.largest_move, move.abs().maxCoeff() / grid.spacing);
  }
  if (apic) {
    for (int lane = 0; lane < four.count; ++lane) {
      for (std::size_t k = 0; k < 9; ++k)
        particles.gradients(static_cast<Eigen::Index>(k), four.index[static_cast<std::size_t>(lane)]) =
            gradient[k][lane];
    }
  }
  if (how.deforms) deform_four(gradient, how.dt, materials, grid.spacing, four, particles, report.deform);
}

double count_outside(const Grid& grid, const Particles& particles) {
  return sum_over_blocks(particles.count(), particles_per_block,
                         [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
                           double outside = 0.0;
                           for (std::ptrdiff_t p = begin; p < end; ++p)
                             outside += !grid.contains(particles.positions.col(p));
                           return outside;
                         });
}

}  // namespace

AdvanceReport advance(const ActiveRegion& region, const PointsByCell& points, const Field& before,
                      const Field& after, const Advance& how, std::span<const Material> materials,
                      Particles& particles) {
  require_inside(region, points, particles.count());
  if (how.transfer == Transfer::apic) particles.gradients.resize(9, particles.count());
  const auto block = [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    BlockReport sum;
    CellFlow flow(region, before, after, how.transfer == Transfer::flip);
    for_each_four(region, points, begin, end, [&](const LaneParticles& four, int cell) {
      flow.read(cell);
      advance_four(region.grid, flow, how, materials, four, particles, sum.report);
    });
    return sum;
  };
  return sum_over_blocks<BlockReport>(points.cell_count(), cells_in_block, block).report;
}

void update_velocities_flip(const ActiveRegion& region, const Field& before, const Field& after,
                            double pic_share, Particles& particles) {
  advance(region, points_by_cell(region.grid, particles.positions), before, after,
          {0.0, Transfer::flip, pic_share, false}, {}, particles);
}

void update_velocities_apic(const ActiveRegion& region, const Field& after, Particles& particles) {
  advance(region, points_by_cell(region.grid, particles.positions), after, after,
          {0.0, Transfer::apic, 0.0, false}, {}, particles);
}

bool moves_further(const ActiveRegion& region, const PointsByCell& points, const Field& velocity, double dt,
                   const Particles& particles, double limit) {
  // No particle is faster than the fastest face.
  if (dt * velocity.abs().maxCoeff() <= limit * region.grid.spacing) return false;
  const Eigen::Matrix3Xd moves = dt * interpolate(region, points, velocity, particles.positions);
  return moves.cwiseAbs().maxCoeff() > limit * region.grid.spacing;
}

void wrap_positions(const Grid& grid, Eigen::Matrix3Xd& positions) {
  if (!grid.periodic[0] && !grid.periodic[1] && !grid.periodic[2]) return;
  for_each_block(positions.cols(), particles_per_block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t p = begin; p < end; ++p) positions.col(p) = grid.wrapped_position(positions.col(p));
  });
}

Departed remove_departed(const Grid& grid, Particles& particles) {
  Departed departed;
  if (count_outside(grid, particles) == 0.0) return departed;
  Eigen::Index kept = 0;
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    if (!grid.contains(particles.positions.col(p))) {
      ++departed.count;
      departed.mass += particles.masses[p];
      continue;
    }
    if (p != kept) particles.copy(p, kept);
    ++kept;
  }
  particles.resize(kept);
  return departed;
}

}  // namespace talus
