#include "continuum/render/render_frame.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace talus {

RenderFrame render_frame_of(const State& state) {
  if (state.materials.size() > std::numeric_limits<std::uint8_t>::max())
    throw std::invalid_argument("render points know no more than 255 materials");
  const RenderPoints& drawn = state.render_points;
  const Particles& particles = state.particles;
  RenderFrame frame;
  frame.time = state.time;
  if (particles.count() == 0) return frame;
  const ActiveRegion region =
      make_active_region(state.grid, state.sides, particles.positions, state.openings);
  frame.positions = render_positions(state.grid, particles, drawn);
  frame.normals = render_normals(region, state.sides, state.openings,
                                 deposit_fill(region, particles, state.materials), particles, drawn);
  frame.identities = drawn.identities;
  frame.materials.resize(frame.count());
  frame.speeds.resize(frame.count());
  for (std::int64_t p = 0; p < drawn.particle_count(); ++p) {
    const auto at = static_cast<std::size_t>(p);
    const auto speed = static_cast<float>(particles.velocities.col(p).norm());
    std::fill(frame.materials.begin() + drawn.first[at], frame.materials.begin() + drawn.first[at + 1],
              static_cast<std::uint8_t>(particles.materials[at]));
    std::fill(frame.speeds.begin() + drawn.first[at], frame.speeds.begin() + drawn.first[at + 1], speed);
  }
  return frame;
}

}  // namespace talus
