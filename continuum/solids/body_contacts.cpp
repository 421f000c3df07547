#include "continuum/solids/body_contacts.h"

#include <fmt/format.h>
#include <ode/ode.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "continuum/numerical_faults.h"
#include "continuum/solids/body_images.h"
#include "continuum/solids/mass_properties.h"

namespace talus {
namespace {

using Eigen::Vector3d;

/// Of what overlaps, in lengths of the thinner body: so deep contacts are left, or they would come and go.
constexpr double overlap_kept = 1e-3;
/// Share of the rest by which bodies are parted at a time.
constexpr double overlap_parted = 0.2;
/// Of a body's inradius: the furthest that its surface moves between two looks at contacts.
constexpr double furthest_move = 0.05;
/// Of projected Gauss and Seidel. What the tests see does not change from 50 to 1000.
constexpr int iterations = 200;

bool prescribed(const Body& body) { return std::holds_alternative<Prescribed>(body.motion); }

/// Of moves by whole periods.
bool same_place(const Vector3d& a, const Vector3d& b) { return a.isApprox(b) || (a - b).isZero(); }

/// The moves by whole periods that bring bodies which touch over a seam side by side, as the library needs them. What moves as it is told
/// joins nothing. Throws NumericalError where others touch all the way around: no moves do that.
std::vector<Vector3d> shifts_together(std::span<const Body> bodies, std::span<const ContactPoint> contacts) {
  std::vector<Vector3d> shifts(bodies.size(), Vector3d::Zero());
  std::vector<char> placed(bodies.size(), 0);
  std::vector<std::vector<std::pair<std::size_t, Vector3d>>> neighbours(bodies.size());
  for (const ContactPoint& contact : contacts) {
    const auto first = static_cast<std::size_t>(contact.first);
    if (contact.second == no_body) continue;
    const auto second = static_cast<std::size_t>(contact.second);
    if (prescribed(bodies[first]) || prescribed(bodies[second])) continue;
    neighbours[first].emplace_back(second, contact.second_shift);
    neighbours[second].emplace_back(first, -contact.second_shift);
  }
  std::vector<std::size_t> open;
  for (std::size_t start = 0; start < bodies.size(); ++start) {
    if (!placed[start]) open.push_back(start);
    placed[start] = 1;
    while (!open.empty()) {
      const std::size_t body = open.back();
      open.pop_back();
      for (const auto& [other, shift] : neighbours[body]) {
        const Vector3d there = shifts[body] + shift;
        if (!placed[other]) {
          placed[other] = 1;
          shifts[other] = there;
          open.push_back(other);
        } else if (!same_place(shifts[other], there)) {
          throw NumericalError(fmt::format(
              "bodies '{}' and '{}' belong to a ring that touches all the way around a periodic axis: its "
              "contacts cannot be solved",
              bodies[body].name, bodies[other].name));
        }
      }
    }
  }
  return shifts;
}

struct DestroyWorld {
  void operator()(dxWorld* world) const { dWorldDestroy(world); }
};

/// The library's world for one solution, over a time of 1: forces are impulses, and velocities displacements where those are sought.
class World {
 public:
  World(std::span<const Body> bodies, std::span<const Twist> twists, std::span<const ContactPoint> contacts)
      : bodies_(bodies),
        twists_(twists),
        world_(dWorldCreate()),
        ids_(bodies.size(), nullptr),
        shifts_(shifts_together(bodies, contacts)) {
    dWorldSetGravity(world_.get(), 0.0, 0.0, 0.0);
    for (const ContactPoint& contact : contacts) {
      make_once(contact.first);
      make_once(contact.second);
    }
    dWorldSetCFM(world_.get(), 0.0);
    dWorldSetQuickStepNumIterations(world_.get(), iterations);
  }

  void add(const ContactPoint& point, dContact contact) {
    const Vector3d shift = shift_of_first(point);
    contact.geom = {};
    for (int axis = 0; axis < 3; ++axis) {
      contact.geom.pos[axis] = point.position[axis] + shift[axis];
      contact.geom.normal[axis] = point.normal[axis];
    }
    contact.geom.depth = point.depth;
    const dJointID joint = dJointCreateContact(world_.get(), nullptr, &contact);
    dJointAttach(joint, id_at(point.first, shift), id_at(point.second, shift + point.second_shift));
  }

  /// Into `twists`, for bodies that touch something.
  void solve(std::span<Twist> twists) {
    dRandSetSeed(0);  // by which the library shuffles the contacts
    if (dWorldQuickStep(world_.get(), 1.0) == 0) throw std::bad_alloc();
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (ids_[i] == nullptr) continue;
      const dReal *const v = dBodyGetLinearVel(ids_[i]), *const w = dBodyGetAngularVel(ids_[i]);
      twists[i] = allowed(bodies_[i], {{v[0], v[1], v[2]}, {w[0], w[1], w[2]}}, twists[i]);
    }
  }

 private:
  /// The first of a pair that is moved as it is told stands where the second has it.
  Vector3d shift_of_first(const ContactPoint& point) const {
    const auto first = static_cast<std::size_t>(point.first);
    if (!prescribed(bodies_[first]) || point.second == no_body) return shifts_[first];
    return shifts_[static_cast<std::size_t>(point.second)] - point.second_shift;
  }

  /// What moves as it is told may be there more than once.
  dBodyID id_at(int index, const Vector3d& shift) {
    if (index == no_body) return nullptr;
    const auto i = static_cast<std::size_t>(index);
    return same_place(shift, shifts_[i]) ? ids_[i] : make(i, shift);
  }

  void make_once(int index) {
    if (index == no_body) return;
    const auto i = static_cast<std::size_t>(index);
    if (ids_[i] == nullptr) ids_[i] = make(i, shifts_[i]);
  }

  dBodyID make(std::size_t index, const Vector3d& shift) {
    const Body& body = bodies_[index];
    const Twist& twist = twists_[index];
    const dBodyID made = dBodyCreate(world_.get());
    dMass mass;
    const Eigen::Matrix3d& inertia = body.inertia;
    dMassSetParameters(&mass, body.mass, 0.0, 0.0, 0.0, inertia(0, 0), inertia(1, 1), inertia(2, 2),
                       inertia(0, 1), inertia(0, 2), inertia(1, 2));
    dBodySetMass(made, &mass);
    const Vector3d x = body.pose.position + shift, &v = twist.velocity, &w = twist.angular_velocity;
    const Eigen::Quaterniond& q = body.pose.orientation;
    const dQuaternion turned{q.w(), q.x(), q.y(), q.z()};
    dBodySetPosition(made, x[0], x[1], x[2]);
    dBodySetQuaternion(made, turned);
    dBodySetLinearVel(made, v[0], v[1], v[2]);
    dBodySetAngularVel(made, w[0], w[1], w[2]);
    dBodySetGyroscopicMode(made, 0);  // turning freely is our own doing (integrate)
    if (prescribed(body)) dBodySetKinematic(made);
    if (const auto* const hinge = std::get_if<Hinge>(&body.motion)) {
      const dJointID joint = dJointCreateHinge(world_.get(), nullptr);
      dJointAttach(joint, made, nullptr);
      const Vector3d pivot = hinge->pivot + shift;
      dJointSetHingeAnchor(joint, pivot[0], pivot[1], pivot[2]);
      dJointSetHingeAxis(joint, hinge->axis[0], hinge->axis[1], hinge->axis[2]);
    }
    return made;
  }

  /// What the library's round-off has put into directions that the body has not got is left out.
  static Twist allowed(const Body& body, const Twist& found, const Twist& before) {
    if (prescribed(body)) return before;
    const auto* const hinge = std::get_if<Hinge>(&body.motion);
    if (!hinge) return found;
    const Vector3d turning = hinge->axis.dot(found.angular_velocity) * hinge->axis;
    return {turning.cross(body.pose.position - hinge->pivot), turning};
  }

  std::span<const Body> bodies_;
  std::span<const Twist> twists_;
  std::unique_ptr<dxWorld, DestroyWorld> world_;
  std::vector<dBodyID> ids_;
  std::vector<Vector3d> shifts_;
};

/// Of the first body's material against the second's, m/s.
Vector3d slip(std::span<const Body> bodies, std::span<const Twist> twists, const ContactPoint& point) {
  const auto velocity = [&](int index, const Vector3d& shift) -> Vector3d {
    if (index == no_body) return Vector3d::Zero();
    const auto i = static_cast<std::size_t>(index);
    const Vector3d centre = bodies[i].pose.position + shift;
    return twists[i].velocity + twists[i].angular_velocity.cross(point.position - centre);
  };
  return velocity(point.first, Vector3d::Zero()) - velocity(point.second, point.second_shift);
}

/// The lower of two bodies' coefficients; the body's own against what does not move.
double joint_coefficient(std::span<const Body> bodies, const ContactPoint& point, double Body::*coefficient) {
  const double first = bodies[static_cast<std::size_t>(point.first)].*coefficient;
  if (point.second == no_body) return first;
  return std::min(first, bodies[static_cast<std::size_t>(point.second)].*coefficient);
}

/// What a contact does to velocities. `weight_in_step`: what gravity adds to a velocity in a step, m/s.
dContact law_of(std::span<const Body> bodies, std::span<const Twist> twists, const ContactPoint& point,
                double weight_in_step) {
  dContact contact{};
  contact.surface.mode = dContactApprox1 | dContactFDir1 | dContactSoftERP;  // with an ERP of 0: no parting
  contact.surface.mu = joint_coefficient(bodies, point, &Body::contact_friction);
  const double restitution = joint_coefficient(bodies, point, &Body::restitution);
  if (restitution > 0.0) {
    contact.surface.mode |= dContactBounce;
    contact.surface.bounce = restitution;
    contact.surface.bounce_vel = 2.0 * weight_in_step / std::max(1.0 - restitution, 0.1);
  }
  const Vector3d velocity = slip(bodies, twists, point);
  const Vector3d along = velocity - velocity.dot(point.normal) * point.normal;
  const Vector3d direction =
      along.norm() > 1e-9 * velocity.norm() ? along.normalized() : point.normal.unitOrthogonal();
  for (int axis = 0; axis < 3; ++axis) contact.fdir1[axis] = direction[axis];
  return contact;
}

void solve_velocities(std::span<const Body> bodies, std::span<const ContactPoint> contacts,
                      double weight_in_step, std::span<Twist> twists) {
  if (contacts.empty()) return;
  World world(bodies, twists, contacts);
  for (const ContactPoint& point : contacts) world.add(point, law_of(bodies, twists, point, weight_in_step));
  world.solve(twists);
}

double thickness_of(std::span<const double> inradii, const ContactPoint& point) {
  const double first = inradii[static_cast<std::size_t>(point.first)];
  return point.second == no_body ? first : std::min(first, inradii[static_cast<std::size_t>(point.second)]);
}

/// Moves apart what overlaps, without friction.
void part(std::span<Body> bodies, std::span<const double> inradii, std::vector<ContactPoint> contacts) {
  bool deep = false;
  for (ContactPoint& point : contacts) {
    point.depth = std::max(0.0, point.depth - overlap_kept * thickness_of(inradii, point));
    deep = deep || point.depth > 0.0;
  }
  if (!deep) return;
  std::vector<Twist> shifts(bodies.size());
  World world(bodies, shifts, contacts);
  dContact contact{};
  contact.surface.mode = dContactSoftERP;
  contact.surface.soft_erp = overlap_parted;
  for (const ContactPoint& point : contacts) world.add(point, contact);
  world.solve(shifts);
  for (std::size_t i = 0; i < bodies.size(); ++i) displace(bodies[i], shifts[i]);
}

/// The furthest that a body's surface moves in dt, m.
double reach(const Body& body, double dt) {
  return dt * (body.twist.velocity.norm() + body.twist.angular_velocity.norm() * outer_radius(body));
}

bool may_touch_a_wall(const Body& body, const BodySurroundings& surroundings, double time, double margin) {
  const Grid& grid = surroundings.grid;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    if (grid.periodic[a]) continue;
    const double x = body.pose.position[axis];
    if (surroundings.sides[a][0].wall && x - grid.origin[axis] < margin) return true;
    if (surroundings.sides[a][1].wall && grid.upper()[axis] - x < margin) return true;
  }
  const Vector3d& centre = body.pose.position;
  const Vector3d reach = Vector3d::Constant(margin);
  const std::vector<Vector3d> shifts = shifts_into_domain(grid, {centre - reach, centre + reach});
  return std::any_of(shifts.begin(), shifts.end(), [&](const Vector3d& shift) {
    return nearest_wall(surroundings.walls, time, centre + shift).distance < margin;
  });
}

/// Into how many parts a step is cut.
int parts_of_step(std::span<const Body> bodies, std::span<const double> inradii,
                  const BodySurroundings& surroundings, double time, double dt) {
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const Body& body : bodies) {
    const Vector3d margin = Vector3d::Constant(reach(body, dt));
    const Eigen::AlignedBox3d box = bounds(body);
    boxes.emplace_back(box.min() - margin, box.max() + margin);
  }
  double parts = 1.0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double needed = reach(bodies[i], dt) / (furthest_move * inradii[i]);
    if (needed <= parts) continue;
    bool may_touch =
        may_touch_a_wall(bodies[i], surroundings, time, outer_radius(bodies[i]) + reach(bodies[i], dt));
    for (std::size_t j = 0; j < bodies.size() && !may_touch; ++j)
      may_touch = j != i && !meeting_shifts(surroundings.grid, boxes[j], boxes[i]).empty();
    if (may_touch) parts = needed;
  }
  return static_cast<int>(std::ceil(parts));
}

}  // namespace

void resolve_contacts(std::span<const Body> bodies, const BodySurroundings& surroundings, double time,
                      double dt, std::span<Twist> twists) {
  ContactFinder finder(bodies, surroundings);
  solve_velocities(bodies, finder.find(bodies, time), surroundings.gravity.norm() * dt, twists);
}

int move_with_contacts(std::span<Body> bodies, const BodySurroundings& surroundings, double time, double dt) {
  if (bodies.empty()) return 0;
  std::vector<double> inradii;
  for (const Body& body : bodies) inradii.push_back(inradius(body.shape));
  const int parts = parts_of_step(bodies, inradii, surroundings, time, dt);
  ContactFinder finder(bodies, surroundings);
  std::vector<Twist> twists(bodies.size());
  for (int i = 0; i < parts; ++i) {
    const double now = time + i * (dt / parts);
    const std::vector<ContactPoint> contacts = finder.find(bodies, now);
    std::transform(bodies.begin(), bodies.end(), twists.begin(), [](const Body& body) { return body.twist; });
    solve_velocities(bodies, contacts, surroundings.gravity.norm() * dt, twists);
    for (std::size_t b = 0; b < bodies.size(); ++b) bodies[b].twist = twists[b];
    part(bodies, inradii, contacts);
    for (Body& body : bodies) integrate(body, now, dt / parts);
  }
  return parts;
}

}  // namespace talus
