#include "validation/stored_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "continuum/files/atomic_file.h"
#include "continuum/files/checked_table.h"
#include "continuum/files/provenance.h"
#include "dem_cases/measure.h"
#include "dem_cases/process.h"

namespace talus::validation {
namespace {

using nlohmann::json;

constexpr const char* snapshot_name = "snapshots.h5";
constexpr const char* record_name = "record.json";

/// A deposit that the far wall has shaped, or that lost something on the way, is not the case's. Throws InputError.
void check_inside_tank(const analysis::SnapshotSeries& series, const dem::Case& column) {
  const double released = series.front().volumes.sum();
  for (const auto& snapshot : series) {
    const double lost = 1.0 - snapshot.volumes.sum() / released;
    if (std::abs(lost) > 1e-9) {
      throw InputError(fmt::format("{:.3g} of the volume was gone at t = {:.4g} s: something left the tank",
                                   lost, snapshot.time));
    }
    if (snapshot.positions.row(0).maxCoeff() > column_geometry(column).tank_length - column.grains.diameter) {
      throw InputError(
          fmt::format("at t = {:.4g} s something reached the far wall: raise tank_length_m in {}",
                      snapshot.time, column.file.string()));
    }
  }
}

std::string why_it_failed(const Job& job, const dem::ProcessResult& result,
                          const std::filesystem::path& folder) {
  if (result.interrupted) return "interrupted";
  if (result.timed_out)
    return fmt::format("stopped at its time limit of {} s; raise time_limit_s in the suite", job.time_limit);
  const std::string told = job.backend.failure_text(folder);
  return fmt::format("ended with exit code {}{}", result.exit_code, told.empty() ? "" : ": " + told);
}

}  // namespace

std::string Job::label() const { return fmt::format("{} seed {}", backend_name, seed); }

std::filesystem::path Job::partial_folder() const { return folder.string() + ".partial"; }

std::filesystem::path run_folder(const std::filesystem::path& output, const std::string& case_name,
                                 const std::string& backend, std::uint64_t seed) {
  return output / "runs" / case_name / fmt::format("{}_seed{}", backend, seed);
}

void run_job(const dem::Case& column, const Job& job, const std::function<bool()>& stop) {
  const auto folder = job.partial_folder();
  std::filesystem::remove_all(folder);
  make_writable_folder(folder);
  job.backend.write_input(folder);
  const std::string input_hash = sha256_of_folder(folder);

  dem::ProcessRequest request;
  // Should this program be killed, the run goes with it.
  request.command = {"/usr/bin/setpriv", "--pdeathsig", "KILL"};
  request.command.insert(request.command.end(), job.backend.command.begin(), job.backend.command.end());
  request.folder = folder;
  request.log = job.backend.log_file;
  request.environment = {{"OMP_NUM_THREADS", "1"}};
  request.time_limit = std::chrono::duration<double>(job.time_limit);
  request.stop = stop;
  const dem::ProcessResult result = dem::run_process(request);
  if (result.exit_code != 0 || result.timed_out || result.interrupted) {
    throw RunError(
        fmt::format("{}: {} (see {})", job.label(), why_it_failed(job, result, folder), folder.string()));
  }
  try {
    const auto series = job.backend.read_output(folder);
    check_inside_tank(series, column);
    json record = dem::measure(column, series, job.backend.thickness);
    record["backend"] = job.backend_name;
    record["seed"] = job.seed;
    record["status"] = "ok";
    record["input_hash"] = input_hash;
    record["version"] = job.backend.version;
    record["command"] = job.backend.command;
    record["wall_s"] = result.wall_seconds;
    record["cpu_s"] = result.cpu_seconds;
    record["thickness_m"] = job.backend.thickness;
    record["count"] = series.back().volumes.size();
    record["preflight"] = job.backend.preflight;
    record["solver"] = job.backend.solver_summary(folder);
    record["time_step_s"] = record["solver"].is_object() ? record["solver"].at("longest_step_s")
                                                         : json(column.protocol.time_step);
    if (!std::filesystem::exists(folder / snapshot_name)) {
      json made_by = provenance();
      made_by["backend"] = job.backend_name;
      made_by["backend_version"] = job.backend.version;
      made_by["input_hash"] = input_hash;
      analysis::write_snapshots(folder / snapshot_name, series, made_by.dump());
    }
    write_file_atomically(folder / record_name, record.dump(1) + "\n");
  } catch (const std::exception& error) {
    throw RunError(fmt::format("{}: {} (see {})", job.label(), error.what(), folder.string()));
  }
  std::filesystem::remove_all(job.folder);
  std::filesystem::rename(folder, job.folder);
}

json read_record(const std::filesystem::path& folder) {
  const auto file = folder / record_name;
  try {
    return json::parse(read_file(file));
  } catch (const json::exception& error) {
    throw InputError(fmt::format("{}: not a record of a run: {}", file.string(), error.what()));
  }
}

json picture_of_run(const json& record, const std::filesystem::path& folder, int layers) {
  const auto series = analysis::read_snapshots(folder / snapshot_name);
  const auto& first = series.front();
  const auto& last = series.back();
  const double thickness = record.at("thickness_m"),
               phi = record.at("observables").at("settled_volume_fraction");
  // A grain is drawn as itself; a particle as the disc that shares the bulk area seen from the side with the other
  // `layers` - 1 particles behind it.
  const bool continuum = record.at("backend") == "continuum";
  const auto radius_of = [&](double volume) {
    return continuum ? std::sqrt(layers * volume / (phi * thickness * std::numbers::pi))
                     : std::cbrt(0.75 * volume / std::numbers::pi);
  };
  const auto micrometres = [](double metres) { return std::round(metres * 1e6) * 1e-6; };
  const bool same_items = first.volumes.size() == last.volumes.size();
  std::vector<double> x, z, radius, x0;
  for (Eigen::Index i = 0; i < last.volumes.size(); ++i) {
    x.push_back(micrometres(last.positions(0, i)));
    z.push_back(micrometres(last.positions(2, i)));
    x0.push_back(micrometres((same_items ? first : last).positions(0, i)));
    radius.push_back(micrometres(radius_of(last.volumes[i])));
  }
  return {{"backend", record.at("backend")},
          {"seed", record.at("seed")},
          {"time", last.time},
          {"x", x},
          {"z", z},
          {"radius", radius},
          {"x0", x0}};
}

}  // namespace talus::validation
