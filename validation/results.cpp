#include "validation/results.h"

#include <fmt/format.h>

#include <numbers>
#include <set>

#include "continuum/files/atomic_file.h"
#include "continuum/files/checked_table.h"
#include "continuum/files/provenance.h"
#include "validation/gates/truth.h"

namespace talus::validation {
namespace {

using nlohmann::json;

constexpr int schema_version = 1;

json parameters_of(const dem::Case& c, const ContinuumResolution& resolution) {
  return {
      {"geometry",
       {{"column_length_m", column_geometry(c).column_length},
        {"column_height_m", column_geometry(c).column_height},
        {"thickness_m", column_geometry(c).thickness},
        {"tank_length_m", column_geometry(c).tank_length},
        {"rough_floor", column_geometry(c).rough_floor}}},
      {"grains",
       {{"diameter_m", c.grains.diameter},
        {"diameter_spread", c.grains.diameter_spread},
        {"density_kg_m3", c.grains.density},
        {"youngs_modulus_pa", c.grains.youngs_modulus},
        {"poissons_ratio", c.grains.poissons_ratio}}},
      {"contact",
       {{"restitution", c.contact.restitution},
        {"friction", c.contact.friction},
        {"rolling_friction", c.contact.rolling_friction},
        {"wall_friction", c.contact.wall_friction}}},
      {"protocol",
       {{"gravity_m_s2", c.protocol.gravity},
        {"volume_fraction", c.protocol.volume_fraction},
        {"settle_time_s", c.protocol.settle_time},
        {"run_time_s", c.protocol.run_time},
        {"snapshot_interval_s", c.protocol.snapshot_interval},
        {"time_step_s", c.protocol.time_step},
        {"rest_energy", c.protocol.rest_energy}}},
      {"ruler", {{"profile_bin_m", c.ruler.profile_bin}, {"front_depth_m", c.ruler.front_depth}}},
      {"continuum",
       {{"cells_per_column_length", resolution.cells_per_column_length},
        {"particles_per_cell_axis", resolution.particles_per_cell_axis},
        {"lattice_jitter", resolution.lattice_jitter}}},
  };
}

json calibration_of(const Suite& suite, const SuiteCase& entry) {
  const dem::MaterialConstants& material = entry.material;
  return {{"name", entry.column.calibration},
          {"file", suite.calibration.filename().string()},
          {"input_hash", suite.calibration_hash},
          {"friction_angle_deg", material.friction_angle * 180.0 / std::numbers::pi},
          {"max_volume_fraction", material.max_volume_fraction},
          {"status", material.status},
          {"source", material.source}};
}

std::string number(const json& value, const char* format) {
  return value.is_number() ? fmt::format(fmt::runtime(format), value.get<double>()) : std::string("-");
}

std::string mean_and_spread(const json& statistics) {
  if (!statistics.is_object()) return "-";
  return fmt::format("{} +- {}", number(statistics.at("mean"), "{:.3f}"),
                     number(statistics.at("sd"), "{:.3f}"));
}

}  // namespace

json assemble_results(const Suite& suite, const std::vector<Job>& jobs, const std::string& command_line) {
  json results{{"schema", "talus-results"}, {"schema_version", schema_version}, {"suite", suite.name},
               {"title", suite.title},      {"provenance", provenance()},       {"cases", json::array()}};
  results["provenance"]["command_line"] = command_line;
  results["provenance"]["suite_hash"] = suite.input_hash;
  for (const auto& job : jobs) results["provenance"]["programs"][job.backend_name] = job.backend.version;
  for (std::size_t c = 0; c < suite.cases.size(); ++c) {
    const dem::Case& column = suite.cases[c].column;
    json runs = json::array(), bands = json::array();
    for (const auto& job : jobs) {
      if (job.case_index == c) runs.push_back(read_record(job.folder));
    }
    for (const auto& band : column.observables) {
      bands.push_back({{"observable", band.name}, {"relative_band", band.relative_band}, {"why", band.why}});
    }
    results["cases"].push_back({{"name", column.name},
                                {"title", column.title},
                                {"file", column.file.filename().string()},
                                {"input_hash", column.input_hash},
                                {"parameters", parameters_of(column, suite.resolution)},
                                {"calibration", calibration_of(suite, suite.cases[c])},
                                {"column_length_m", column_geometry(column).column_length},
                                {"bands", bands},
                                {"runs", runs}});
  }
  judge(results);
  results["complete"] = true;
  return results;
}

void judge(json& results) {
  // Nothing to judge is no pass.
  Verdict verdict = results.at("cases").empty() ? Verdict::inconclusive : Verdict::pass;
  for (auto& one : results.at("cases")) {
    std::vector<dem::ObservableBand> bands;
    for (const auto& band : one.at("bands"))
      bands.push_back({band.at("observable"), band.at("relative_band"), band.at("why")});
    const TruthJudgement judgement = judge_truth(bands, one.at("runs"));
    one["summary"] = judgement.summary;
    one["verdict"] = verdict_text(judgement.verdict);
    verdict = worse(verdict, judgement.verdict);
  }
  results["verdict"] = verdict_text(verdict);
}

json read_results(const std::filesystem::path& folder) {
  const auto file = folder / results_name;
  json results;
  try {
    results = json::parse(read_file(file));
  } catch (const json::exception& error) {
    throw InputError(fmt::format("{}: not whole: {}; run the suite again", file.string(), error.what()));
  }
  if (!results.is_object() || results.value("schema", "") != "talus-results" ||
      results.value("schema_version", 0) != schema_version) {
    throw InputError(
        fmt::format("{}: not talus-results of schema version {}", file.string(), schema_version));
  }
  if (!results.value("complete", false))
    throw InputError(fmt::format("{}: not complete; run the suite again", file.string()));
  return results;
}

json make_pictures(const json& results, const std::filesystem::path& output) {
  json pictures = json::array();
  for (const auto& one : results.at("cases")) {
    const int layers = one.at("parameters").at("continuum").at("particles_per_cell_axis");
    std::set<std::string> drawn;  // the first seed of each backend
    for (const auto& run : one.at("runs")) {
      if (!drawn.insert(run.at("backend")).second) continue;
      json picture =
          picture_of_run(run, run_folder(output, one.at("name"), run.at("backend"), run.at("seed")), layers);
      picture["case"] = one.at("name");
      pictures.push_back(std::move(picture));
    }
  }
  return pictures;
}

std::string summary_text(const json& results) {
  std::string text;
  for (const auto& one : results.at("cases")) {
    text += fmt::format("{}\n{:<16}{:>18}{:>18}{:>18}{:>11}{:>7}  {}\n", one.at("title").get<std::string>(),
                        "over L0", "continuum", "liggghts", "yade", "deviation", "band", "verdict");
    for (const auto& row : one.at("summary")) {
      const auto percent = [](const json& v) {
        return v.is_number() ? fmt::format("{:+.1f} %", 100.0 * v.get<double>()) : "-";
      };
      text +=
          fmt::format("{:<16}{:>18}{:>18}{:>18}{:>11}{:>7}  {}\n", row.at("observable").get<std::string>(),
                      mean_and_spread(row.at("continuum")), mean_and_spread(row.at("liggghts")),
                      mean_and_spread(row.at("yade")), percent(row.at("deviation")),
                      fmt::format("{:.0f} %", 100.0 * row.at("band").get<double>()),
                      row.at("verdict").get<std::string>());
    }
  }
  return text + fmt::format("verdict: {}\n", results.at("verdict").get<std::string>());
}

}  // namespace talus::validation
