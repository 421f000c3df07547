#include "continuum/render/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "continuum/files/input_error.h"

namespace talus {
namespace {

// From where: to the right, towards the viewer and above, so that heaps show a lit side, a shaded one and their shadow.
constexpr double viewer_right = 0.30, viewer_near = 1.0, viewer_above = 0.42;
constexpr double filled = 0.86;  // share of the picture that the subject may fill: shadows want room

double tan_half(double field_of_view) { return std::tan(field_of_view * std::numbers::pi / 360.0); }

/// How far from the place that it looks at the viewer must be, to see all of the points.
double distance_to_see(const Eigen::Matrix3Xd& points, const Camera& towards, double aspect) {
  const Eigen::Vector3d forward = (towards.look_at - towards.position).normalized();
  const Eigen::Vector3d right = forward.cross(towards.up).normalized(), above = right.cross(forward);
  const double across = filled * tan_half(towards.field_of_view), upward = across / aspect;
  double distance = 0.0;
  for (const auto& point : points.colwise()) {
    const Eigen::Vector3d at = point - towards.look_at;
    distance = std::max({distance, std::abs(right.dot(at)) / across - forward.dot(at),
                         std::abs(above.dot(at)) / upward - forward.dot(at)});
  }
  return distance;
}

}  // namespace

ViewAxes view_axes(const Scene& scene) {
  const Eigen::Vector3d up =
      scene.gravity.norm() > 0.0 ? Eigen::Vector3d(-scene.gravity.normalized()) : Eigen::Vector3d::UnitZ();
  int vertical = 0;
  up.cwiseAbs().maxCoeff(&vertical);
  // With z up and as wide as deep: along y.
  int depth = vertical == 1 ? 2 : 1;
  const int other = 3 - vertical - depth;
  if (scene.grid.cells[other] < scene.grid.cells[depth]) depth = other;
  const Eigen::Vector3d along = Eigen::Vector3d::Unit(depth);
  const Eigen::Vector3d away = (along - along.dot(up) * up).normalized();
  return {away.cross(up), away, up};
}

Camera camera_for(const Scene& scene, const Eigen::Matrix3Xd& subject, double aspect,
                  const CameraWish& wish) {
  const ViewAxes axes = view_axes(scene);
  const Eigen::Vector3d towards_viewer =
      (viewer_right * axes.right - viewer_near * axes.away + viewer_above * axes.up).normalized();
  const Eigen::Vector3d middle = 0.5 * (subject.rowwise().minCoeff() + subject.rowwise().maxCoeff());
  Camera camera{middle + towards_viewer, middle, axes.up, wish.field_of_view};
  camera.position = middle + distance_to_see(subject, camera, aspect) * towards_viewer;
  if (wish.look_at) {
    camera.position += *wish.look_at - camera.look_at;
    camera.look_at = *wish.look_at;
  }
  if (wish.position) camera.position = *wish.position;
  if (camera.position == camera.look_at)
    throw InputError("--camera and --look-at must not be the same place");
  if (axes.up.cross(camera.look_at - camera.position).norm() <
      1e-6 * (camera.look_at - camera.position).norm())
    camera.up = axes.away;  // straight down, or up
  return camera;
}

}  // namespace talus
