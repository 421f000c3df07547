// Where bodies touch each other, walls and the domain's own sides: found by ODE's colliders.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <span>
#include <vector>

#include "continuum/grid/boundary.h"
#include "continuum/grid/grid.h"
#include "continuum/solids/body.h"
#include "continuum/solids/wall.h"

namespace talus {

/// What stands about the bodies; all of it outlives its users.
struct BodySurroundings {
  const Grid& grid;
  const DomainSides& sides;
  std::span<const Wall> walls;
  Eigen::Vector3d gravity;  // m/s^2
};

inline constexpr int no_body = -1;

struct ContactPoint {
  int first, second;         // bodies; `second` is no_body where a wall or a side is touched
  Eigen::Vector3d position;  // m, with the first body where its pose says
  Eigen::Vector3d normal;    // unit vector into the first body
  double depth;              // m, at least 0: how far they must part along the normal
  Eigen::Vector3d second_shift =
      Eigen::Vector3d::Zero();  // m, from where the second's pose says to where it touches
};

/// Finds contacts of the same bodies and walls again and again; what the library keeps of them (search trees of meshes) is
/// made once. Bodies' shapes must not change in the meantime; their poses may.
///
/// Spheres, boxes, capsules and cylinders are exact, and so are planes and the domain's sides. Meshes, cones and profiles touch
/// as triangles (surface_mesh.h). Where a wall is hollow, points of the body's surface (all a sphere, a capsule's line, a
/// cylinder's lowest ones, corners and a lattice on boxes and triangles) are held against the wall's own distance: what
/// of such a wall stands out between them, as the edge of an opening may, is not seen. So it is with two of what touches
/// as triangles: points of each against the other, of the body alone against a wall. Over
/// periodic seams bodies touch each other and walls as images do (body_images.h), but no body touches itself.
class ContactFinder {
 public:
  ContactFinder(std::span<const Body> bodies, const BodySurroundings& surroundings);
  ~ContactFinder();
  ContactFinder(const ContactFinder&) = delete;
  ContactFinder& operator=(const ContactFinder&) = delete;

  /// At most 8 points a pair, the deepest among them. Pairs that cannot move are left out.
  std::vector<ContactPoint> find(std::span<const Body> bodies, double time);

 private:
  void add_of_walls(std::size_t i, const Body& body, const Eigen::AlignedBox3d& box, double time,
                    std::vector<ContactPoint>& contacts);

  struct Geometries;
  const BodySurroundings surroundings_;
  std::unique_ptr<Geometries> geometries_;
};

}  // namespace talus
