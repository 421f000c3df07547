#include "validation/mutants.h"

#include <algorithm>

namespace talus::validation {

const std::vector<Mutant>& all_mutants() {
  static const std::vector<Mutant> mutants{
      {"no_friction", "no friction between grains", {.friction_factor = 0.0}},
      {"friction_less_20_percent", "friction 20 % too small", {.friction_factor = 0.8}},
      {"friction_more_20_percent", "friction 20 % too large", {.friction_factor = 1.2}},
      {"no_wall_friction", "walls and floors without friction", {.walls_have_friction = false}},
      {"pressure_pulls", "pressure allowed to pull", {.solver = "pressure_pulls"}},
      {"no_density_correction", "no density correction", {.solver = "no_density_correction"}},
      {"gravity_less_5_percent", "gravity 5 % too small", {.gravity_factor = 0.95}},
  };
  return mutants;
}

const Mutant* find_mutant(const std::string& name) {
  const auto& mutants = all_mutants();
  const auto found = std::ranges::find(mutants, name, &Mutant::name);
  return found == mutants.end() ? nullptr : &*found;
}

std::vector<std::string> mutant_names() {
  std::vector<std::string> names;
  for (const auto& mutant : all_mutants()) names.push_back(mutant.name);
  return names;
}

}  // namespace talus::validation
