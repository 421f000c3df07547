// The sphere of an impact: where every code lets it go at the release, and the track that it leaves.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>

#include "analysis/body_track.h"
#include "dem_cases/case.h"

namespace talus::dem {

/// How far above the nominal height of the bed the sphere starts, in grain diameters: a settled bed ends less than one of them above
/// it, so that no grain is touched.
inline constexpr double start_clearance = 2.0;

struct FallingSphere {
  double radius;           // m
  double density;          // kg/m^3
  Eigen::Vector3d centre;  // m, at the release
  double speed;            // m/s, downwards, at the release
  double room;             // m, up to which height it and what it throws up may come
};

/// Nothing for a case without one. The case must be one that read_case() takes.
std::optional<FallingSphere> falling_sphere(const Case& a_case);

/// What the run in the folder has written of the sphere; empty for a case without one. Throws SnapshotError, also when the track does not reach the
/// end of the run.
analysis::BodyTrack read_track(const Case& a_case, const std::filesystem::path& folder);

}  // namespace talus::dem
