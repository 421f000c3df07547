#include "dem_cases/reference/make_run.h"

#include <fmt/format.h>

#include <cmath>
#include <mutex>

#include "continuum/files/atomic_file.h"
#include "continuum/files/input_error.h"
#include "continuum/files/process.h"
#include "continuum/files/provenance.h"
#include "dem_cases/reference/store.h"

namespace talus::dem {
namespace {

using nlohmann::json;

/// Six digits are far beyond what a chaotic flow repeats from code to code, and keep git's copy small.
json rounded(const json& value) {
  if (value.is_number_float()) return std::stod(fmt::format("{:.6g}", value.get<double>()));
  if (!value.is_structured()) return value;
  json result = value;
  for (auto& element : result) element = rounded(element);
  return result;
}

/// The first number that is none, as "observables.runout"; empty when all are finite.
std::string not_finite(const json& value, const std::string& name) {
  if (value.is_number() && !std::isfinite(value.get<double>())) return name;
  if (value.is_null()) return name;
  if (!value.is_structured()) return {};
  for (const auto& [key, element] : value.items()) {
    if (auto found = not_finite(element, name.empty() ? key : name + "." + key); !found.empty()) return found;
  }
  return {};
}

/// GSL's error handler is one for the whole program, so fits must not run side by side.
json measure_alone(const PlannedRun& run, const std::filesystem::path& folder) {
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  return run.measure(folder);
}

std::string why_it_failed(const PlannedRun& run, const ProcessResult& result,
                          const std::filesystem::path& folder) {
  if (result.interrupted) return "interrupted";
  if (result.timed_out) return fmt::format("stopped at its time limit of {:.0f} s", run.time_limit);
  const std::string told = run.failure_text(folder);
  return fmt::format("ended with exit code {}{}", result.exit_code, told.empty() ? "" : ": " + told);
}

}  // namespace

std::filesystem::path run_folder(const std::filesystem::path& runs, const PlannedRun& run) {
  return runs / run.case_name / run.point_name / fmt::format("{}_seed{}", run.code, run.seed);
}

std::string prepare_run(const PlannedRun& run, const std::filesystem::path& folder) {
  std::filesystem::remove_all(folder);
  make_writable_folder(folder);
  run.write_input(folder);
  const json identity{{"command", run.command}, {"measurement", run.measurement}};
  write_file_atomically(folder / "measurement.json", identity.dump(1) + "\n");
  return sha256_of_folder(folder);
}

std::optional<json> current_record(const std::filesystem::path& reference, const PlannedRun& run) {
  const ScratchFolder folder;
  return find_record(reference, run, prepare_run(run, folder.path() / "input"));
}

json make_run(const PlannedRun& run, const std::filesystem::path& folder, const std::string& input_hash,
              const std::function<bool()>& stop) {
  ProcessRequest request;
  // Should this program be killed, the run goes with it.
  request.command = {"/usr/bin/setpriv", "--pdeathsig", "KILL"};
  request.command.push_back(run.program.empty() ? run.command.front() : run.program.string());
  request.command.insert(request.command.end(), run.command.begin() + 1, run.command.end());
  request.folder = folder;
  request.log = run.log_file;
  request.environment = {{"OMP_NUM_THREADS", "1"}};
  request.time_limit = std::chrono::duration<double>(run.time_limit);
  request.stop = stop;
  const ProcessResult result = run_process(request);
  const auto failed = [&](const std::string& why) {
    return RunFailed(fmt::format("{}: {} (see {})", label(run), why, folder.string()));
  };
  if (result.exit_code != 0 || result.timed_out || result.interrupted)
    throw failed(why_it_failed(run, result, folder));
  json record;
  try {
    const json measured = measure_alone(run, folder);
    if (const auto bad = not_finite(measured, {}); !bad.empty())
      throw std::runtime_error(fmt::format("{} is not a finite number", bad));
    record = rounded(measured);
  } catch (const std::exception& error) {
    throw failed(error.what());
  }
  record["case"] = run.case_name;
  record["point"] = run.point_name;
  record["code"] = run.code;
  record["seed"] = run.seed;
  record["version"] = run.version;
  record["command"] = run.command;
  record["input_hash"] = input_hash;
  record["cpu_s"] = rounded(result.cpu_seconds);
  record["wall_s"] = rounded(result.wall_seconds);
  record["made_by"] = provenance();
  return record;
}

}  // namespace talus::dem
