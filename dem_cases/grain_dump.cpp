#include "dem_cases/grain_dump.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <numbers>

#include "continuum/files/atomic_file.h"
#include "continuum/files/checked_table.h"
#include "dem_cases/container.h"
#include "dem_cases/dump_reader.h"
#include "dem_cases/time_step.h"

namespace talus::dem {
namespace {

using analysis::Snapshot;

std::string in_words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

void check_grain(const DumpReader& reader, std::int64_t id, const Eigen::Vector3d& position,
                 const Eigen::Vector3d& velocity, const Container& container, bool released) {
  const auto complain = [&](const std::string& what) {
    return reader.error(
        fmt::format("grain {} {}: position ({:.6g}, {:.6g}, {:.6g}) m; the run is void, look at its log", id,
                    what, position.x(), position.y(), position.z()));
  };
  if (!position.allFinite() || !velocity.allFinite()) throw complain("is not finite");
  if (const auto through = leak(container, position, released); !through.empty())
    throw complain(fmt::format("leaked through the {}", in_words(through)));
}

Snapshot read_snapshot(DumpReader& reader, const Case& column, const Packing& packing, std::int64_t step) {
  reader.expect("ITEM: TIMESTEP");
  if (const auto found = reader.number_line<std::int64_t>(); found != step) {
    throw reader.error(
        fmt::format("snapshot of step {} where step {} belongs; the file is damaged", found, step));
  }
  reader.expect("ITEM: NUMBER OF ATOMS");
  const auto count = packing.mobile_count();
  if (const auto found = reader.number_line<Eigen::Index>(); found != count) {
    throw reader.error(fmt::format(
        "{} grains at step {} where {} started: grains were lost; the run is void, look at its log", found,
        step, count));
  }
  reader.expect("ITEM: BOX BOUNDS");
  for (int axis = 0; axis < 3; ++axis) reader.line();
  reader.expect("ITEM: ATOMS id x y z vx vy vz");

  const Container container = container_of(column);
  const double period = container.upper.y() - container.lower.y();
  Snapshot snapshot{.time = static_cast<double>(step) * column.protocol.time_step,
                    .positions = analysis::Vectors(3, count),
                    .velocities = analysis::Vectors(3, count),
                    .volumes = Eigen::VectorXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    auto rest = reader.line();
    if (const auto id = reader.next<std::int64_t>(rest); id != packing.fixed_count + i + 1) {
      throw reader.error(
          fmt::format("grain {} where grain {} belongs: a grain was lost or the file is damaged", id,
                      packing.fixed_count + i + 1));
    }
    Eigen::Vector3d position, velocity;
    for (double& value : position) value = reader.next<double>(rest);
    for (double& value : velocity) value = reader.next<double>(rest);
    check_grain(reader, packing.fixed_count + i + 1, position, velocity, container, step > 0);
    if (container.periodic) position.y() -= period * std::floor(position.y() / period);
    snapshot.positions.col(i) = position;
    snapshot.velocities.col(i) = velocity;
    snapshot.volumes[i] = 4.0 / 3.0 * std::numbers::pi * std::pow(packing.radii[packing.fixed_count + i], 3);
  }
  return snapshot;
}

void check_at_rest(const DumpReader& reader, const Case& column, const Snapshot& release) {
  const double energy =
      0.5 * (release.velocities.colwise().squaredNorm().transpose().array() * release.volumes.array()).sum();
  const double scale = release.volumes.sum() * column.protocol.gravity * fill_height(column.geometry);
  if (energy / scale > column.protocol.rest_energy) {
    throw reader.error(
        fmt::format("the fill was not at rest when the gate opened: kinetic energy / (m g H0) = {:.3g}, "
                    "allowed is protocol.rest_energy = {:.3g}; lengthen protocol.settle_time_s in {}",
                    energy / scale, column.protocol.rest_energy, column.file.string()));
  }
}

void check_clear(const DumpReader& reader, const Case& column, const Packing& packing,
                 const Snapshot& snapshot) {
  for (const Plane& plane : container_of(column).planes) {
    if (!plane.must_stay_clear) continue;
    for (Eigen::Index i = 0; i < snapshot.volumes.size(); ++i) {
      const double distance = (snapshot.positions(plane.axis, i) - plane.at) * plane.inward;
      if (distance <= packing.radii[packing.fixed_count + i]) {
        throw reader.error(fmt::format(
            "grain {} reached the {} {:.4g} s after the release; lengthen tank_length_m or floor_side_m of "
            "[geometry] in {}",
            packing.fixed_count + i + 1, in_words(plane.name), snapshot.time, column.file.string()));
      }
    }
  }
}

}  // namespace

analysis::SnapshotSeries read_grain_dump(const Case& column, const Packing& packing,
                                         const std::filesystem::path& folder) {
  const auto file = folder / dump_file;
  if (!std::filesystem::exists(file)) {
    throw InputError(
        fmt::format("{}: the run wrote no snapshot; look at its log in the same folder", file.string()));
  }
  DumpReader reader(file);
  const StepSchedule schedule = step_schedule(column);
  analysis::SnapshotSeries series;
  while (!reader.at_end()) {
    series.push_back(read_snapshot(reader, column, packing,
                                   schedule.per_snapshot * static_cast<std::int64_t>(series.size())));
    if (series.size() == 1) check_at_rest(reader, column, series.front());
    check_clear(reader, column, packing, series.back());
  }
  const auto wanted = static_cast<std::size_t>(schedule.snapshot_count) + 1;
  if (series.size() != wanted) {
    throw InputError(fmt::format("{}: {} snapshots of {}: the run did not finish; run it again",
                                 file.string(), series.size(), wanted));
  }
  return series;
}

double progress_of_run(const Case& column, const std::filesystem::path& folder) {
  std::ifstream in(folder / progress_file);
  std::int64_t lines = 0;
  for (std::string line; std::getline(in, line);) lines += !line.empty();
  const StepSchedule schedule = step_schedule(column);
  const auto wanted = schedule.settle / schedule.per_snapshot + schedule.snapshot_count;
  return std::min(1.0, static_cast<double>(lines) / static_cast<double>(wanted));
}

}  // namespace talus::dem
