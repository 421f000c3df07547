// Case -> scene of the continuum solver: what `talus run` is asked, as the text of a scene file.
//
// Quasi-2-D cases run in plane strain, one cell thick. Sand fills the nominal shape at its packing limit and is released at
// t = 0, so no gate is needed; a tube rises from then on. Floors of fixed grains are as rough as the sand; planes and shells have the case's wall friction, a falling
// sphere that of the grains' contacts. Its
// material constants come from the calibration: mu(I) with mu_1, mu_2, I_0 where the file has them; where it has the critical-state
// angle theta alone, mu = sin(theta), the ratio of shear stress to mean stress in plane strain (shear_cell/README.md).
#pragma once

#include <string>

#include "dem_cases/calibration.h"
#include "dem_cases/case.h"

namespace talus::validation {

/// How the continuum resolves a case: numbers, not physics.
struct ContinuumResolution {
  int cells;                    // across the case's length, which is cell_length() of it
  int particles_per_cell_axis;  // in 3-D; in plane strain as well
  double lattice_jitter;        // fraction of the particle spacing
  double courant_factor = 1.0;  // on the solver's own limits of the time step
};

/// What can be wrong with a solver, on purpose: for the mutation check (mutants.h). What stands here is right.
struct Defects {
  double friction_factor = 1.0;     // on mu_1 and mu_2
  bool walls_have_friction = true;  // floors among them
  double gravity_factor = 1.0;
  std::string solver = {};  // value of [solver] broken; empty: none
};

/// The length that ContinuumResolution::cells divides: L0, R0, the opening's width D, the ledge's length, or the falling sphere's diameter. m.
double cell_length(const dem::Case& a_case);

/// The edge of the cells, m: about cell_length / cells, so that a whole number of them fits between the walls.
double cell_size(const dem::Case& a_case, int cells);

/// Throws InputError for a case that the continuum cannot run: a column on a flat floor.
std::string continuum_scene(const dem::Case& a_case, const dem::MaterialConstants& material,
                            const ContinuumResolution& resolution, std::uint64_t seed,
                            const Defects& defects = {});

/// About what the run costs on one core, CPU s: some microseconds a particle and step.
double expected_continuum_cpu(const dem::Case& a_case, const ContinuumResolution& resolution);

/// About what memory it takes, MB.
double expected_continuum_memory(const dem::Case& a_case, const ContinuumResolution& resolution);

}  // namespace talus::validation
