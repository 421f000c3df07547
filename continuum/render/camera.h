// Where pictures are taken from.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "continuum/scene/scene.h"

namespace talus {

struct Camera {
  Eigen::Vector3d position;  // m
  Eigen::Vector3d look_at;   // m, in the middle of the picture
  Eigen::Vector3d up;        // unit vector
  double field_of_view;      // degrees, across the picture
};

/// What a user wants otherwise than the default.
struct CameraWish {
  std::optional<Eigen::Vector3d> position, look_at;
  double field_of_view = 35.0;  // degrees
};

/// Axes of a picture: unit vectors to its right, away from the viewer along the ground, and up.
struct ViewAxes {
  Eigen::Vector3d right, away, up;
};

/// Up is against gravity, or along z without it; away is along the horizontal axis of the domain that it is shortest along,
/// so that flat scenes are seen from their broad side.
ViewAxes view_axes(const Scene& scene);

/// From the right and above, just so far that the points of `subject` (m) are in a picture of `aspect` (width / height); at
/// the middle of the box about them. A position alone
/// looks at the middle of the subject; a look_at alone keeps direction and distance. Throws InputError where both are one
/// place.
Camera camera_for(const Scene& scene, const Eigen::Matrix3Xd& subject, double aspect, const CameraWish& wish);

}  // namespace talus
