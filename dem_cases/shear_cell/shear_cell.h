// The shear cell: two homogeneous tests of the grains on their own, which alone say what constants the continuum's
// material has.
//
//   simple shear   mu = tau / sigma_n           at constant normal stress sigma_n, over a range of
//                  I  = |shear rate| d sqrt(rho_grain / sigma_n)
//   biaxial        sin(theta) = (s1 - s3) / (s1 + s3)   in plane strain, at the critical state
// (GDR MiDi, Eur. Phys. J. E 14, 341 (2004); Jop, Forterre & Pouliquen, Nature 441, 727 (2006).)
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "dem_cases/case.h"
#include "dem_cases/planned_run.h"

namespace talus::dem {

struct ShearMaterial {
  std::string name;  // in the calibration file
  double rolling_friction;
};

struct ShearProtocol {
  double time_step;           // s, of the discrete codes
  double compression_time;    // s, from the loose packing to the start of the shear
  double closing_speed;       // m/s, of the piston while the packing does not resist yet
  double stress_tolerance;    // |mean stress / wanted - 1|
  double inertial_tolerance;  // |mean inertial number / wanted - 1|
  double least_strain;        // shear strain over which the averages are taken, at least
  int steps_per_sample;       // and between two settings of the servo
};

struct SimpleShearPoint {
  double inertial_number;
  double transient_strain;  // of shear, not averaged over
  double strain;            // of shear, after the transient
};

/// Between two rough walls, periodic along the flow (x) and the vorticity (y).
struct SimpleShear {
  double normal_stress;     // Pa
  Eigen::Vector3i lattice;  // grains of the loose start along x, y, z
  std::vector<SimpleShearPoint> points;
  std::vector<std::uint64_t> liggghts_seeds;
};

struct BiaxialPoint {
  double inertial_number;  // of the lateral stress and the shear rate, twice the axial rate
  double axial_strain;     // logarithmic, in total
  double averaged_from;    // axial strain
};

/// Periodic on all sides: z shortens at a constant rate, y keeps its length, x keeps its stress.
struct Biaxial {
  double lateral_stress;             // Pa
  double servo_gain;                 // 1/s, lateral strain rate per relative error of the stress
  double closing_rate;               // 1/s, of each axis while the packing does not resist yet
  Eigen::Vector3i lattice;           // grains of the loose start along x, y, z
  std::vector<BiaxialPoint> points;  // the slowest first
  std::vector<std::uint64_t> liggghts_seeds, yade_seeds;  // YADE runs the slowest point only
};

struct ShearCell {
  std::string name, title;
  Grains grains;
  double restitution, friction;
  std::vector<ShearMaterial> materials;
  ShearProtocol protocol;
  SimpleShear simple_shear;
  Biaxial biaxial;
  std::filesystem::path file;
};

/// Reads and checks a case file of this kind. Throws InputError naming file, line, key, value and what is allowed.
ShearCell read_shear_cell(const std::filesystem::path& file);

/// Names of the points, by material and inertial number: "simple_shear-rolling_friction_0-0.1".
std::string point_name(const ShearMaterial& material, const SimpleShearPoint& point);
std::string point_name(const ShearMaterial& material, const BiaxialPoint& point);

/// Every run of the case: both tests, all materials, inertial numbers, codes and seeds. Throws InputError when a code
/// that is asked for is not installed.
std::vector<PlannedRun> shear_cell_runs(const ShearCell& cell);

}  // namespace talus::dem
