#include "dem_cases/falling_sphere.h"

#include <fmt/format.h>

#include <cmath>

#include "analysis/snapshot.h"

namespace talus::dem {

std::optional<FallingSphere> falling_sphere(const Case& a_case) {
  const auto* g = std::get_if<ImpactGeometry>(&a_case.geometry);
  if (g == nullptr) return std::nullopt;
  const double radius = 0.5 * g->sphere_diameter, gap = start_clearance * a_case.grains.diameter;
  const double square = g->impact_speed * g->impact_speed, twice_gravity = 2.0 * a_case.protocol.gravity;
  return FallingSphere{.radius = radius,
                       .density = g->sphere_density,
                       .centre = {0.0, 0.0, g->height + gap + radius},
                       .speed = std::sqrt(square - twice_gravity * gap),
                       // No grain is thrown much faster than the sphere falls.
                       .room = g->height + gap + 2.0 * g->sphere_diameter + square / twice_gravity};
}

analysis::BodyTrack read_track(const Case& a_case, const std::filesystem::path& folder) {
  if (!falling_sphere(a_case)) return {};
  const auto file = folder / analysis::body_track_file;
  auto track = analysis::read_body_track(file);
  if (track.back().time < a_case.protocol.run_time - 0.5 * a_case.protocol.snapshot_interval) {
    throw analysis::SnapshotError(
        fmt::format("{}: ends at {:.4g} s of {:.4g}: the run did not finish; run it again", file.string(),
                    track.back().time, a_case.protocol.run_time));
  }
  return track;
}

}  // namespace talus::dem
