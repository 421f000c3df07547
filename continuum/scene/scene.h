// What the user wrote: a scene file, checked, in SI units and radians.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "continuum/files/memory.h"
#include "continuum/solids/body.h"
#include "continuum/solids/explosion.h"
#include "continuum/step.h"

namespace talus {

/// A shape filled with particles of one material at its packing limit, where no wall stands and no body is.
struct Filling {
  std::size_t material;
  Shape shape;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // m/s, at the start
};

/// What a scene of the source took its authors (table 5.1), to set beside what it takes here.
struct SourceFigures {
  double particles, render_points, seconds_per_frame;
};

struct Scene {
  std::filesystem::path file;
  std::string input_hash;  // SHA-256 of the file's text
  Grid grid;
  DomainSides sides;
  Eigen::Vector3d gravity;
  std::vector<Material> materials;
  std::vector<Wall> walls;
  std::vector<Body> bodies;
  std::vector<Explosion> explosions;
  std::vector<Filling> fillings;
  std::vector<Source> sources;
  Eigen::Vector3i particles_per_cell;  // along each axis: a lattice
  double jitter;                       // of the lattice, as a fraction of its spacing
  std::uint64_t seed;
  int render_points_per_particle = 0;  // of mass rho_max h^3 / per_cell; others in proportion. 0: none
  double end_time;                     // s
  double frame_interval;               // s
  StepSettings settings;
  std::optional<SourceFigures> table_5_1;
  std::string broken;  // the name of a deliberate defect (read_solver.h); empty: sound
};

/// How large a scene may be. These are what a program takes; tests ask for less.
struct SceneLimits {
  double cells = 5e7;
  double particles = 1e8;  // at the start
  double render_points = 1e9;
  double memory = memory_of_machine();  // bytes, that it is expected to need (cost.h)
};

/// Reads and checks a scene. Throws one InputError with all that is wrong with it, a line each: file, line, key, value and what is
/// allowed. Of each table only the first fault is found, and none that hangs on what is wrong elsewhere.
Scene read_scene(const std::filesystem::path& file, const SceneLimits& limits = {});

/// The state at time zero: particles on a jittered lattice in every filling, with their render points. Throws InputError
/// when a filling holds no particle or two of them overlap.
State initial_state(const Scene& scene);

}  // namespace talus
