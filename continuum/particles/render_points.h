// Render points: what is drawn of the sand (method.md, section 11; section 5.6 of the source). They carry no mass and the
// simulation never reads them. continuum/render writes and draws them.
//
// Each particle owns points, sampled uniformly in its ellipsoid, as many as its mass is due: a point stands for the same
// mass of sand for as long as it lives, so that splits and merges neither thin the picture out nor crowd it. A point is kept
// as its offset d from its parent's centre x, and moves with the grid's velocity v~, by the interpolation that particles use:
//
//   d <- d + dt (v~(x + d) - v~(x))
//
// so it comes along, at no cost, wherever density correction, walls and periodic seams put its parent. Where v~ is linear
// it keeps its Mahalanobis distance q = sqrt(d' S^-1 d), by 5.42, but for the bounds of deform.h. Where no particle is (beyond
// the free surface) and further than a cell from the parent's, v~ is that of the nearest place of the parent's cell.
//
// Points lie in the order of their parents, so that there is no list of parents to keep up: what reorders, removes, splits
// or merges particles carries Particles::origins along, and hand_over, once a step, lays the points out anew in one pass,
// which resamples and hides as well. A search for new parents by cell and ellipsoid, the other way, costs several distances a
// point and step, and can give a point to a stranger; the map costs one branch a particle. In hand_over,
//   - of a particle that split, each half takes the points of least q in it; what a merge makes takes all of both;
//   - a point of q > farthest_offset is sampled anew. Where a particle splits in two, its points of q <= 1 are at most
//     sqrt(1.6) = 1.265 from the nearer half (at its waist): none of them is sampled anew;
//   - a point inside a wall, or beyond a side that is one, is put on it; where that fails, sampled anew;
//   - particles in buried cells lose their points, and in open cells get them back (Cover).
// All of it is the same for any number of threads, bit for bit: what is random in a point hangs on the seed, the point's
// identity and the number of the hand-over.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "continuum/grid/active_region.h"
#include "continuum/grid/operators.h"
#include "continuum/materials/material.h"
#include "continuum/particles/particles.h"

namespace talus {

/// 16 bytes a point, and as much again where the next layout is made.
struct RenderPoints {
  double per_volume = 0.0;  // 1/m^3 of sand at its packing limit; 0: no points are wanted
  std::uint64_t seed = 0;

  std::vector<Eigen::Vector3f> offsets;   // from the parent's centre, m
  std::vector<std::uint32_t> identities;  // stay with the points; numbers start again after 2^32
  std::vector<std::int64_t> first;  // particles + 1: the points of particle p are [first[p], first[p + 1])
  std::vector<char> hidden;         // particles: lacks points that it, or one merged into it, was due

  std::uint32_t next_identity = 0;
  std::uint32_t hand_overs = 0;  // how many there were
  struct Layout {
    std::vector<Eigen::Vector3f> offsets;
    std::vector<std::uint32_t> identities;
  } spare;  // memory for the next layout

  bool wanted() const { return per_volume > 0.0; }
  std::int64_t count() const { return static_cast<std::int64_t>(offsets.size()); }
  std::int64_t particle_count() const { return static_cast<std::int64_t>(hidden.size()); }
};

inline constexpr double farthest_offset = 1.3;  // q

/// Moves the points with `velocity` (all faces), before the particles move: `points` are the particles by cell, and each
/// one's first origin is the number of its points in `drawn`. dt in s. Throws std::invalid_argument where particles lie
/// outside the region or have no origins.
void move_render_points(const ActiveRegion& region, const PointsByCell& points, const Field& velocity,
                        double dt, const Particles& particles, RenderPoints& drawn);

/// Whether points in a cell can be seen. Buried: the cell, and all 26 around it, hold sand of a fill of at least
/// buried_fill; open: one of them is below open_fill, or not there; in between, points stay as they are, so that the noise
/// of a fill does not make them flicker. Nothing hides what lies along a wall or along an end of the domain, periodic ones
/// too: nothing says whether they are seen through.
enum class Cover : char { open, between, buried };
inline constexpr double buried_fill = 0.85, open_fill = 0.7;

/// Of each cell of the region; `fill` as in GridState.
std::vector<Cover> cover_of_cells(const ActiveRegion& region, const Field& fill);

/// Where points may be, and what hides them.
struct Surroundings {
  const Grid& grid;
  const DomainSides& sides;
  const Openings& openings;
  const ActiveRegion* region;    // null: all is open
  std::span<const Cover> cover;  // of its cells
};

struct HandOverReport {
  std::int64_t added = 0;      // for new particles, and those no longer buried
  std::int64_t hidden = 0;     // with particles that became buried
  std::int64_t resampled = 0;  // left their parent
  std::int64_t departed = 0;   // with particles that left the domain

  HandOverReport& operator+=(const HandOverReport& other) {
    added += other.added;
    hidden += other.hidden;
    resampled += other.resampled;
    departed += other.departed;
    return *this;
  }
};

/// Lays the points out for the particles as they are now. `centres`: where each owner of points was when they were last
/// offsets from it, before it split or merged; 3 x particle_count() of `drawn`. Particles without origins, or all if none
/// are tracked, are new. Throws std::invalid_argument where an origin has no points' number.
HandOverReport hand_over(const Surroundings& around, std::span<const Material> materials,
                         const Eigen::Matrix3Xd& centres, const Particles& particles, RenderPoints& drawn);

/// Points for particles that have none yet.
RenderPoints sample_render_points(const Surroundings& around, std::span<const Material> materials,
                                  double per_volume, std::uint64_t seed, const Particles& particles);

/// 3 x count, m; inside the domain along periodic axes.
Eigen::Matrix3Xf render_positions(const Grid& grid, const Particles& particles, const RenderPoints& drawn);

/// How much a point's normal is off the sand's.
inline constexpr double default_normal_jitter = 0.2;

/// 3 x count, unit vectors out of the sand: n = -h grad(fill) + jitter * u, over its length, u uniform in the unit ball and
/// each point's own for as long as it lives. The gradient is that of central differences at the cells' centres, between them
/// trilinear; walls and ends that are walls have none across them. Where n would be 0 (no gradient and no jitter), 0.
/// `fill`: that of deposit_fill, for the particles and their region.
Eigen::Matrix3Xf render_normals(const ActiveRegion& region, const DomainSides& sides,
                                const Openings& openings, const Field& fill, const Particles& particles,
                                const RenderPoints& drawn, double jitter = default_normal_jitter);

}  // namespace talus
