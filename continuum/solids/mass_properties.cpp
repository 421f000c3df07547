#include "continuum/solids/mass_properties.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace talus {
namespace {

constexpr double pi = std::numbers::pi;

/// Inertia of a body that is symmetric about a unit vector.
Eigen::Matrix3d symmetric_inertia(const Eigen::Vector3d& axis, double about_axis, double across) {
  return across * Eigen::Matrix3d::Identity() + (about_axis - across) * axis * axis.transpose();
}

MassProperties properties_of(const Box& box) {
  const Eigen::Vector3d square = box.half_size.array().square();
  const double volume = 8.0 * box.half_size.prod();
  const Eigen::Vector3d own = volume / 3.0 * (square.sum() - square.array());
  return {volume, box.centre, box.rotation * own.asDiagonal() * box.rotation.transpose()};
}

MassProperties properties_of(const Sphere& sphere) {
  const double volume = 4.0 / 3.0 * pi * std::pow(sphere.radius, 3);
  return {volume, sphere.centre, 0.4 * volume * sphere.radius * sphere.radius * Eigen::Matrix3d::Identity()};
}

/// A cylinder, and two half spheres: each has its centre 3/8 r beyond its base.
MassProperties properties_of(const Capsule& capsule) {
  const Eigen::Vector3d along = capsule.to - capsule.from;
  const double r = capsule.radius, length = along.norm();
  const Eigen::Vector3d axis = length > 0.0 ? Eigen::Vector3d(along / length) : Eigen::Vector3d::UnitZ();
  const double tube = pi * r * r * length, ball = 4.0 / 3.0 * pi * r * r * r;
  const double about_axis = tube * r * r / 2.0 + ball * 0.4 * r * r;
  const double across = tube * (r * r / 4.0 + length * length / 12.0) +
                        ball * (0.4 * r * r + length * length / 4.0 + 0.375 * length * r);
  return {tube + ball, 0.5 * (capsule.from + capsule.to), symmetric_inertia(axis, about_axis, across)};
}

/// Green's theorem turns integrals over the profile into ones along its edges:
/// V = pi oint r^2 dz, V z = pi oint r^2 z dz, int z^2 = pi oint r^2 z^2 dz, int r^2 = pi/2 oint r^4 dz. Three points of
/// Gauss and Legendre are exact for these.
MassProperties properties_of(const Revolved& solid) {
  constexpr std::array<double, 3> weights{5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  const double offset = std::sqrt(0.15);
  const std::array<double, 3> places{0.5 - offset, 0.5, 0.5 + offset};
  Eigen::Vector4d integral = Eigen::Vector4d::Zero();  // of 1, z, z^2, r^2
  const double middle = 0.5 * (solid.profile.front()[1] + solid.profile[solid.profile.size() / 2][1]);
  for (std::size_t i = 0; i < solid.profile.size(); ++i) {
    const Eigen::Vector2d from = solid.profile[i],
                          along = solid.profile[(i + 1) % solid.profile.size()] - from;
    for (std::size_t g = 0; g < 3; ++g) {
      const Eigen::Vector2d at = from + places[g] * along;
      const double r2 = at[0] * at[0], z = at[1] - middle;
      integral += weights[g] * along[1] * pi * r2 * Eigen::Vector4d(1.0, z, z * z, 0.5 * r2);
    }
  }
  if (integral[0] < 0.0) integral = -integral;  // the profile turned the other way
  const double z = integral[1] / integral[0];
  const double across = integral[2] + 0.5 * integral[3] - integral[0] * z * z;
  return {integral[0], solid.base + (middle + z) * solid.axis,
          symmetric_inertia(solid.axis, integral[3], across)};
}

/// Tetrahedra between a point and each triangle, with signs.
MassProperties properties_of(const Mesh& mesh) {
  const Eigen::Vector3d middle = bounds(mesh).center();
  double volume = 0.0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  // int x x'
  for (const Triangle& triangle : triangles_of(mesh)) {
    Eigen::Matrix3d corners;
    for (int i = 0; i < 3; ++i) corners.col(i) = triangle[static_cast<std::size_t>(i)] - middle;
    const double determinant = corners.determinant();
    const Eigen::Vector3d sum = corners.rowwise().sum();
    volume += determinant / 6.0;
    first += determinant / 24.0 * sum;
    second += determinant / 120.0 * (corners * corners.transpose() + sum * sum.transpose());
  }
  const Eigen::Vector3d centre = first / volume;
  second -= volume * centre * centre.transpose();
  return {volume, middle + centre, second.trace() * Eigen::Matrix3d::Identity() - second};
}

MassProperties properties_of(const SampledMesh& mesh) { return properties_of(mesh.samples->mesh); }
MassProperties properties_of(const Plane&) { throw std::invalid_argument("a half space has no mass"); }

double inradius_of(const Box& box) { return box.half_size.minCoeff(); }
double inradius_of(const Sphere& sphere) { return sphere.radius; }
double inradius_of(const Capsule& capsule) { return capsule.radius; }
double inradius_of(const SampledMesh& mesh) {
  return std::max(-mesh.samples->distances.minCoeff(), 0.5 * mesh.samples->thinnest);
}
double inradius_of(const Mesh&) {
  throw std::invalid_argument("only sampled meshes know how thick they are");
}
double inradius_of(const Plane&) { throw std::invalid_argument("a half space holds every ball"); }

/// Squares of the half plane, cut in four as long as one may hold a point deeper than the deepest known: the depth grows no faster
/// than one moves.
double inradius_of(const Revolved& solid) {
  constexpr double tolerance = 0.01;
  const Eigen::Vector3d across = solid.axis.unitOrthogonal();
  const auto depth = [&](const Eigen::Vector2d& at) {
    return -signed_distance(solid, solid.base + at[0] * across + at[1] * solid.axis);
  };
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& corner : solid.profile) box.extend(corner);
  struct Square {
    Eigen::Vector2d centre;
    double half_size;
  };
  const double whole = 0.5 * box.sizes().maxCoeff();
  std::vector<Square> squares{{box.center(), whole}};
  double deepest = std::max(0.0, depth({0.0, box.center()[1]}));  // a cylinder's own, exactly
  for (std::size_t i = 0; i < squares.size(); ++i) {
    const Square square = squares[i];
    const double here = depth(square.centre);
    deepest = std::max(deepest, here);
    if (here + std::numbers::sqrt2 * square.half_size <= (1.0 + tolerance) * deepest) continue;
    const double half = 0.5 * square.half_size;
    for (const double r : {-half, half}) {
      for (const double z : {-half, half}) squares.push_back({square.centre + Eigen::Vector2d(r, z), half});
    }
  }
  return deepest;
}

void require_body(const Shape& shape) {
  if (const auto fault = body_fault(shape)) throw std::invalid_argument("the shape of a body " + *fault);
}

}  // namespace

std::optional<std::string> body_fault(const Shape& shape) {
  if (shape.hollow) return "must not be hollow: all the space around it has no mass; give it thickness";
  if (std::holds_alternative<Plane>(shape.geometry)) return "must be bounded; a plane can be a [[wall]] only";
  return std::nullopt;
}

MassProperties mass_properties(const Shape& shape) {
  require_body(shape);
  return std::visit([](const auto& geometry) { return properties_of(geometry); }, shape.geometry);
}

double thinnest(const Shape& shape) {
  const auto* const mesh = std::get_if<SampledMesh>(&shape.geometry);
  return mesh ? mesh->samples->thinnest : 2.0 * inradius(shape);
}

double inradius(const Shape& shape) {
  require_body(shape);
  return std::visit([](const auto& geometry) { return inradius_of(geometry); }, shape.geometry);
}

}  // namespace talus
