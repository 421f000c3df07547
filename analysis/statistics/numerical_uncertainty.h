// What a solver's own discretisation leaves uncertain of an observable f, from its standard runs with n lattice seeds, one run
// with cells r times as large, and one with time steps 1/r of the standard ones.
//
//   seeds       u_seeds = s / sqrt n, the standard error of their mean; s is the deviation of one run
//   grid        Assumed: the error is of first order, f_h = f + c h, or of higher order, for which it is less. Then
//               f_rh - f_h = c h (r - 1), and the error of the standard run is at most a = |f_rh - f_h| / (r - 1).
//   time step   Likewise f_dt - f_{dt/r} = c dt (1 - 1/r), so a = |f_dt - f_{dt/r}| r / (r - 1): for r = 2, twice the difference.
//   u = a / sqrt 3: the error lies anywhere in +- a with equal likelihood (GUM 4.3.7). The mean is not corrected by it: one
//               pair of runs does not show that the order is one.
//   combined    sqrt(u_seeds^2 + u_grid^2 + u_step^2) of the parts that are there
//
// Other cells bring another lattice, so the coarse run is compared with the mean over seeds; shorter steps start from the same
// lattice, and are compared with the run of that seed. Single runs scatter by the seed: differences of up to the `seed_noise`
// that stands beside them, s sqrt(1 + 1/n) and s sqrt 2, would come about without any error of the grid or step. They are taken
// at their face value, so that u is then rather too large than too small.
//
// What the runs cannot tell is absent, not zero: without a second seed there is no s.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace talus::analysis {

/// The values of one observable.
struct NumericalRuns {
  std::vector<double> standard;       // one a seed
  std::optional<double> coarse;       // with cells grid_ratio times as large
  std::optional<double> short_steps;  // with steps 1 / step_ratio as long, and the seed of standard.front()
  double grid_ratio = 2.0, step_ratio = 2.0;  // r > 1
};

/// Of the grid or the time step.
struct NumericalPart {
  double difference;                 // to the standard, with its sign
  double half_width;                 // a
  double standard;                   // u
  std::optional<double> seed_noise;  // of the difference, from s; absent when s is
};

struct NumericalUncertainty {
  double value;                          // the mean over seeds
  std::optional<double> seed_deviation;  // s; absent for one seed
  std::optional<double> seed_standard;   // u_seeds
  std::optional<NumericalPart> grid, time_step;
  std::optional<double> combined;    // of the parts that are there; absent when none is
  std::vector<std::string> missing;  // the parts that are not: "seeds", "grid", "time_step"
};

/// Throws std::invalid_argument for no standard run, a value that is not finite, or a ratio that is not above 1.
NumericalUncertainty numerical_uncertainty(const NumericalRuns& runs);

}  // namespace talus::analysis
