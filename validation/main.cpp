// talus-validate: runs validation suites, judges them, writes the report.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <thread>

#include "continuum/files/input_error.h"
#include "continuum/files/provenance.h"
#include "validation/commands.h"

namespace {

using namespace talus;
using namespace talus::validation;

constexpr int exit_failed = 1;  // a run failed, or a gate did
constexpr int exit_input = 2;
constexpr int exit_interrupted = 130;

std::atomic<bool> interrupted = false;
extern "C" void interrupt(int) { interrupted = true; }

void add_list(CLI::App& app, Arguments& a) {
  auto* command =
      app.add_subcommand("list", "List the suites, or the runs of one: cost, memory, whether they are there");
  command->add_option("suite", a.suite, "name of a suite, or a suite file (.toml)");
  command->add_option("-o,--output", a.output, "folder of the results, to see what is there");
  command->add_option("--tag", a.tag, "only points that carry this tag, and what they require");
  command->add_option("--json", a.json, "write the list here as well");
  command->callback([&] { a.command = list; });
}

void add_run(CLI::App& app, Arguments& a) {
  auto* command = app.add_subcommand(
      "run",
      "Run what is missing of a suite; then results.json, both gates, report.html in the output folder");
  command->add_option("suite", a.suite, "name of a suite, or a suite file (.toml)")->required();
  command->add_option("-o,--output", a.output, "folder of the results")->required();
  command->add_option("--only", a.only,
                      "CASE/POINT/CODE/SEED or the beginning of it: these runs alone, and no results");
  command->add_option("--tag", a.tag, "only points that carry this tag, and what they require");
  command->add_flag("--force", a.force, "make runs that are there again");
  command->add_flag("--no-report", a.no_report, "results.json only");
  command->add_option("-j,--jobs", a.workers, "runs at a time, one core each; default: all cores")
      ->check(CLI::Range(1, 1024));
  command->add_option("--json", a.json, "write what was made and both verdicts here");
  command->callback([&] { a.command = run; });
}

void add_check(CLI::App& app, Arguments& a) {
  auto* command = app.add_subcommand("check", "Judge stored results: the exit code is the verdict");
  command->add_option("-o,--output", a.output, "folder of the results")->required();
  command
      ->add_option("--gate", a.gate,
                   "truth (against the discrete codes), drift (against the accepted baseline), or both")
      ->check(CLI::IsMember({"truth", "drift", "both"}))
      ->capture_default_str();
  command->add_flag("--annotate", a.annotate, "a GitHub workflow command for each row that does not pass");
  command->add_option("--json", a.json, "write the verdicts here");
  command->callback([&] { a.command = check; });
}

void add_others(CLI::App& app, Arguments& a) {
  auto* report_command =
      app.add_subcommand("report", "Write report.html again from stored results; other formats if asked for");
  report_command->add_option("-o,--output", a.output, "folder of the results")->required();
  report_command->add_flag("--pdf", a.pdf, "report.pdf, printed by Chromium");
  report_command->add_flag("--junit", a.junit, "report.xml for test runners");
  report_command->add_flag("--markdown", a.markdown, "report.md for a pull request");
  report_command->add_option("--json", a.json, "write the names of the files here");
  report_command->callback([&] { a.command = report; });

  auto* compare_command = app.add_subcommand("compare", "Two folders of results, observable by observable");
  compare_command->add_option("a", a.output, "folder of results")->required();
  compare_command->add_option("b", a.other, "folder of results")->required();
  compare_command->add_option("--json", a.json, "write the comparison here");
  compare_command->callback([&] { a.command = compare; });

  auto* accept_command = app.add_subcommand("accept", "Make stored results the baseline of the drift gate");
  accept_command->add_option("-o,--output", a.output, "folder of the results")->required();
  accept_command->add_option("--reason", a.reason, "why; goes into the history")->required();
  accept_command->add_option("--json", a.json, "write the entry of the history here");
  accept_command->callback([&] { a.command = accept_baseline; });

  auto* mutate_command = app.add_subcommand(
      "mutate", "Run a suite and then its broken solvers: does the truth gate find each of them out?");
  mutate_command->add_option("suite", a.suite, "name of a suite, or a suite file (.toml)")->required();
  mutate_command->add_option("-o,--output", a.output, "folder of the results")->required();
  mutate_command->add_option("-j,--jobs", a.workers, "runs at a time, one core each; default: all cores")
      ->check(CLI::Range(1, 1024));
  mutate_command->add_option("--json", a.json, "write the table here");
  mutate_command->callback([&] { a.command = mutate; });
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Runs the same granular cases through the continuum, LIGGGHTS and YADE, and compares them."};
  app.set_version_flag("--version", version_text("talus-validate"));
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done (check: PASS; mutate: all found out), 1 a run failed, check says FAIL or a mutant "
      "survives, "
      "2 bad input, 3 check says INCONCLUSIVE, 130 interrupted.");
  Arguments arguments;
  app.add_option("--baseline", arguments.baseline, "folder of accepted baselines, for the drift gate")
      ->capture_default_str();
  app.add_option("--reference-runs", arguments.reference_runs,
                 "folder where talus-dem has made the reference's runs, for their pictures")
      ->capture_default_str();
  arguments.command_line = command_line_of(argc, argv);
  arguments.workers = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  arguments.stop = [] { return interrupted.load(); };
  add_list(app, arguments);
  add_run(app, arguments);
  add_check(app, arguments);
  add_others(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : exit_input;
  }
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    if (std::signal(signal, interrupt) == SIG_IGN) std::signal(signal, SIG_IGN);  // nohup
  }
  try {
    return arguments.command(arguments);
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
}
