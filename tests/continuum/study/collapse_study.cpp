// Column collapses in plane strain, as tables: how the observables converge with the grid, and how they compare with the
// figures of dem.md. Run by hand; minutes to an hour.
//
//   collapse_study ladder   L0/h = 10, 20, 40 for a = 0.5, 1, 2: observables and observed order
//   collapse_study dem      a = 0.5, 1, 2, 5 at L0/h = 20, both materials, constant mu and mu(I)
//   collapse_study paper    a = 0.5, 1, 2 at L0/h = 20 by the scheme of the source
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <string>

#include "analysis/observables/column_collapse.h"
#include "dem_cases/calibration.h"
#include "tests/continuum/scenes.h"

namespace {

using namespace talus;

constexpr double column_length = 0.048;  // L0 = 16 d, m
constexpr double grain_diameter = 0.003;

struct Run {
  double aspect;
  int cells;  // L0 / h
  dem::MaterialConstants material;
  bool rate_dependent = true;  // mu(I), as the harness has it; or mu_1 alone
  Scheme scheme = Scheme::consistent;
};

struct Result {
  analysis::CollapseObservables observables;
  int cap_hits = 0, steps = 0;
  double cpu = 0.0;  // s
};

analysis::Snapshot snapshot_of(const State& state) {
  return {state.time, state.particles.positions, state.particles.velocities,
          (state.particles.masses / state.materials[0].grain_density).matrix()};
}

Result collapse(const Run& run) {
  const double h = column_length / run.cells;
  const dem::FrictionLaw& law = run.material.friction_law.value();
  const int tall = static_cast<int>(std::lround(run.aspect * run.cells));
  const int tank = static_cast<int>((3.0 + 2.5 * run.aspect) * run.cells);
  Scene scene =
      testing::box_scene({tank, 1, tall + run.cells / 4}, {1.0 * run.cells, 1.0, 1.0 * tall}, h, law.mu_1);
  scene.grid.periodic[1] = true;
  scene.sides[0] = {Side{true, 0.0}, Side{true, 0.0}};
  scene.sides[2][0] = {true, as_rough_as_sand};
  scene.materials[0].max_volume_fraction = run.material.max_volume_fraction;
  if (run.rate_dependent) scene.materials[0].rate = {law.mu_2, law.I_0, grain_diameter};
  scene.jitter = 0.5;
  State state = initial_state(scene);
  StepSettings settings;
  settings.scheme = run.scheme;

  Result result;
  const auto start = std::chrono::steady_clock::now();
  const double end = 14.0 * std::sqrt(std::max(1.0, run.aspect) * column_length / testing::gravity);
  constexpr int frames = 100;
  analysis::SnapshotSeries series{snapshot_of(state)};
  for (int frame = 1; frame <= frames; ++frame) {
    testing::run_for(state, settings, frame * end / frames - state.time,
                     [&](const State&, const StepReport& r) {
                       result.cap_hits += r.cap_hits();
                       ++result.steps;
                     });
    series.push_back(snapshot_of(state));
  }
  result.cpu = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.observables =
      analysis::measure_column_collapse(series, {column_length, h, grain_diameter, 0.5 * grain_diameter})
          .observables;
  return result;
}

void print_header() {
  fmt::print(
      "| a | L0/h | material | friction | runout | x95 | final height | centre of mass | at rest | steps | "
      "cap hits | s |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n");
}

Result print_run(const Run& run, const char* material) {
  const Result result = collapse(run);
  const auto& o = result.observables;
  fmt::print("| {} | {} | {} | {} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {} | {} | {} | {:.0f} |\n",
             run.aspect, run.cells, material, run.rate_dependent ? "mu(I)" : "constant", o.runout, o.x95,
             o.final_height, o.centre_of_mass, o.at_rest ? "yes" : "no", result.steps, result.cap_hits,
             result.cpu);
  std::fflush(stdout);
  return result;
}

/// Of a quantity that was measured at h, h/2 and h/4; not a number unless it converges monotonically.
double observed_order(double coarse, double middle, double fine) {
  return std::log2((coarse - middle) / (middle - fine));
}

void ladder(const dem::MaterialConstants& material) {
  print_header();
  std::string orders =
      "| a | order of runout | of x95 | of final height | of centre of mass |\n|---|---|---|---|---|\n";
  for (const double aspect : {0.5, 1.0, 2.0}) {
    std::vector<analysis::CollapseObservables> o;
    for (const int cells : {10, 20, 40})
      o.push_back(print_run({aspect, cells, material}, "rolling 0.2").observables);
    const auto order = [&](double analysis::CollapseObservables::*of) {
      return observed_order(o[0].*of, o[1].*of, o[2].*of);
    };
    orders += fmt::format(
        "| {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", aspect, order(&analysis::CollapseObservables::runout),
        order(&analysis::CollapseObservables::x95), order(&analysis::CollapseObservables::final_height),
        order(&analysis::CollapseObservables::centre_of_mass));
  }
  fmt::print("\n{}", orders);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  const auto calibrated = [](const char* name) {
    return dem::read_calibration(TALUS_SOURCE_DIR "/dem_cases/shear_cell/calibration.toml", name);
  };
  const auto smooth = calibrated("rolling_friction_0"), rolling = calibrated("rolling_friction_0_2");
  if (what == "ladder") {
    ladder(rolling);
  } else if (what == "dem") {
    print_header();
    for (const bool rate : {false, true}) {
      for (const double aspect : {0.5, 1.0, 2.0, 5.0}) {
        print_run({aspect, 20, smooth, rate}, "rolling 0");
        print_run({aspect, 20, rolling, rate}, "rolling 0.2");
      }
    }
  } else if (what == "paper") {
    print_header();
    for (const double aspect : {0.5, 1.0, 2.0})
      print_run({aspect, 20, rolling, true, Scheme::paper}, "rolling 0.2");
  } else {
    fmt::print(stderr, "usage: collapse_study ladder | dem | paper\n");
    return 2;
  }
  return 0;
}
