// A suite: which points of which cases run on which codes with which seeds, and how the continuum resolves them.
//
//   schema = 2
//   name, title
//   calibration = FILE                   the only source of material constants
//   mutants = ["no_friction", ...]       optional: what `talus-validate mutate` tries (mutants.h)
//   [continuum]
//   particles_per_cell_axis, lattice_jitter
//   seeds = [1, 2]                       of the particle lattice
//   refinement = true                    also run with cells twice as large and with half the time step, first seed only
//   [[case]]
//   file = FILE                          paths are relative to the suite file
//   points = ["a_1", ...]                optional: all
//   cells = 20                           across the case's length (continuum_scene.h)
//   codes = ["continuum", ...]           optional: all three
//   liggghts_seeds, yade_seeds           optional: those of the case's reference ensemble
//   stored = true                        take the discrete codes' runs from the committed ensemble where it holds them
//   tags = ["quick", ...]                optional
//   requires = ["CASE/POINT", ...]       optional: points without which these cannot be judged; selecting one selects them
//   time_limit_s                         of one run, wall clock
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "dem_cases/calibration.h"
#include "dem_cases/case.h"
#include "validation/backends/continuum_scene.h"

namespace talus::validation {

/// One parameter point of a case, as the suite runs it.
struct SuitePoint {
  dem::Case a_case;
  dem::MaterialConstants material;  // the continuum's, from the calibration
  ContinuumResolution resolution;
  bool refinement;
  std::map<std::string, std::vector<std::uint64_t>> seeds;  // by code, "continuum", "liggghts", "yade"
  bool stored;
  std::set<std::string> tags;
  std::vector<std::string> required;  // names of points
  double time_limit;                  // s, wall clock, of one run

  std::string name() const { return a_case.name + "/" + a_case.point; }
};

struct Suite {
  std::string name;
  std::string title;
  std::filesystem::path file;
  std::string input_hash;  // SHA-256 of the file's text
  std::filesystem::path calibration;
  std::string calibration_hash;  // likewise
  std::vector<std::string> mutants;
  std::string tag;  // by which its points were selected; empty: the whole suite
  std::vector<SuitePoint> points;
};

/// `name_or_file`: the name of a suite in validation/suites, or the path of a suite file. Reads and checks the suite and all its
/// cases. Throws InputError with all that is wrong, a line each.
Suite read_suite(const std::string& name_or_file);

/// Names of the suites that come with Talus.
std::vector<std::string> suite_names();

/// The suite with the points that carry `tag` alone, and those that they require; all for an empty tag. Throws InputError when no
/// point carries it.
Suite tagged(Suite suite, const std::string& tag);

}  // namespace talus::validation
