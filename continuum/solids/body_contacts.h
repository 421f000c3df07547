// Rigid bodies that touch: impulses that keep them apart, rub and make them bounce, by ODE, the Open Dynamics Engine.
//
// Coulomb's law with min(mu_a, mu_b) of two bodies' contact_friction, and the body's own against walls and sides; Newton's
// law of restitution e with the coefficients joined in the same way, for approaches faster than 2 g dt / max(1 - e, 0.1):
// slower ones are rest, or a ball that bounces with what gravity adds between two looks would never stop.
//
// ODE's QuickStep solves the problem by projected Gauss and Seidel, friction bounded along the slip and across it apart by
// the normal impulse. (Its direct solver, by Dantzig's pivoting, gives up where boxes and meshes touch in many points, and
// leaves contacts out.) A world of ODE's is made anew in every call: nothing of it needs to be kept, and the same input gives the same
// output bit for bit.
#pragma once

#include <span>

#include "continuum/solids/contact_points.h"

namespace talus {

/// `twists`, one for each body, have every other impulse of the step on entry, and those of contacts on return. Bodies stay where
/// they are; a body that touches nothing keeps its twist to the last bit. The momentum of free bodies that touch each other is
/// kept to round-off. `dt`: the step (s), for the least speed that bounces.
void resolve_contacts(std::span<const Body> bodies, const BodySurroundings& surroundings, double time,
                      double dt, std::span<Twist> twists);

/// Moves bodies from `time` to `time` + dt by their twists, as `integrate` does, and resolves their contacts on the way: in so
/// many parts that nothing which may touch something moves further in one than 1/20 of its inradius. What overlaps is moved
/// apart, a fifth of the depth in each part, without being given velocity for it. Returns how many parts there were.
int move_with_contacts(std::span<Body> bodies, const BodySurroundings& surroundings, double time, double dt);

}  // namespace talus
