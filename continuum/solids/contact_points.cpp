#include "continuum/solids/contact_points.h"

#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "continuum/solids/body_images.h"
#include "continuum/solids/hollow_contact.h"
#include "continuum/solids/revolved.h"
#include "continuum/solids/surface_mesh.h"

namespace talus {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int most_found = 128;       // points of a pair that the library gives
constexpr std::size_t most_kept = 8;  // of them

struct DestroyGeom {
  void operator()(dxGeom* geom) const { dGeomDestroy(geom); }
};
struct DestroyTriMesh {
  void operator()(dxTriMeshData* data) const { dGeomTriMeshDataDestroy(data); }
};

/// One of the library's geometries, with how it lies in the axes of the shape that it stands for.
struct Geometry {
  std::vector<double> corners;  // of a mesh's triangles; the library does not copy them
  std::vector<dTriIndex> indices;
  std::unique_ptr<dxTriMeshData, DestroyTriMesh> mesh;
  std::unique_ptr<dxGeom, DestroyGeom> geom;
  Matrix3d rotation = Matrix3d::Identity();
  Vector3d position = Vector3d::Zero();
};

Geometry geometry_of(const Plane& plane) {
  const Vector3d& n = plane.normal;
  Geometry made;
  made.geom.reset(dCreatePlane(nullptr, n[0], n[1], n[2], n.dot(plane.point)));
  return made;
}

Geometry geometry_of(const Box& box) {
  const Vector3d size = 2.0 * box.half_size;
  Geometry made;
  made.geom.reset(dCreateBox(nullptr, size[0], size[1], size[2]));
  made.rotation = box.rotation;
  made.position = box.centre;
  return made;
}

Geometry geometry_of(const Sphere& sphere) {
  Geometry made;
  made.geom.reset(dCreateSphere(nullptr, sphere.radius));
  made.position = sphere.centre;
  return made;
}

Matrix3d turn_from_z(const Vector3d& axis) {
  return Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), axis).toRotationMatrix();
}

Geometry geometry_of(const Capsule& capsule) {
  const Vector3d along = capsule.to - capsule.from;
  if (along.isZero()) return geometry_of(Sphere{capsule.from, capsule.radius});
  Geometry made;
  made.geom.reset(dCreateCapsule(nullptr, capsule.radius, along.norm()));
  made.rotation = turn_from_z(along.normalized());
  made.position = 0.5 * (capsule.from + capsule.to);
  return made;
}

Geometry geometry_of_triangles(const Shape& shape) {
  Geometry made;
  for (const Triangle& triangle : surface_mesh(shape)) {
    for (const Vector3d& corner : triangle) {
      made.indices.push_back(static_cast<dTriIndex>(made.indices.size()));
      made.corners.insert(made.corners.end(), corner.begin(), corner.end());
    }
  }
  made.mesh.reset(dGeomTriMeshDataCreate());
  dGeomTriMeshDataBuildDouble(made.mesh.get(), made.corners.data(), 3 * sizeof(double),
                              static_cast<int>(made.corners.size() / 3), made.indices.data(),
                              static_cast<int>(made.indices.size()), 3 * sizeof(dTriIndex));
  made.geom.reset(dCreateTriMesh(nullptr, made.mesh.get(), nullptr, nullptr, nullptr));
  return made;
}

Geometry geometry_of(const Mesh& mesh) { return geometry_of_triangles({mesh}); }
Geometry geometry_of(const SampledMesh& mesh) { return geometry_of_triangles({mesh}); }

Geometry geometry_of(const Revolved& solid) {
  const auto size = cylinder_size(solid);
  if (!size) return geometry_of_triangles({solid});
  Geometry made;
  made.geom.reset(dCreateCylinder(nullptr, size->radius, size->height));
  made.rotation = turn_from_z(solid.axis);
  made.position = solid.base + (size->bottom + 0.5 * size->height) * solid.axis;
  return made;
}

Geometry geometry_of(const Shape& shape) {
  return std::visit([](const auto& geometry) { return geometry_of(geometry); }, shape.geometry);
}

/// Planes stand where they were made.
void place(const Geometry& geometry, const Matrix3d& rotation, const Vector3d& position) {
  if (dGeomGetClass(geometry.geom.get()) == dPlaneClass) return;
  const Matrix3d turned = rotation * geometry.rotation;
  const Vector3d at = rotation * geometry.position + position;
  dMatrix3 rows{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) rows[4 * i + j] = turned(i, j);
  }
  dGeomSetPosition(geometry.geom.get(), at[0], at[1], at[2]);
  dGeomSetRotation(geometry.geom.get(), rows);
}

/// The deepest, and then always the one furthest from those there are.
void thin_out(std::vector<ContactPoint>& points) {
  for (std::size_t kept = 0; kept < std::min(points.size(), most_kept); ++kept) {
    const auto merit = [&](const ContactPoint& point) {
      if (kept == 0) return point.depth;
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < kept; ++i)
        nearest = std::min(nearest, (points[i].position - point.position).squaredNorm());
      return nearest;
    };
    const auto first = points.begin() + static_cast<std::ptrdiff_t>(kept);
    const auto best = std::max_element(first, points.end(),
                                       [&](const auto& a, const auto& b) { return merit(a) < merit(b); });
    std::iter_swap(first, best);
  }
  if (points.size() > most_kept)
    points.erase(points.begin() + static_cast<std::ptrdiff_t>(most_kept), points.end());
}

Vector3d vector_of(const dReal* of) { return {of[0], of[1], of[2]}; }

void keep_best(std::vector<ContactPoint> points, std::vector<ContactPoint>& contacts) {
  thin_out(points);
  contacts.insert(contacts.end(), points.begin(), points.end());
}

void add_contacts(int first, int second, const Geometry& a, const Geometry& b,
                  std::vector<ContactPoint>& contacts) {
  std::array<dContactGeom, most_found> found;
  const int count =
      dCollide(a.geom.get(), b.geom.get(), most_found, found.data(), static_cast<int>(sizeof(dContactGeom)));
  std::vector<ContactPoint> points;
  for (int i = 0; i < count; ++i) {
    const dContactGeom& contact = found[static_cast<std::size_t>(i)];
    const Vector3d normal = vector_of(contact.normal);
    if (!(normal.norm() > 0.5)) continue;  // meshes give some without
    points.push_back({first, second, vector_of(contact.pos), normal.normalized(), contact.depth});
  }
  keep_best(std::move(points), contacts);
}

void add_contacts_by_points(int first, const Body& body, const Shape& wall,
                            std::vector<ContactPoint>& contacts) {
  if (signed_distance(wall, body.pose.position) > outer_radius(body)) return;
  std::vector<ContactPoint> points;
  for (const auto& [position, normal, depth] :
       touch_by_points(body, [&](const Vector3d& at) { return signed_distance(wall, at); }))
    points.push_back({first, no_body, position, normal, depth});
  keep_best(std::move(points), contacts);
}

bool is_mesh(const Geometry& geometry) { return dGeomGetClass(geometry.geom.get()) == dTriMeshClass; }

/// Of a mesh its own where it is near: samples round its edges, and turn normals beside them.
double exact_distance(const Body& body, const Vector3d& at) {
  const double distance = signed_distance(body, at);
  const auto* const sampled = std::get_if<SampledMesh>(&body.shape.geometry);
  if (!sampled || distance > sampled->samples->spacing) return distance;
  return signed_distance(sampled->samples->mesh,
                         body.pose.orientation.conjugate() * (at - body.pose.position));
}

/// Points of each in the other: the library's contacts of two meshes do not carry even a cube on a cube.
void add_contacts_of_meshes(int first, int second, const Body& a, const Body& b,
                            std::vector<ContactPoint>& contacts) {
  std::vector<ContactPoint> points;
  for (const auto& [position, normal, depth] :
       touch_by_points(a, [&](const Vector3d& at) { return exact_distance(b, at); }))
    points.push_back({first, second, position, normal, depth});
  for (const auto& [position, normal, depth] :
       touch_by_points(b, [&](const Vector3d& at) { return exact_distance(a, at); }))
    points.push_back({first, second, position, -normal, depth});
  keep_best(std::move(points), contacts);
}

bool prescribed(const Body& body) { return std::holds_alternative<Prescribed>(body.motion); }

void start_library() {
  [[maybe_unused]] static const int started = dInitODE2(0);  // for the life of the program
  dAllocateODEDataForThread(dAllocateMaskAll);
}

}  // namespace

struct ContactFinder::Geometries {
  struct Obstacle {
    Shape shape;
    Eigen::AlignedBox3d box;
    int wall;  // -1: a side of the domain
    Geometry geometry{};
  };
  std::vector<Geometry> bodies;  // both are empty until something comes near
  std::vector<Obstacle> obstacles;

  const Geometry& of_body(std::size_t i, const Body& body) {
    if (!bodies[i].geom) bodies[i] = geometry_of(body.shape);
    place(bodies[i], body.pose.orientation.toRotationMatrix(), body.pose.position);
    return bodies[i];
  }
  void add_of_pair(std::size_t i, std::size_t j, const Body& first, const Body& second,
                   std::vector<ContactPoint>& contacts) {
    const Geometry &a = of_body(i, first), &b = of_body(j, second);
    if (is_mesh(a) && is_mesh(b))
      add_contacts_of_meshes(static_cast<int>(i), static_cast<int>(j), first, second, contacts);
    else
      add_contacts(static_cast<int>(i), static_cast<int>(j), a, b, contacts);
  }
  void add_of_obstacle(std::size_t i, const Body& body, Obstacle& obstacle,
                       std::vector<ContactPoint>& contacts) {
    const Geometry &a = of_body(i, body), &b = of_obstacle(obstacle);
    if (is_mesh(a) && is_mesh(b))
      add_contacts_by_points(static_cast<int>(i), body, obstacle.shape, contacts);
    else
      add_contacts(static_cast<int>(i), no_body, a, b, contacts);
  }
  static const Geometry& of_obstacle(Obstacle& obstacle) {
    if (!obstacle.geometry.geom) {
      obstacle.geometry = geometry_of(obstacle.shape);
      place(obstacle.geometry, Matrix3d::Identity(), Vector3d::Zero());
    }
    return obstacle.geometry;
  }
};

ContactFinder::ContactFinder(std::span<const Body> bodies, const BodySurroundings& surroundings)
    : surroundings_(surroundings), geometries_(std::make_unique<Geometries>()) {
  start_library();
  geometries_->bodies.resize(bodies.size());
  for (std::size_t w = 0; w < surroundings.walls.size(); ++w) {
    const Shape& shape = surroundings.walls[w].shape;
    if (shape.hollow) continue;
    geometries_->obstacles.push_back({shape, bounds(shape), static_cast<int>(w)});
  }
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    for (const std::size_t end : {0U, 1U}) {
      if (surroundings.grid.periodic[a] || !surroundings.sides[a][end].wall) continue;
      Shape side;
      side.geometry = Plane{end == 0 ? surroundings.grid.origin : surroundings.grid.upper(),
                            (end == 0 ? 1.0 : -1.0) * Vector3d::Unit(axis)};
      geometries_->obstacles.push_back({side, bounds(side), -1});
    }
  }
}

ContactFinder::~ContactFinder() = default;

std::vector<ContactPoint> ContactFinder::find(std::span<const Body> bodies, double time) {
  std::vector<ContactPoint> contacts;
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const Body& body : bodies) boxes.push_back(bounds(body));
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      if (prescribed(bodies[i]) && prescribed(bodies[j])) continue;
      for (const Vector3d& shift : meeting_shifts(surroundings_.grid, boxes[j], boxes[i])) {
        const std::size_t before = contacts.size();
        geometries_->add_of_pair(i, j, bodies[i], shifted(bodies[j], shift), contacts);
        for (std::size_t c = before; c < contacts.size(); ++c) contacts[c].second_shift = shift;
      }
    }
    if (!prescribed(bodies[i])) add_of_walls(i, bodies[i], boxes[i], time, contacts);
  }
  return contacts;
}

void ContactFinder::add_of_walls(std::size_t i, const Body& body, const Eigen::AlignedBox3d& box, double time,
                                 std::vector<ContactPoint>& contacts) {
  const auto stands = [&](int wall) {
    return wall < 0 || surroundings_.walls[static_cast<std::size_t>(wall)].stands_at(time);
  };
  const std::vector<Vector3d> shifts = shifts_into_domain(surroundings_.grid, box);
  for (const Vector3d& shift : shifts) {
    const std::size_t before = contacts.size();
    const Body image = shifted(body, shift);
    const Eigen::AlignedBox3d place(box.min() + shift, box.max() + shift);
    for (Geometries::Obstacle& obstacle : geometries_->obstacles) {
      const bool seen = obstacle.wall < 0 && &shift != shifts.data();  // a side is the same to all images
      if (!seen && stands(obstacle.wall) && place.intersects(obstacle.box))
        geometries_->add_of_obstacle(i, image, obstacle, contacts);
    }
    for (const Wall& wall : surroundings_.walls) {
      if (wall.shape.hollow && wall.stands_at(time))
        add_contacts_by_points(static_cast<int>(i), image, wall.shape, contacts);
    }
    for (std::size_t c = before; c < contacts.size(); ++c) contacts[c].position -= shift;
  }
}

}  // namespace talus
