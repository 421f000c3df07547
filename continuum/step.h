// One time step, as figure 5.7 of the source has it.
#pragma once

#include <optional>
#include <vector>

#include "continuum/grid/active_region.h"
#include "continuum/numerical_faults.h"
#include "continuum/particles/collide.h"
#include "continuum/particles/move.h"
#include "continuum/particles/render_points.h"
#include "continuum/particles/reshape.h"
#include "continuum/particles/source.h"
#include "continuum/particles/transfer.h"
#include "continuum/phases.h"
#include "continuum/solids/body.h"
#include "continuum/solids/explosion.h"
#include "continuum/solids/wall.h"
#include "continuum/stress/packing.h"
#include "continuum/stress/scheme.h"

namespace talus {

/// All that a simulation is between two steps.
struct State {
  Grid grid;
  DomainSides sides;
  std::vector<Wall> walls;
  Openings openings;  // of the walls that stand now, and of bodies where they are
  std::vector<Material> materials;
  std::vector<Source> sources;
  Eigen::Vector3d gravity;  // m/s^2
  Particles particles;
  double time = 0.0;  // s

  /// What the last step left for the next one to start from.
  struct Warm {
    ActiveRegion region;
    SchemeStress stress;
    Field shear_rate;          // 1/s, per cell
    Field confining_pressure;  // Pa, per cell, the skin's too (friction.h)
    double dt;
    std::vector<Twist> sand_acceleration;  // of bodies, by the sand's forces
  };
  std::optional<Warm> warm;
  bool contact_changed = false;    // since the last step, by a gate
  FrictionSolver friction_solver;  // the step size it has found, and memory
  RenderPoints render_points;      // of the particles; none unless the scene asks for them
  std::vector<Body> bodies = {};   // by add_bodies alone
  struct Solids {
    Openings walls;                 // of walls alone; empty where there are no bodies
    std::vector<double> swellings;  // m, of bodies (find_openings)
  };
  Solids solids = {};
  std::vector<Explosion> explosions = {};
};

/// Gives the state its bodies; its openings are those of its walls until then.
void add_bodies(State& state, std::vector<Body> bodies);

/// The step that StepSettings::pic_share is of, in sqrt(h / g).
inline constexpr double pic_reference_step = 0.25;

struct StepSettings {
  Scheme scheme = Scheme::consistent;
  ProjectionSettings projection;
  double packing_tolerance = 0.005;  // fill above 1 that the density correction leaves alone
  double courant = 0.4;  // cells a particle is expected to move in a step, by the grid's velocity before
  double gravity_courant = 0.25;  // dt <= this * sqrt(h / g)                         (method.md, section 8)
  Transfer transfer = Transfer::flip;
  double pic_share = 0.02;  // with FLIP: of a step of 0.25 sqrt(h / g); scales with dt
  bool reshape = true;      // split and merge particles
  ReshapeRules reshape_rules;
};

/// The most a particle may move along an axis in a step, in cells.
inline constexpr double largest_allowed_move = 0.5;

/// A step whose solves end at their iteration cap, off by more than gravity gives in the step and 1/100 of the fastest
/// particle's speed, has stagnated: it is taken once more with half the time, at most so many times.
inline constexpr int most_stagnations = 4;

/// What a step did, for budgets.
struct StepReport {
  double dt = 0.0;
  ProjectionReport projection;
  PackingResult packing;
  CollisionReport collisions;
  DeformReport deform;
  ReshapeReport reshape;
  HandOverReport render_points;
  std::vector<BodyImpulse> on_bodies;  // by the sand, N s and N m s
  Eigen::Vector3d solids_impulse =
      Eigen::Vector3d::Zero();      // of walls and bodies on the sand, by stress, N s
  double largest_move = 0.0;        // in cells
  int retries = 0;                  // with half the time step, since a particle would have moved too far
  int stagnations = 0;              // and since the solves had stagnated
  Eigen::Index particles_left = 0;  // left the domain through an open side
  double mass_left = 0.0;           // kg
  double mass_added = 0.0;          // kg, by sources
  PhaseSeconds seconds;             // by the clock on the wall

  int cap_hits() const { return projection.cap_hits + (packing.solve.converged ? 0 : 1); }
};

/// Advances by one time step of at most `dt_limit` seconds; gates open, explosions go off, and sources send their next layer,
/// at the end of a step. Render points follow, and change nothing else. Throws NumericalError when the state is not sound
/// (numerical_faults.h), and nothing has changed then; and when a velocity is not finite or the solves stagnate: the state may then be looked
/// at, but is not one to step on from: particles are where the density correction put them, and of warm->region only what take_tables
/// leaves is there. Throws std::invalid_argument, before anything has changed, when the
/// render points are not those of the particles.
StepReport step(State& state, const StepSettings& settings, double dt_limit);

}  // namespace talus
