// A case: geometry, grains, material, protocol and observables, independent of the code that runs it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace talus::dem {

/// Quasi-2-D column behind a gate, in a tank that is periodic across its thickness (y). x runs from the back
/// wall, z up from the floor. All in metres.
struct Geometry {
  double column_length;  // L0
  double column_height;  // H0 = a L0, nominal: what the settled column is prepared to
  double thickness;      // W
  double tank_length;    // where the far wall stands
  bool rough_floor;      // a layer of fixed grains; otherwise a flat frictional floor
};

struct Grains {
  double diameter;         // d, m, mean
  double diameter_spread;  // uniform in d (1 +- spread)
  double density;          // rho_grain, kg/m^3
  double youngs_modulus;   // Pa
  double poissons_ratio;   // 1
};

struct Contact {
  double restitution;
  double friction;          // sliding coefficient, grain against grain and rough floor
  double rolling_friction;  // mu_r: moment <= mu_r R1 R2 / (R1 + R2) F_n; a plane counts as a grain of equal
                            // size
  double wall_friction;     // side walls and gate
};

struct Protocol {
  double gravity;            // m/s^2
  double volume_fraction;    // the column is filled with grains for this volume fraction
  double settle_time;        // s, from the loose packing to the opening of the gate
  double run_time;           // s, after the opening
  double snapshot_interval;  // s
  double time_step;          // s, of the discrete codes
  double rest_energy;        // before release kinetic energy / (m g H) must be below this
};

/// One observable that the codes are compared by, with its practical band.
struct ObservableBand {
  std::string name;
  double relative_band;  // |model - reference| / reference that still counts as agreement
  std::string why;       // where the band comes from
};

struct Case {
  std::string name;
  std::string title;
  Geometry geometry;
  Grains grains;
  Contact contact;
  Protocol protocol;
  double profile_bin;  // m, bin width of the ruler
  double front_depth;  // m, least depth that counts as the heap
  std::vector<ObservableBand> observables;
  std::vector<std::uint64_t> seeds;
  std::string calibration;  // name of the material in the calibration file
  std::filesystem::path file;
  std::string input_hash;  // SHA-256 of the file's text
};

/// Reads and checks a case file. Throws InputError naming file, line, key, value and what is allowed.
Case read_case(const std::filesystem::path& file);

}  // namespace talus::dem
