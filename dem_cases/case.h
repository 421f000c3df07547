// A case: geometry, grains, material, protocol and observables, independent of the code that runs it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "continuum/files/checked_table.h"
#include "dem_cases/geometry.h"

namespace talus::dem {

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
  double wall_friction;     // walls, gates, tubes and funnels; not floors
};

struct Protocol {
  double gravity;            // m/s^2
  double volume_fraction;    // the solid volume is this times the nominal bulk volume of the fill
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

/// How a case's figures are taken; a kind of case uses those that its observables need.
struct Ruler {
  double profile_bin;  // m, bin width
  double front_depth;  // m, least depth that counts as the deposit (collapses)
  double
      window_upper;  // the rate is taken while the fill falls from this share of what was released (hourglasses)
  double window_lower;  // to this one
};

struct Case {
  std::string kind;  // "column_collapse", "cylinder_collapse", "heap", "slot", "hourglass", "ledge", "impact"
  std::string name;  // of the case
  std::string point;  // which of its parameter points this is, "a_2"
  std::string title;
  Geometry geometry;
  Grains grains;
  Contact contact;
  Protocol protocol;
  Ruler ruler;
  std::vector<ObservableBand> observables;
  std::vector<std::uint64_t> seeds;
  /// Seeds of the reference ensemble by code, "liggghts" and "yade".
  std::map<std::string, std::vector<std::uint64_t>> reference_seeds;
  std::string calibration;  // name of the material in the calibration file
  std::filesystem::path file;
  std::string input_hash;  // SHA-256 of the file's text
};

/// A name from a file that will name folders and stand in decks: letters, digits, '_', '-' and '.'. Throws InputError.
std::string read_folder_name(const CheckedTable& table, std::string_view key);

/// Reads and checks a whole table [grains]. Throws InputError.
Grains read_grains(const CheckedTable& table);

/// About how many grains the fill has; the packing's own number hangs on the seed.
double expected_grains(const Case& a_case);

/// The geometry of a column collapse. Throws InputError for another kind of case.
const ColumnGeometry& column_geometry(const Case& column);
ColumnGeometry& column_geometry(Case& column);

/// Reads and checks one parameter point of a case file: the file's own keys, with those of the [[point]] of that
/// name laid over them; empty is the file's own point. Throws InputError naming file, line, key, value and what is
/// allowed, or the points that there are.
Case read_case(const std::filesystem::path& file, std::string_view point = {});

/// All parameter points of a case file, its own first. Throws InputError.
std::vector<Case> read_case_points(const std::filesystem::path& file);

}  // namespace talus::dem
