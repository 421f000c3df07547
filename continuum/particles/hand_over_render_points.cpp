// The part of render_points.h that gives points to particles: a plan of how many each has, then the new layout.
#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "continuum/parallel.h"
#include "continuum/particles/render_point_places.h"

namespace talus {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr std::ptrdiff_t particles_in_block = 256;
constexpr std::ptrdiff_t cells_in_block = 1024;
/// The first key of what is drawn for a particle, beside those for points: their hand-over.
constexpr std::uint64_t particle_key = std::uint64_t{1} << 32;

/// The particles that each owner's points go to, ascending: none where it departed, several where it split.
struct Heirs {
  std::vector<int> first, particles;  // of owner o: [first[o], first[o + 1])

  std::span<const int> of(int owner) const {
    const auto o = static_cast<std::size_t>(owner);
    return {particles.data() + first[o], particles.data() + first[o + 1]};
  }
};

std::size_t owner_of(const Particles& particles, Index p, Index which, const RenderPoints& drawn) {
  const int owner = particles.origins(which, p);
  if (owner >= drawn.particle_count())
    throw std::invalid_argument("a particle's origin has no render points");
  return static_cast<std::size_t>(owner);
}

Heirs heirs_of(const Particles& particles, const RenderPoints& drawn) {
  Heirs heirs{std::vector<int>(static_cast<std::size_t>(drawn.particle_count()) + 1, 0), {}};
  const auto for_each_origin = [&](const auto& use) {
    for (Index p = 0; p < particles.origins.cols(); ++p) {
      for (const Index which : {0, 1}) {
        if (particles.origins(which, p) >= 0) use(owner_of(particles, p, which, drawn), static_cast<int>(p));
      }
    }
  };
  for_each_origin([&](std::size_t owner, int) { ++heirs.first[owner + 1]; });
  std::partial_sum(heirs.first.begin(), heirs.first.end(), heirs.first.begin());
  heirs.particles.resize(static_cast<std::size_t>(heirs.first.back()));
  std::vector<int> next(heirs.first.begin(), heirs.first.end() - 1);
  for_each_origin(
      [&](std::size_t owner, int p) { heirs.particles[static_cast<std::size_t>(next[owner]++)] = p; });
  return heirs;
}

struct Plan {
  std::vector<std::int64_t> first;        // particles + 1, of the new layout
  std::vector<std::int64_t> first_added;  // particles + 1, counting the points that are new
  std::vector<char> hidden;
};

class HandOver {
 public:
  HandOver(const Surroundings& around, std::span<const Material> materials, const Eigen::Matrix3Xd& centres,
           const Particles& particles, const RenderPoints& drawn)
      : around_(around),
        materials_(materials),
        centres_(centres),
        particles_(particles),
        drawn_(drawn),
        heirs_(heirs_of(particles, drawn)) {}

  Plan plan() const {
    const auto count = static_cast<std::size_t>(particles_.count());
    Plan plan{std::vector<std::int64_t>(count + 1, 0), std::vector<std::int64_t>(count + 1, 0),
              std::vector<char>(count, 0)};
    for_each_block(particles_.count(), particles_in_block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t p = begin; p < end; ++p) plan_for(p, plan);
    });
    std::partial_sum(plan.first.begin(), plan.first.end(), plan.first.begin());
    std::partial_sum(plan.first_added.begin(), plan.first_added.end(), plan.first_added.begin());
    return plan;
  }

  /// Returns how many points left their parent.
  std::int64_t lay_out(const Plan& plan, RenderPoints::Layout& layout) const {
    layout.offsets.resize(static_cast<std::size_t>(plan.first.back()));
    layout.identities.resize(layout.offsets.size());
    return sum_over_blocks<std::int64_t>(particles_.count(), particles_in_block,
                                         [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
                                           std::int64_t resampled = 0;
                                           for (std::ptrdiff_t p = begin; p < end; ++p)
                                             resampled += lay_out_for(p, plan, layout);
                                           return resampled;
                                         });
  }

  std::int64_t departed() const {
    std::int64_t points = 0;
    for (int owner = 0; owner < drawn_.particle_count(); ++owner) {
      if (heirs_.of(owner).empty()) points += points_of(owner);
    }
    return points;
  }

 private:
  int origin(Index p, Index which) const {
    return particles_.has_origins() ? particles_.origins(which, p) : -1;
  }
  std::int64_t points_of(int owner) const {
    const auto o = static_cast<std::size_t>(owner);
    return drawn_.first[o + 1] - drawn_.first[o];
  }
  bool was_hidden(int owner) const { return drawn_.hidden[static_cast<std::size_t>(owner)] != 0; }

  Cover cover_at(Index p) const {
    if (around_.region == nullptr) return Cover::open;
    const Grid& grid = around_.grid;
    const Eigen::Vector3i place = grid.cell_at(particles_.positions.col(p));
    const int cell = grid.holds(place)
                         ? around_.region->cell_of_dense[static_cast<std::size_t>(grid.cell_index(place))]
                         : -1;
    return cell < 0 ? Cover::open : around_.cover[static_cast<std::size_t>(cell)];
  }

  /// How many points its mass is due; the share of a point by chance.
  std::int64_t due(Index p) const {
    const auto material = static_cast<std::size_t>(particles_.materials[static_cast<std::size_t>(p)]);
    const double points = drawn_.per_volume * particles_.masses[p] / materials_[material].max_density();
    if (std::abs(points - std::round(points)) < 1e-6) return std::llround(points);  // but for round-off
    Draws draws(drawn_.seed, particle_key + drawn_.hand_overs, static_cast<std::uint64_t>(p));
    return static_cast<std::int64_t>(std::floor(points + draws.unit()));
  }

  void plan_for(Index p, Plan& plan) const {
    const auto at = static_cast<std::size_t>(p);
    const Cover cover = cover_at(p);
    if (cover == Cover::buried) {
      plan.hidden[at] = 1;
      return;
    }
    std::int64_t points = 0;
    bool is_new = true, lacks = false;
    for (const Index which : {0, 1}) {
      const int owner = origin(p, which);
      if (owner < 0) continue;
      is_new = false;
      lacks = lacks || was_hidden(owner);
      for_each_taken(p, owner, [&](std::int64_t, const Vector3d&) { ++points; });
    }
    std::int64_t added = 0;
    if (is_new || (lacks && cover == Cover::open)) {
      added = std::max<std::int64_t>(0, due(p) - points);
      lacks = false;
    }
    plan.first[at + 1] = points + added;
    plan.first_added[at + 1] = added;
    plan.hidden[at] = lacks;
  }

  /// use(point, offset from p) for the points of an owner that go to particle p.
  template <class Use>
  void for_each_taken(Index p, int owner, const Use& use) const {
    const std::span<const int> heirs = heirs_.of(owner);
    const auto o = static_cast<std::size_t>(owner);
    const Vector3d shift =
        short_way(around_.grid, particles_.positions.col(p), centres_.col(static_cast<Index>(owner)));
    if (heirs.size() == 1) {
      for (std::int64_t k = drawn_.first[o]; k < drawn_.first[o + 1]; ++k)
        use(k, shift + drawn_.offsets[static_cast<std::size_t>(k)].cast<double>());
      return;
    }
    std::vector<Parent> halves;
    for (const int heir : heirs) halves.emplace_back(around_, particles_, heir);
    for (std::int64_t k = drawn_.first[o]; k < drawn_.first[o + 1]; ++k) {
      const Vector3d offset = drawn_.offsets[static_cast<std::size_t>(k)].cast<double>();
      if (heirs[nearest(halves, centres_.col(static_cast<Index>(owner)), offset)] == p)
        use(k, shift + offset);
    }
  }

  /// Which of the halves holds a point best; the first of equals. By one machine code, so that all who ask are told the same.
  [[gnu::noipa]] std::size_t nearest(std::span<const Parent> halves, const Vector3d& centre,
                                     const Vector3d& offset) const {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < halves.size(); ++i) {
      const double q =
          halves[i].squared_distance(short_way(around_.grid, halves[i].centre(), centre) + offset);
      if (q < least) {
        least = q;
        best = i;
      }
    }
    return best;
  }

  std::int64_t lay_out_for(Index p, const Plan& plan, RenderPoints::Layout& layout) const {
    const auto at = static_cast<std::size_t>(p);
    auto next = static_cast<std::size_t>(plan.first[at]);
    const auto end = static_cast<std::size_t>(plan.first[at + 1]);
    if (next == end) return 0;
    const Parent parent(around_, particles_, p);
    const auto sample = [&](std::uint32_t identity) {
      return parent.sample(Draws(drawn_.seed, drawn_.hand_overs, identity));
    };
    const auto write = [&](const Vector3d& offset, std::uint32_t identity) {
      layout.offsets[next] = offset.cast<float>();
      layout.identities[next++] = identity;
    };
    std::int64_t resampled = 0;
    for (const Index which : {0, 1}) {
      const int owner = origin(p, which);
      if (owner < 0) continue;
      for_each_taken(p, owner, [&](std::int64_t k, Vector3d offset) {
        const std::uint32_t identity = drawn_.identities[static_cast<std::size_t>(k)];
        const bool kept = parent.keeps(offset);
        write(kept ? offset : sample(identity), identity);
        resampled += !kept;
      });
    }
    for (std::int64_t added = plan.first_added[at]; next < end; ++added) {
      const auto identity = drawn_.next_identity + static_cast<std::uint32_t>(added);  // modulo 2^32
      write(sample(identity), identity);
    }
    return resampled;
  }

  const Surroundings& around_;
  std::span<const Material> materials_;
  const Eigen::Matrix3Xd& centres_;
  const Particles& particles_;
  const RenderPoints& drawn_;
  Heirs heirs_;
};

}  // namespace

std::vector<Cover> cover_of_cells(const ActiveRegion& region, const Field& fill) {
  std::vector<Cover> cover(static_cast<std::size_t>(region.cell_count()));
  const auto cover_of = [&](std::size_t cell) {
    const Eigen::Vector3i place = region.grid.cell_of_index(region.dense_of_cell[cell]);
    if ((place.array() == 0).any() || (place.array() == region.grid.cells.array() - 1).any())
      return Cover::open;
    double least = std::numeric_limits<double>::infinity();
    for (const int neighbour : region.cell_neighbours[cell])
      least = std::min(least, neighbour < 0 ? 0.0 : fill[neighbour]);
    return least >= buried_fill ? Cover::buried : least < open_fill ? Cover::open : Cover::between;
  };
  for_each_block(region.cell_count(), cells_in_block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto cell = static_cast<std::size_t>(begin); cell < static_cast<std::size_t>(end); ++cell)
      cover[cell] = cover_of(cell);
  });
  return cover;
}

HandOverReport hand_over(const Surroundings& around, std::span<const Material> materials,
                         const Eigen::Matrix3Xd& centres, const Particles& particles, RenderPoints& drawn) {
  if (centres.cols() != drawn.particle_count())
    throw std::invalid_argument("render points belong to other particles");
  ++drawn.hand_overs;
  HandOverReport report;
  const std::int64_t before = drawn.count();
  const HandOver handing(around, materials, centres, particles, drawn);
  Plan plan = handing.plan();
  report.resampled = handing.lay_out(plan, drawn.spare);
  report.departed = handing.departed();
  report.added = plan.first_added.back();
  report.hidden = before - report.departed + report.added - plan.first.back();
  drawn.offsets.swap(drawn.spare.offsets);
  drawn.identities.swap(drawn.spare.identities);
  drawn.first.swap(plan.first);
  drawn.hidden.swap(plan.hidden);
  drawn.next_identity += static_cast<std::uint32_t>(plan.first_added.back());
  return report;
}

RenderPoints sample_render_points(const Surroundings& around, std::span<const Material> materials,
                                  double per_volume, std::uint64_t seed, const Particles& particles) {
  RenderPoints drawn;
  drawn.per_volume = per_volume;
  drawn.seed = seed;
  drawn.first = {0};
  if (particles.has_origins()) throw std::invalid_argument("new particles have no origins");
  hand_over(around, materials, Eigen::Matrix3Xd(3, 0), particles, drawn);
  return drawn;
}

}  // namespace talus
