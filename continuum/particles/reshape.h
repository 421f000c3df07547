// Particles split where the flow draws them out and merge where it crowds them (section 8 of method.md, step 6d of
// figure 5.7), so that a cell holds neither too few to sample it nor more than it needs.
//
// Split: a particle of longest semi-axis a along e becomes two of half the mass at x +- d e, with
//   S' = S - 5 d^2 e e^T,   5 d^2 = 3/4 a^2,   v' = v +- C d e,   C' = C   (C: the velocity gradient it carries)
// so a is halved, and the volume with it. A mass m moving as v + C (x - x_p) over its ellipsoid is conserved: mass,
// centre, second moment, momentum, angular momentum and energy are those of the parent. With FLIP, C = 0 and v' = v.
//
// Merge: with w = m_j / m, gap = x_j - x_i and jump = v_j - v_i, and the same conservation laws but for energy,
//   x = x_i + w gap,  v = v_i + w jump,  S = (1-w) S_i + w S_j + 5 w (1-w) gap gap^T
//   C S = (1-w) C_i S_i + w C_j S_j + 5 w (1-w) jump gap^T
// which is the motion v + C (x - x_p) nearest to the pair's: the energy lost is never negative. A pair that carries no
// gradient (FLIP) gets none: then its spin about the common centre, w (1-w) m gap x jump, is lost with that energy.
//
// Both work in the order of the particles, which is all that the result depends on, and leave them untouched, bit for
// bit, where nothing qualifies. A shape that is not finite never does.
#pragma once

#include <functional>
#include <span>

#include "continuum/grid/grid.h"
#include "continuum/materials/material.h"
#include "continuum/particles/particles.h"

namespace talus {

/// Whether sand that is at `from` may be at `to`: neither there nor on the straight way is a solid, however thin. Over periodic ends the way
/// goes on; `to` lies in the domain but for them.
using Allowed = std::function<bool(const Eigen::Vector3d& from, const Eigen::Vector3d& to)>;

/// When to split and merge. Lengths in cells h; masses in those of a full cell, rho_max h^3.
struct ReshapeRules {
  /// A longer semi-axis splits. Not below 0.62, a sphere of the volume of a cell: that is where a spreading cloud stops
  /// growing (deform.h), and it need not split. Above, gaps open: in a row of particles that touch, centres are 1.6
  /// semi-axes apart, and a cell without a centre counts as empty. Nor above 0.91, whose second moment a^2 / 5 is that
  /// of the trilinear kernel, h^2 / 6: all the grid ever sees of a particle.
  double split_semi_axis = 0.75;
  /// The longest semi-axis of a merged particle. At rest on its packing limit it may grow once by 2^(1/3), when two
  /// that overlapped become one with room for both (deform.h), and must not split then: 0.55 * 1.26 < 0.75.
  double merge_semi_axis = 0.55;
  double merge_distance = 0.5;  // between centres; that of a lattice of 8 a cell
  /// Relative speed, h / dt. In a step of 0.25 sqrt(h/g) a merge costs at most 0.005 m g h, in one of 0.4 cells at the
  /// fastest speed 0.4 % of the energy m would have at that speed; in half the step, four times that.
  double merge_speed = 0.05;
  double largest_merged_mass = 1.0 / 8.0;   // so that a full cell is never left with fewer than 8 on average
  double smallest_split_mass = 1.0 / 64.0;  // of a child: what bounds the number of particles
  int fewest_in_cell = 8;                   // a cell that holds no more than this merges none (method.md)
};

struct SplitReport {
  Eigen::Index splits = 0;
  // Particles left too long:
  Eigen::Index put_off = 0;     // a child would lie outside the domain, in a solid or behind one
  Eigen::Index too_light = 0;   // children below smallest_split_mass
  Eigen::Index unfinished = 0;  // after most_split_rounds
};

struct MergeReport {
  Eigen::Index merges = 0;
  double energy_lost = 0.0;  // kinetic, J

  MergeReport& operator+=(const MergeReport& other) {
    merges += other.merges;
    energy_lost += other.energy_lost;
    return *this;
  }
};

struct ReshapeReport {
  SplitReport split;
  MergeReport merge;
};

/// Each round halves what is too long; deform.h lets no particle exceed 6.3 h, which takes four.
inline constexpr int most_split_rounds = 8;

/// Splits until none is too long. One child takes its parent's place, the other is added at the end. Periodic axes wrap.
SplitReport split(const Grid& grid, std::span<const Material> materials, const Allowed& allowed,
                  const ReshapeRules& rules, Particles& particles);

/// Merges pairs of one material that lie in the same cell: each particle at most once, with the nearest that qualifies
/// of the next 64 in its cell. The first takes the place of both. Pairs across a face, and so across the seam of a
/// periodic axis, wait until the flow has carried them into one cell. dt in s.
MergeReport merge(const Grid& grid, std::span<const Material> materials, const Allowed& allowed,
                  const ReshapeRules& rules, double dt, Particles& particles);

/// Split, then merge.
ReshapeReport split_and_merge(const Grid& grid, std::span<const Material> materials, const Allowed& allowed,
                              const ReshapeRules& rules, double dt, Particles& particles);

}  // namespace talus
