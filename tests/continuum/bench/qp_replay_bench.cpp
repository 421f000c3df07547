// Times our solvers on recorded problems: qp_replay_bench [--benchmark_...] FILE_OR_FOLDER...
//
// One benchmark a problem file (folders are searched for *.h5). Counters: unknowns, iterations, residual (of the
// tolerance: at most 1 where converged).
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "continuum/files/input_error.h"
#include "continuum/qp/problem_file.h"

namespace talus {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> problem_files(const fs::path& given) {
  if (!fs::exists(given)) throw InputError(fmt::format("{}: no such file or folder", given.string()));
  if (!fs::is_directory(given)) return {given};
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(given)) {
    if (entry.is_regular_file() && entry.path().extension() == ".h5") files.push_back(entry.path());
  }
  if (files.empty()) throw InputError(fmt::format("{}: holds no .h5 files", given.string()));
  std::sort(files.begin(), files.end());
  return files;
}

Eigen::Index unknowns(const BoundQp& problem) { return problem.start.size(); }
Eigen::Index unknowns(const ConeQp& problem) { return problem.start.size(); }
double tolerance(const BoundQp& problem) { return problem.settings.tolerance; }
double tolerance(const ConeQp& problem) { return problem.settings.gap_tolerance; }
double residual(const BoundQpSolution& solution) { return solution.result.residual; }
double residual(const ConeQpSolution& solution) { return solution.result.gap; }

void replay(benchmark::State& state, const Problem& problem) {
  std::visit(
      [&](const auto& qp) {
        decltype(solve(qp)) solution;
        for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(solution = solve(qp));
        state.counters["unknowns"] = static_cast<double>(unknowns(qp));
        state.counters["iterations"] = solution.result.iterations;
        state.counters["residual"] = residual(solution) / tolerance(qp);
      },
      problem);
}

/// `given` are the files and folders of the command line.
void register_problems(const std::vector<std::string>& given) {
  if (given.empty()) throw InputError("give files of recorded problems, or folders of them");
  for (const auto& argument : given) {
    for (const auto& file : problem_files(argument)) {
      benchmark::RegisterBenchmark(file.string().c_str(), replay, read_problem(file))
          ->Unit(benchmark::kMillisecond);
    }
  }
}

}  // namespace
}  // namespace talus

int main(int argc, char** argv) try {
  benchmark::Initialize(&argc, argv);  // takes its own options out
  talus::register_problems({argv + 1, argv + argc});
  benchmark::RunSpecifiedBenchmarks();
  return 0;
} catch (const talus::InputError& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 2;
}
