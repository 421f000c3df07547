#include "validation/backends/backend.h"

#include <fmt/format.h>

#include "continuum/files/checked_table.h"
#include "dem_cases/liggghts/liggghts.h"
#include "dem_cases/packing/packing.h"
#include "dem_cases/time_step.h"
#include "dem_cases/yade/yade.h"

namespace talus::validation {
namespace {

nlohmann::json preflight(const dem::Case& column) {
  const dem::TimeStepCheck check = dem::check_time_step(column);
  return {{"time_step_s", column.protocol.time_step},
          {"rayleigh_time_s", check.rayleigh_time},
          {"rayleigh_fraction", check.rayleigh_fraction},
          {"hertz_time_s", check.hertz_time},
          {"hertz_fraction", check.hertz_fraction}};
}

/// What the two discrete codes have in common: one packing, one preflight.
Backend discrete_backend(const RunRequest& request) {
  Backend backend;
  backend.thickness = column_geometry(request.column).thickness;
  backend.preflight = preflight(request.column);
  backend.solver_summary = [](const std::filesystem::path&) { return nlohmann::json(); };
  return backend;
}

}  // namespace

Backend make_backend(std::string_view name, const RunRequest& request) {
  if (name == "continuum") return make_continuum_backend(request);
  Backend backend = discrete_backend(request);
  const dem::Case& column = request.column;
  const dem::Packing packing = dem::make_packing(column, request.seed);
  const auto bind = [&](auto version, auto write_input, auto command, auto progress, auto failure_text,
                        auto read_output, std::string_view log_file) {
    backend.version = version();
    backend.command = command();
    backend.log_file = log_file;
    backend.write_input = [&column, packing, write_input](const auto& folder) {
      write_input(column, packing, folder);
    };
    backend.progress = [&column, progress](const auto& folder) { return progress(column, folder); };
    backend.failure_text = failure_text;
    backend.read_output = [&column, packing, read_output](const auto& folder) {
      return read_output(column, packing, folder);
    };
  };
  if (name == "liggghts") {
    using namespace dem::liggghts;
    bind(version, write_input, command, progress, failure_text, read_output, log_file);
  } else if (name == "yade") {
    using namespace dem::yade;
    bind(version, write_input, command, progress, failure_text, read_output, log_file);
  } else {
    throw InputError(fmt::format("backend '{}' is not known", name));
  }
  return backend;
}

}  // namespace talus::validation
