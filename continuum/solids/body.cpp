#include "continuum/solids/body.h"

#include <algorithm>

#include "continuum/solids/mass_properties.h"
#include "continuum/solids/wall.h"

namespace talus {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// From the body's own axes to those of space.
struct Placement {
  Matrix3d rotation;
  Vector3d position;

  Vector3d operator*(const Vector3d& point) const { return rotation * point + position; }
};

Placement placement(const Pose& pose) { return {pose.orientation.toRotationMatrix(), pose.position}; }

Box moved(const Placement& to, const Box& box) {
  return {to * box.centre, box.half_size, to.rotation * box.rotation};
}
Sphere moved(const Placement& to, const Sphere& sphere) { return {to * sphere.centre, sphere.radius}; }
Capsule moved(const Placement& to, const Capsule& capsule) {
  return {to * capsule.from, to * capsule.to, capsule.radius};
}
Revolved moved(const Placement& to, const Revolved& solid) {
  return {to * solid.base, to.rotation * solid.axis, solid.profile};
}

template <class Geometry>
Eigen::AlignedBox3d bounds_of(const Placement& at, const Geometry& geometry) {
  return bounds(Shape{moved(at, geometry)});
}
Eigen::AlignedBox3d bounds_of(const Placement& at, const SampledMesh& mesh) {
  const Eigen::AlignedBox3d own = bounds(mesh);
  return bounds_of(at, Box{own.center(), 0.5 * own.sizes()});
}
// Neither is a body's: make_body refuses planes, and gives meshes their samples.
Eigen::AlignedBox3d bounds_of(const Placement&, const Plane& plane) { return bounds(Shape{plane}); }
Eigen::AlignedBox3d bounds_of(const Placement&, const Mesh& mesh) { return bounds(mesh); }

template <class Geometry>
decltype(Shape::geometry) recentred(const Vector3d& centre, const Geometry& geometry) {
  return moved({Matrix3d::Identity(), -centre}, geometry);
}
decltype(Shape::geometry) recentred(const Vector3d& centre, const Mesh& mesh) {
  return sample_distances(shifted(mesh, -centre));
}
decltype(Shape::geometry) recentred(const Vector3d& centre, const SampledMesh& mesh) {
  return recentred(centre, mesh.samples->mesh);
}
decltype(Shape::geometry) recentred(const Vector3d&, const Plane& plane) { return plane; }

Eigen::Quaterniond turn_by(const Vector3d& angle) {
  const double size = angle.norm();
  if (size == 0.0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(size, angle / size));
}

Matrix3d inverse_inertia(const Body& body, const Eigen::Quaterniond& orientation) {
  const Matrix3d rotation = orientation.toRotationMatrix();
  return rotation * body.inertia.inverse() * rotation.transpose();
}

Vector3d angular_momentum(const Body& body) {
  const Eigen::Quaterniond& q = body.pose.orientation;
  return q * (body.inertia * (q.conjugate() * body.twist.angular_velocity));
}

/// How far the centre of mass moves for a turn of one radian, and the turn.
Eigen::Matrix<double, 6, 1> freedom(const Hinge& hinge, const Vector3d& position) {
  Eigen::Matrix<double, 6, 1> s;
  s.head<3>() = hinge.axis.cross(position - hinge.pivot);
  s.tail<3>() = hinge.axis;
  return s;
}

Twist twist_of(const Hinge& hinge, double rate, const Vector3d& position) {
  const Eigen::Matrix<double, 6, 1> s = rate * freedom(hinge, position);
  return {s.head<3>(), s.tail<3>()};
}

Twist twist_at(const Prescribed& motion, double time) {
  return time >= motion.start && time < motion.end ? motion.twist : Twist{};
}

void turn(Body& body, const Vector3d& angle) {
  body.pose.orientation = (turn_by(angle) * body.pose.orientation).normalized();
}

/// With the angular velocity of half-way, so that a tumbling body keeps its energy to second order in dt.
void advance(const Free&, Body& body, double, double dt) {
  const Vector3d momentum = angular_momentum(body);
  body.pose.position += dt * body.twist.velocity;
  const Eigen::Quaterniond half_way = turn_by(0.5 * dt * body.twist.angular_velocity) * body.pose.orientation;
  turn(body, dt * (inverse_inertia(body, half_way) * momentum));
  body.twist.angular_velocity = inverse_inertia(body, body.pose.orientation) * momentum;
}

void turn_about(const Hinge& hinge, double angle, Body& body) {
  const double rate = hinge.axis.dot(body.twist.angular_velocity);
  turn(body, angle * hinge.axis);
  body.pose.position = hinge.pivot + turn_by(angle * hinge.axis) * (body.pose.position - hinge.pivot);
  body.twist = twist_of(hinge, rate, body.pose.position);
}

void advance(const Hinge& hinge, Body& body, double, double dt) {
  turn_about(hinge, dt * hinge.axis.dot(body.twist.angular_velocity), body);
}

void advance(const Prescribed& motion, Body& body, double time, double dt) {
  const double moving = std::max(0.0, std::min(time + dt, motion.end) - std::max(time, motion.start));
  body.pose.position += moving * motion.twist.velocity;
  turn(body, moving * motion.twist.angular_velocity);
  body.twist = twist_at(motion, time + dt);
}

Twist starting_twist(const Free&, const Body&, const Twist& given) { return given; }
Twist starting_twist(const Hinge& hinge, const Body& body, const Twist& given) {
  return twist_of(hinge, hinge.axis.dot(given.angular_velocity), body.pose.position);
}
Twist starting_twist(const Prescribed& motion, const Body&, const Twist&) { return twist_at(motion, 0.0); }

void shift(const Free&, const Twist& by, Body& body) {
  body.pose.position += by.velocity;
  turn(body, by.angular_velocity);
}
void shift(const Hinge& hinge, const Twist& by, Body& body) {
  turn_about(hinge, hinge.axis.dot(by.angular_velocity), body);
}
void shift(const Prescribed&, const Twist&, Body&) {}

using Matrix6d = Eigen::Matrix<double, 6, 6>;

Matrix6d inverse_mass_of(const Free&, const Body& body) {
  Matrix6d inverse = Matrix6d::Zero();
  inverse.topLeftCorner<3, 3>().diagonal().setConstant(1.0 / body.mass);
  inverse.bottomRightCorner<3, 3>() = inverse_inertia(body, body.pose.orientation);
  return inverse;
}

Matrix6d inverse_mass_of(const Hinge& hinge, const Body& body) {
  const Eigen::Matrix<double, 6, 1> s = freedom(hinge, body.pose.position);
  const Vector3d own_axis = body.pose.orientation.conjugate() * hinge.axis;
  const double inertia = own_axis.dot(body.inertia * own_axis) + body.mass * s.head<3>().squaredNorm();
  return s * s.transpose() / inertia;
}

Matrix6d inverse_mass_of(const Prescribed&, const Body&) { return Matrix6d::Zero(); }

}  // namespace

Body make_body(std::string name, const Shape& shape, double density, const BodyMotion& motion,
               const Twist& twist) {
  const MassProperties properties = mass_properties(shape);
  Body body{std::move(name),
            {std::visit([&](const auto& geometry) { return recentred(properties.centre, geometry); },
                        shape.geometry)},
            density,
            density * properties.volume,
            density * properties.inertia,
            as_rough_as_sand,
            0.0,
            0.0,
            motion,
            {properties.centre, Eigen::Quaterniond::Identity()},
            {}};
  body.twist = std::visit([&](const auto& moves) { return starting_twist(moves, body, twist); }, body.motion);
  return body;
}

double signed_distance(const Body& body, const Vector3d& point) {
  return signed_distance(body.shape, body.pose.orientation.conjugate() * (point - body.pose.position));
}

Eigen::AlignedBox3d bounds(const Body& body) {
  return std::visit([&](const auto& geometry) { return bounds_of(placement(body.pose), geometry); },
                    body.shape.geometry);
}

double outer_radius(const Body& body) {
  const Eigen::AlignedBox3d own = bounds(body.shape);
  return own.min().cwiseAbs().cwiseMax(own.max().cwiseAbs()).norm();
}

Vector3d velocity_at(const Body& body, const Vector3d& point) {
  return body.twist.velocity + body.twist.angular_velocity.cross(point - body.pose.position);
}

double thickening(const Body& body, double least_thickness) {
  return std::max(0.0, 0.5 * (least_thickness - thinnest(body.shape)));
}

Matrix6d inverse_mass(const Body& body) {
  return std::visit([&](const auto& motion) { return inverse_mass_of(motion, body); }, body.motion);
}

void integrate(Body& body, double time, double dt) {
  std::visit([&](const auto& motion) { advance(motion, body, time, dt); }, body.motion);
}

void displace(Body& body, const Twist& by) {
  std::visit([&](const auto& motion) { shift(motion, by, body); }, body.motion);
}

double next_motion_change(std::span<const Body> bodies, double time) {
  double next = std::numeric_limits<double>::infinity();
  for (const Body& body : bodies) {
    const auto* const motion = std::get_if<Prescribed>(&body.motion);
    if (!motion) continue;
    if (motion->start > time) next = std::min(next, motion->start);
    if (motion->end > time) next = std::min(next, motion->end);
  }
  return next;
}

}  // namespace talus
