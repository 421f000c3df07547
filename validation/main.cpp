// talus-validate: runs validation suites, judges them, writes the report.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <thread>

#include "continuum/files/atomic_file.h"
#include "continuum/files/checked_table.h"
#include "continuum/files/provenance.h"
#include "validation/report/report.h"
#include "validation/results.h"

namespace {

using namespace talus;
using namespace talus::validation;

constexpr int exit_pass = 0;
constexpr int exit_failed = 1;  // a run failed, or the gate did
constexpr int exit_input = 2;
constexpr int exit_inconclusive = 3;
constexpr int exit_interrupted = 130;

std::atomic<bool> interrupted = false;
extern "C" void interrupt(int) { interrupted = true; }

struct Arguments {
  std::string suite = "smoke";
  std::filesystem::path output;
  int workers = 0;
  std::string command_line;
};

void write_report_of(const nlohmann::json& results, const std::filesystem::path& output) {
  write_report(results, make_pictures(results, output), output / report_name);
  spdlog::info("report: {}", (output / report_name).string());
}

int run(const Arguments& arguments) {
  const Suite suite = read_suite(arguments.suite);
  const auto jobs = plan_jobs(suite, arguments.output);
  make_writable_folder(arguments.output / "runs");
  // Old results must not stand while new runs replace what they were made from.
  std::filesystem::remove(arguments.output / results_name);
  std::filesystem::remove(arguments.output / report_name);
  const int workers = arguments.workers > 0
                          ? arguments.workers
                          : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  spdlog::info("{}: {} runs, {} at a time", suite.title, jobs.size(), workers);
  run_jobs(suite, jobs, workers, [] { return interrupted.load(); });
  const auto results = assemble_results(suite, jobs, arguments.command_line);
  write_file_atomically(arguments.output / results_name, results.dump(1) + "\n");
  write_report_of(results, arguments.output);
  fmt::print("{}", summary_text(results));
  return exit_pass;
}

int report(const Arguments& arguments) {
  write_report_of(read_results(arguments.output), arguments.output);
  return exit_pass;
}

int check(const Arguments& arguments) {
  auto results = read_results(arguments.output);
  judge(results);
  fmt::print("{}", summary_text(results));
  const auto verdict = results.at("verdict").get<std::string>();
  return verdict == "PASS" ? exit_pass : verdict == "FAIL" ? exit_failed : exit_inconclusive;
}

int list() {
  for (const auto& name : suite_names()) fmt::print("{:<12} {}\n", name, read_suite(name).title);
  return exit_pass;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Runs the same granular case through the continuum, LIGGGHTS and YADE, and compares them."};
  app.set_version_flag("--version", version_line("talus-validate"));
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done (check: PASS), 1 a run failed or check says FAIL, 2 bad input, 3 check says "
      "INCONCLUSIVE, "
      "130 interrupted.");
  Arguments arguments;
  arguments.command_line = fmt::format("{}", fmt::join(argv, argv + argc, " "));
  const auto add_suite = [&](CLI::App* command) {
    command->add_option("suite", arguments.suite, "name of a suite, or a suite file (.toml)")->required();
  };
  const auto add_output = [&](CLI::App* command) {
    command->add_option("-o,--output", arguments.output, "folder of the results")->required();
  };
  auto* run_command =
      app.add_subcommand("run", "Run a suite: results.json, report.html and every run in the output folder");
  add_suite(run_command);
  add_output(run_command);
  run_command->add_option("-j,--jobs", arguments.workers, "runs at a time, one core each; default: all cores")
      ->check(CLI::Range(1, 1024));
  auto* report_command = app.add_subcommand("report", "Write report.html again from the stored runs");
  add_output(report_command);
  auto* check_command =
      app.add_subcommand("check", "Judge stored results: truth gate against the discrete codes");
  add_output(check_command);
  auto* list_command = app.add_subcommand("list", "List the suites that come with Talus");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? exit_pass : exit_input;
  }
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  std::signal(SIGHUP, interrupt);
  try {
    if (*run_command) return run(arguments);
    if (*report_command) return report(arguments);
    if (*check_command) return check(arguments);
    if (*list_command) return list();
  } catch (const InputError& error) {
    fmt::print(stderr, "talus-validate: {}\n", error.what());
    return exit_input;
  } catch (const nlohmann::json::exception& error) {
    fmt::print(stderr, "talus-validate: {}: not as this program writes it: {}\n",
               (arguments.output / results_name).string(), error.what());
    return exit_input;
  } catch (const std::exception& error) {
    fmt::print(stderr, "talus-validate: {}\n", error.what());
    return interrupted ? exit_interrupted : exit_failed;
  }
  return exit_input;
}
