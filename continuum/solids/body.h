// Rigid bodies: solids that move, by Newton's and Euler's laws, or as they are told (method.md, section 10).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <span>
#include <string>
#include <variant>

#include "continuum/solids/shape.h"

namespace talus {

/// Where a body is and how it moves.
struct Pose {
  Eigen::Vector3d position;        // of the centre of mass, m
  Eigen::Quaterniond orientation;  // turns the body's own axes into those of space
};
struct Twist {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          // of the centre of mass, m/s
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // rad/s, in space
};

/// Moves as forces have it.
struct Free {};

/// Turns about a fixed axis alone.
struct Hinge {
  Eigen::Vector3d pivot;  // m, a point of the axis
  Eigen::Vector3d axis;   // unit vector
  double torque = 0.0;    // N m about the axis, on the body, constant
};

/// Keeps the twist that it has, whatever pushes it: moves along a line and turns about its centre of mass. From `start` to
/// `end` (s); at rest before and after.
struct Prescribed {
  Twist twist;
  double start = 0.0;
  double end = std::numeric_limits<double>::infinity();
};

using BodyMotion = std::variant<Free, Hinge, Prescribed>;

struct Body {
  std::string name;
  Shape shape;              // about its centre of mass and along its own axes
  double density;           // kg/m^3
  double mass;              // kg
  Eigen::Matrix3d inertia;  // kg m^2, about the centre of mass, along its own axes
  double friction;          // mu_w against sand, or as_rough_as_sand
  double contact_friction;  // against bodies and walls
  double restitution;       // the same
  BodyMotion motion;
  Pose pose;
  Twist twist;
};

/// A body at time zero, along the axes of space and where `shape` lies, of uniform density (kg/m^3); a mesh gets its samples.
/// Friction against sand is as_rough_as_sand, contact_friction and restitution are zero, until the caller sets them. `twist` is
/// for free bodies; of a hinge its angular velocity about the axis counts, and where motion is prescribed that has it all. Throws
/// std::invalid_argument for a shape with a body_fault (mass_properties.h).
Body make_body(std::string name, const Shape& shape, double density, const BodyMotion& motion = Free{},
               const Twist& twist = {});

/// Distance from a point in space (m) to the body's surface, m, negative inside it.
double signed_distance(const Body& body, const Eigen::Vector3d& point);
/// An axis-aligned box in space that holds the body, m: the smallest one but for meshes.
Eigen::AlignedBox3d bounds(const Body& body);
/// Radius of a ball about the centre of mass that holds the body, m.
double outer_radius(const Body& body);
/// Velocity of the body's material at a point in space, m/s.
Eigen::Vector3d velocity_at(const Body& body, const Eigen::Vector3d& point);

/// The grid sees solids at the corners of its cells and would miss what is thinner than a cell. signed_distance - thickening is
/// the distance to a body that is swollen by so much (m) that it is `least_thickness` (m) thick, a mesh where it is thinnest; zero for
/// those that are anyway. Does not depend on pose: ask once.
double thickening(const Body& body, double least_thickness);

/// What an impulse and an angular impulse about the centre of mass change a body's twist by: 6 x 6, (velocity, angular
/// velocity) per (impulse, angular impulse). A hinge leaves one degree of freedom; 0 where the motion is prescribed.
Eigen::Matrix<double, 6, 6> inverse_mass(const Body& body);

/// Moves the body from `time` to `time` + dt with the twist that it has, without forces (also without a hinge's torque): free
/// ones keep their angular momentum in the turn, so their angular velocity changes; hinged ones turn about the pivot;
/// those of prescribed motion move between its start and end, and then have the twist of `time` + dt.
void integrate(Body& body, double time, double dt);

/// Moves the body by so much (m, rad) without giving it velocity; a hinge turns by what of it is about its axis. Prescribed motion
/// has no such freedom: nothing happens.
void displace(Body& body, const Twist& by);

/// When the next prescribed motion starts or ends after `time`, s; infinite when none does.
double next_motion_change(std::span<const Body> bodies, double time);

}  // namespace talus
