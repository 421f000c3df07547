// The quadratic programs of a column collapse under way, made from the solver's own pieces.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "continuum/qp/problem.h"
#include "continuum/step.h"

namespace talus::testing {

/// A moment of a collapse, as the stress solves meet it. Face fields are of the open faces, without the null entry.
struct CollapseMoment {
  ActiveRegion region;
  GridState grid;
  Stress stress;       // the warm start
  Field inverse_mass;  // of faces, 1/kg
  Field velocity;      // v* of faces, m/s
  double dt;           // s
};

/// A little sand between walls, into which a free ball sinks beside a post that is turned: the problems of one step as they were
/// recorded, in the order in which they were solved to `tolerance` (in units of g dt), and the stress that the step ended with.
struct BodyStep {
  std::vector<Problem> problems;
  Stress stress;

  /// The last of that name. Throws std::out_of_range without one.
  const Problem& last(const std::string& name) const;
};
BodyStep step_with_bodies(double tolerance);

/// `cells` is the size of the column, in a domain three times as long; one cell across means plane strain.
CollapseMoment collapse_moment(const Eigen::Vector3i& cells, int steps);
/// What the next step meets, with mu = 0.5 everywhere and dt as it was. At least one step of the consistent scheme was taken,
/// and there are no solids.
CollapseMoment moment_of(const State& state);

/// What solve_pressure solves, with `velocity` on the faces. The tolerance is that of a run.
BoundQp pressure_problem(const CollapseMoment& moment, const Field& velocity);
/// What correct_packing solves, where particles are crowded at random so that fills are 0.8 to 1.6.
BoundQp packing_problem(const CollapseMoment& moment, std::mt19937_64& random);
/// One component of the shear stress, on the edges along `axis`, as the literal scheme has it (method.md, section 3):
/// two-sided bounds of mu times the mean pressure around the edge.
BoundQp shear_problem(const CollapseMoment& moment, int axis);
/// What project solves for the friction stress.
ConeQp friction_problem(const CollapseMoment& moment);

}  // namespace talus::testing
