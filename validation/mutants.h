// Deliberately broken solvers. A gate that none of them turns red is no gate: `talus-validate mutate` runs a suite with each of them
// and says which the truth gate has found out.
#pragma once

#include <string>
#include <vector>

#include "validation/backends/continuum_scene.h"

namespace talus::validation {

struct Mutant {
  std::string name;
  std::string title;  // for people
  Defects defects;
};

/// All of them.
const std::vector<Mutant>& all_mutants();
/// Null when there is none of that name.
const Mutant* find_mutant(const std::string& name);
std::vector<std::string> mutant_names();

}  // namespace talus::validation
