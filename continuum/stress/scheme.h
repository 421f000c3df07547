// The two schemes behind one set of functions. What kind of stress a simulation carries says which one it runs.
#pragma once

#include <variant>

#include "continuum/stress/paper_scheme.h"
#include "continuum/stress/staggered_projections.h"

namespace talus {

enum class Scheme { consistent, paper };

using SchemeStress = std::variant<Stress, PaperStress>;

SchemeStress zero_stress(Scheme scheme, const ActiveRegion& region);
/// The stress of the last step as warm start; the schemes cannot start from each other's, and then start from zero.
SchemeStress carry_over(Scheme scheme, const ActiveRegion& from, const SchemeStress& stress,
                        const ActiveRegion& to, double dt_ratio);
/// Impulse p dt h^2 per cell (cells + 1), N s.
const Field& pressure_of(const SchemeStress& stress);

/// The same of friction.
StressField friction_of(const SchemeStress& stress, const ActiveRegion& region);

/// From v* to v~ on all faces and from the bodies' free speeds to those with the sand's impulses, in place, by the scheme of
/// `stress`. `cold` and `solver` are the consistent scheme's.
ProjectionReport project(const ActiveRegion& region, const GridState& state, double dt,
                         const Eigen::Vector3d& gravity, double velocity_scale, bool cold,
                         const ProjectionSettings& settings, FrictionSolver& solver,
                         const BodyCoupling& bodies, SchemeStress& stress, Field& velocity, Field& speeds);

}  // namespace talus
