#include "validation/commands.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "continuum/files/atomic_file.h"
#include "continuum/files/folder_lock.h"
#include "continuum/files/input_error.h"
#include "continuum/files/memory.h"
#include "validation/deposits.h"
#include "validation/mutation.h"
#include "validation/report/other_formats.h"
#include "validation/report/report.h"
#include "validation/suites/warnings.h"
#include "validation/summary.h"

namespace talus::validation {
namespace {

using nlohmann::json;

constexpr int exit_pass = 0;
constexpr int exit_failed = 1;
constexpr int exit_inconclusive = 3;

int exit_code_of(Verdict verdict) {
  if (verdict == Verdict::pass) return exit_pass;
  return verdict == Verdict::fail ? exit_failed : exit_inconclusive;
}

void write_json(const std::filesystem::path& file, const json& content) {
  if (!file.empty()) write_file_atomically(file, content.dump(1) + "\n");
}

Suite wanted_suite(const Arguments& arguments) { return tagged(read_suite(arguments.suite), arguments.tag); }

void warn_of_dangers(const Suite& suite, const std::vector<SuiteRun>& runs) {
  for (const std::string& warning : suite_warnings(suite, runs, memory_available())) spdlog::warn(warning);
}

/// Old results must not stand while new runs replace what they were made from.
void clear_results(const std::filesystem::path& output) {
  for (const char* old : {results_name, report_name, "report.pdf", "report.xml", "report.md"})
    std::filesystem::remove(output / old);
}

json store_results(const Suite& suite, const std::vector<SuiteRun>& runs, const Arguments& arguments) {
  json results = assemble_results(suite, runs, arguments.command_line);
  judge(results, arguments.baseline);
  write_file_atomically(arguments.output / results_name, results.dump(1) + "\n");
  return results;
}

void write_page(const json& results, const Arguments& arguments) {
  const auto file = arguments.output / report_name;
  write_report(results, pictures_of(results, arguments.output, arguments.reference_runs), file);
  spdlog::info("report: {}", file.string());
}

/// Results as they stand in the folder, judged again: what is written of verdicts does not count.
json judged_results(const std::filesystem::path& folder, const Arguments& arguments) {
  json results = read_results(folder);
  judge(results, arguments.baseline);
  const std::string stale = why_stale(results);
  results["stale"] = stale;
  if (!stale.empty()) {
    spdlog::warn("stale: {}; run the suite again", stale);
    for (json* verdict : {&results["verdict"], &results["drift"]["verdict"]})
      *verdict = verdict_text(worse(verdict_of(*verdict), Verdict::inconclusive));
  }
  return results;
}

void list_suites(const Arguments& arguments) {
  json suites = json::array();
  for (const auto& name : suite_names()) {
    const Suite suite = read_suite(name);
    fmt::print("{:<12} {}\n", name, suite.title);
    suites.push_back({{"name", name}, {"title", suite.title}, {"file", suite.file.string()}});
  }
  write_json(arguments.json, {{"suites", suites}});
}

}  // namespace

int list(const Arguments& arguments) {
  if (arguments.suite.empty()) {
    list_suites(arguments);
    return exit_pass;
  }
  const Suite suite = wanted_suite(arguments);
  json rows = json::array();
  double cost = 0.0;
  const auto runs = plan_runs(suite, arguments.output);
  warn_of_dangers(suite, runs);
  for (const auto& run : runs) {
    const std::string state = state_of(run);
    if (state != "stored") cost += run.run.expected_cpu;
    rows.push_back({{"name", run.name()},
                    {"folder", run.folder.lexically_relative(arguments.output).string()},
                    {"expected_cpu_s", run.run.expected_cpu},
                    {"memory_mb", run.memory},
                    {"state", state}});
    fmt::print("{:<60} {:>7.0f} CPU-s {:>6.0f} MB  {}\n", run.name(), run.run.expected_cpu, run.memory,
               state);
  }
  fmt::print("to be made: about {:.0f} CPU-s\n", cost);
  write_json(arguments.json, {{"suite", suite.name}, {"file", suite.file.string()}, {"runs", rows}});
  return exit_pass;
}

int run(const Arguments& arguments) {
  const Suite suite = wanted_suite(arguments);
  const auto all = plan_runs(suite, arguments.output);
  const auto runs = selected(all, arguments.only);
  make_writable_folder(arguments.output / "runs");
  const bool whole = arguments.only.empty();
  // Programs that make single runs may share the folder; one that makes results may not.
  const FolderLock lock(arguments.output / "runs", whole ? Sharing::alone : Sharing::shared);
  if (whole) clear_results(arguments.output);
  spdlog::info("{}", suite.title);
  warn_of_dangers(suite, runs);
  const int made =
      make_runs(runs, {.workers = arguments.workers, .force = arguments.force, .stop = arguments.stop});
  if (!whole) {
    write_json(arguments.json, {{"suite", suite.name}, {"made", made}});
    return exit_pass;
  }
  const json results = store_results(suite, all, arguments);
  if (!arguments.no_report) write_page(results, arguments);
  fmt::print("{}", summary_text(results));
  write_json(arguments.json, {{"suite", suite.name},
                              {"made", made},
                              {"truth", results.at("verdict")},
                              {"drift", results.at("drift").at("verdict")}});
  return exit_pass;
}

int check(const Arguments& arguments) {
  const json results = judged_results(arguments.output, arguments);
  fmt::print("{}", summary_text(results));
  const Verdict truth = verdict_of(results.at("verdict")),
                drift = verdict_of(results.at("drift").at("verdict"));
  if (arguments.annotate) fmt::print("{}", annotations(results));
  write_json(arguments.json, {{"suite", results.at("suite")},
                              {"truth", verdict_text(truth)},
                              {"drift", verdict_text(drift)},
                              {"stale", results.at("stale")}});
  if (arguments.gate == "truth") return exit_code_of(truth);
  if (arguments.gate == "drift") return exit_code_of(drift);
  return exit_code_of(worse(truth, drift));
}

int report(const Arguments& arguments) {
  const json results = judged_results(arguments.output, arguments);
  const auto& output = arguments.output;
  write_page(results, arguments);
  json files{(output / report_name).string()};
  const auto also = [&](bool wanted, const char* name, const auto& write) {
    if (!wanted) return;
    write(output / name);
    spdlog::info("report: {}", (output / name).string());
    files.push_back((output / name).string());
  };
  also(arguments.pdf, "report.pdf", [&](const auto& file) { write_pdf(output / report_name, file); });
  also(arguments.junit, "report.xml", [&](const auto& file) { write_junit(results, file); });
  also(arguments.markdown, "report.md",
       [&](const auto& file) { write_file_atomically(file, markdown_summary(results)); });
  write_json(arguments.json, {{"files", files}});
  return exit_pass;
}

int compare(const Arguments& arguments) {
  const json comparison =
      comparison_of(judged_results(arguments.output, arguments), judged_results(arguments.other, arguments));
  fmt::print("{}", comparison_text(comparison));
  write_json(arguments.json, comparison);
  return exit_pass;
}

int accept_baseline(const Arguments& arguments) {
  const json results = read_results(arguments.output);
  if (const std::string stale = why_stale(results); !stale.empty())
    throw InputError(fmt::format("{}; run the suite again before accepting", stale));
  const json entry = accept(results, arguments.reason, arguments.baseline);
  for (const auto& change : entry.at("changes")) {
    fmt::print("{} {}: {} -> {}\n", change.at("name").get<std::string>(),
               change.at("observable").get<std::string>(), change.at("old").dump(), change.at("new").dump());
  }
  fmt::print("accepted: {} values moved\n", entry.at("changes").size());
  write_json(arguments.json, entry);
  return exit_pass;
}

int mutate(const Arguments& arguments) {
  const Suite suite = read_suite(arguments.suite);
  const auto runs = plan_runs(suite, arguments.output);
  make_writable_folder(arguments.output / "runs");
  const FolderLock lock(arguments.output / "runs", Sharing::alone);
  clear_results(arguments.output);
  warn_of_dangers(suite, runs);
  const MakingOptions options{.workers = arguments.workers, .stop = arguments.stop};
  make_runs(runs, options);
  json results = store_results(suite, runs, arguments);
  results["mutants"] = try_mutants(suite, results, arguments.output, options);
  write_file_atomically(arguments.output / results_name, results.dump(1) + "\n");
  write_page(results, arguments);
  fmt::print("{}\n{}", summary_text(results), mutants_text(results["mutants"]));
  write_json(arguments.json, results["mutants"]);
  const auto survives = [](const json& mutant) { return !mutant.at("killed").get<bool>(); };
  return std::ranges::any_of(results["mutants"], survives) ? exit_failed : exit_pass;
}

}  // namespace talus::validation
