#include "continuum/solids/shape.h"

#include <algorithm>
#include <limits>

namespace talus {
namespace {

double signed_distance(const Plane& plane, const Eigen::Vector3d& point) {
  return plane.normal.dot(point - plane.point);
}

double signed_distance(const Box& box, const Eigen::Vector3d& point) {
  const Eigen::Vector3d beyond =
      (box.rotation.transpose() * (point - box.centre)).cwiseAbs() - box.half_size;  // of each pair of faces
  return beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0);
}

double signed_distance(const Sphere& sphere, const Eigen::Vector3d& point) {
  return (point - sphere.centre).norm() - sphere.radius;
}

double signed_distance(const Capsule& capsule, const Eigen::Vector3d& point) {
  const Eigen::Vector3d along = capsule.to - capsule.from, offset = point - capsule.from;
  const double squared = along.squaredNorm();
  const double share = squared > 0.0 ? std::clamp(offset.dot(along) / squared, 0.0, 1.0) : 0.0;
  return (offset - share * along).norm() - capsule.radius;
}

Eigen::AlignedBox3d all_space() {
  const Eigen::Vector3d infinite = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  return {-infinite, infinite};
}

Eigen::AlignedBox3d bounds(const Plane&) { return all_space(); }

Eigen::AlignedBox3d bounds(const Box& box) {
  const Eigen::Vector3d reach = box.rotation.cwiseAbs() * box.half_size;
  return {box.centre - reach, box.centre + reach};
}

Eigen::AlignedBox3d bounds(const Sphere& sphere) {
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(sphere.radius);
  return {sphere.centre - reach, sphere.centre + reach};
}

Eigen::AlignedBox3d bounds(const Capsule& capsule) {
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(capsule.radius);
  return {capsule.from.cwiseMin(capsule.to) - reach, capsule.from.cwiseMax(capsule.to) + reach};
}

}  // namespace

double signed_distance(const Shape& shape, const Eigen::Vector3d& point) {
  const double distance =
      std::visit([&](const auto& geometry) { return signed_distance(geometry, point); }, shape.geometry);
  return shape.hollow ? -distance : distance;
}

Eigen::AlignedBox3d bounds(const Shape& shape) {
  if (shape.hollow) return all_space();
  return std::visit([](const auto& geometry) { return bounds(geometry); }, shape.geometry);
}

}  // namespace talus
