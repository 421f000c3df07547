#include "continuum/solids/body_contacts.h"

#include <ode/ode.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <vector>

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

struct DestroyWorld {
  void operator()(dxWorld* world) const { dWorldDestroy(world); }
};

/// The library's world for one solution, over a time of 1: forces are impulses, and velocities displacements where those are sought.
class World {
 public:
  World(std::span<const Body> bodies, std::span<const Twist> twists, std::span<const ContactPoint> contacts)
      : world_(dWorldCreate()), ids_(bodies.size(), nullptr) {
    dWorldSetGravity(world_.get(), 0.0, 0.0, 0.0);
    const auto add = [&](int index) {
      if (index == no_body || ids_[static_cast<std::size_t>(index)] != nullptr) return;
      const auto i = static_cast<std::size_t>(index);
      ids_[i] = make(bodies[i], twists[i]);
    };
    for (const ContactPoint& contact : contacts) {
      add(contact.first);
      add(contact.second);
    }
    dWorldSetCFM(world_.get(), 0.0);
    dWorldSetQuickStepNumIterations(world_.get(), iterations);
  }

  void add(const ContactPoint& point, dContact contact) {
    contact.geom = {};
    for (int axis = 0; axis < 3; ++axis) {
      contact.geom.pos[axis] = point.position[axis];
      contact.geom.normal[axis] = point.normal[axis];
    }
    contact.geom.depth = point.depth;
    const dJointID joint = dJointCreateContact(world_.get(), nullptr, &contact);
    dJointAttach(joint, id(point.first), id(point.second));
  }

  /// Into `twists`, for bodies that touch something.
  void solve(std::span<const Body> bodies, std::span<Twist> twists) {
    dRandSetSeed(0);  // by which the library shuffles the contacts
    if (dWorldQuickStep(world_.get(), 1.0) == 0) throw std::bad_alloc();
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (ids_[i] == nullptr) continue;
      const dReal *const v = dBodyGetLinearVel(ids_[i]), *const w = dBodyGetAngularVel(ids_[i]);
      twists[i] = allowed(bodies[i], {{v[0], v[1], v[2]}, {w[0], w[1], w[2]}}, twists[i]);
    }
  }

 private:
  dBodyID id(int body) const { return body == no_body ? nullptr : ids_[static_cast<std::size_t>(body)]; }

  dBodyID make(const Body& body, const Twist& twist) {
    const dBodyID made = dBodyCreate(world_.get());
    dMass mass;
    const Eigen::Matrix3d& inertia = body.inertia;
    dMassSetParameters(&mass, body.mass, 0.0, 0.0, 0.0, inertia(0, 0), inertia(1, 1), inertia(2, 2),
                       inertia(0, 1), inertia(0, 2), inertia(1, 2));
    dBodySetMass(made, &mass);
    const Vector3d &x = body.pose.position, &v = twist.velocity, &w = twist.angular_velocity;
    const Eigen::Quaterniond& q = body.pose.orientation;
    const dQuaternion turned{q.w(), q.x(), q.y(), q.z()};
    dBodySetPosition(made, x[0], x[1], x[2]);
    dBodySetQuaternion(made, turned);
    dBodySetLinearVel(made, v[0], v[1], v[2]);
    dBodySetAngularVel(made, w[0], w[1], w[2]);
    dBodySetGyroscopicMode(made, 0);  // turning freely is our own doing (integrate)
    if (std::holds_alternative<Prescribed>(body.motion)) dBodySetKinematic(made);
    if (const auto* const hinge = std::get_if<Hinge>(&body.motion)) {
      const dJointID joint = dJointCreateHinge(world_.get(), nullptr);
      dJointAttach(joint, made, nullptr);
      dJointSetHingeAnchor(joint, hinge->pivot[0], hinge->pivot[1], hinge->pivot[2]);
      dJointSetHingeAxis(joint, hinge->axis[0], hinge->axis[1], hinge->axis[2]);
    }
    return made;
  }

  /// What the library's round-off has put into directions that the body has not got is left out.
  static Twist allowed(const Body& body, const Twist& found, const Twist& before) {
    if (std::holds_alternative<Prescribed>(body.motion)) return before;
    const auto* const hinge = std::get_if<Hinge>(&body.motion);
    if (!hinge) return found;
    const Vector3d turning = hinge->axis.dot(found.angular_velocity) * hinge->axis;
    return {turning.cross(body.pose.position - hinge->pivot), turning};
  }

  std::unique_ptr<dxWorld, DestroyWorld> world_;
  std::vector<dBodyID> ids_;
};

/// Of the first body's material against the second's, m/s.
Vector3d slip(std::span<const Body> bodies, std::span<const Twist> twists, const ContactPoint& point) {
  const auto velocity = [&](int index) -> Vector3d {
    if (index == no_body) return Vector3d::Zero();
    const auto i = static_cast<std::size_t>(index);
    return twists[i].velocity + twists[i].angular_velocity.cross(point.position - bodies[i].pose.position);
  };
  return velocity(point.first) - velocity(point.second);
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
  world.solve(bodies, twists);
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
  world.solve(bodies, shifts);
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
  return nearest_wall(surroundings.walls, time, body.pose.position).distance < margin;
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
      may_touch = j != i && boxes[i].intersects(boxes[j]);
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
