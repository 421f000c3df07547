#include "tests/continuum/solids/specimens.h"

#include "tests/continuum/solids/mesh_files.h"
#include "tests/test_folder.h"

namespace talus::testing {
namespace {

constexpr double spacing = 0.01;  // m
const Eigen::Vector3d base(0.2, -0.1, 0.3);
const Eigen::Vector3d oblique = Eigen::Vector3d(1.0, -2.0, 2.0) / 3.0;

Specimen plane() {
  const Eigen::Vector3d u = oblique.unitOrthogonal(), v = oblique.cross(u);
  SurfaceSamples surface;
  surface.add_patch(base - 3.5 * u - 3.5 * v, 7.0 * u, 7.0 * v, 4.0 * spacing);
  return {{Plane{base, oblique}}, surface, [](const auto& p) { return oblique.dot(p - base) < 0.0; }};
}

Specimen box_turned(const Eigen::Matrix3d& rotation) {
  const Eigen::Vector3d half(0.5, 0.2, 0.4);
  SurfaceSamples surface;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      const Eigen::Vector3d corner = side * half[axis] * rotation.col(axis) - half[a] * rotation.col(a) -
                                     half[b] * rotation.col(b) + base;
      surface.add_patch(corner, 2.0 * half[a] * rotation.col(a), 2.0 * half[b] * rotation.col(b), spacing);
    }
  }
  const auto inside = [=](const Eigen::Vector3d& p) {
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(rotation.col(axis).dot(p - base)) >= half[axis]) return false;
    }
    return true;
  };
  return {{Box{base, half, rotation}}, surface, inside};
}

Specimen box() { return box_turned(Eigen::Matrix3d::Identity()); }
Specimen rotated_box() { return box_turned(Eigen::AngleAxisd(0.7, oblique).toRotationMatrix()); }

Specimen sphere() {
  SurfaceSamples surface;
  for (int i = 0; i < 200; ++i) {  // a profile of chords so short that they count as the arc
    const double a = std::numbers::pi * i / 200, b = std::numbers::pi * (i + 1) / 200;
    surface.add_band(base, Eigen::Vector3d::UnitZ(), {0.6 * std::sin(a), 0.6 * std::cos(a)},
                     {0.6 * std::sin(b), 0.6 * std::cos(b)}, spacing);
  }
  return {{Sphere{base, 0.6}}, surface, [](const auto& p) { return (p - base).squaredNorm() < 0.36; }};
}

Specimen capsule() {
  const double half_length = 0.4, radius = 0.3;
  SurfaceSamples surface;
  surface.add_band(base, oblique, {radius, -half_length}, {radius, half_length}, spacing);
  for (int i = 0; i < 100; ++i) {
    const double a = 0.5 * std::numbers::pi * i / 100, b = 0.5 * std::numbers::pi * (i + 1) / 100;
    for (const double side : {-1.0, 1.0}) {
      surface.add_band(base, oblique, {radius * std::cos(a), side * (half_length + radius * std::sin(a))},
                       {radius * std::cos(b), side * (half_length + radius * std::sin(b))}, spacing);
    }
  }
  const auto inside = [=](const Eigen::Vector3d& p) {
    const double z = oblique.dot(p - base), beyond = std::max(0.0, std::abs(z) - half_length);
    return oblique.cross(p - base).squaredNorm() + beyond * beyond < radius * radius;
  };
  return {{Capsule{base - half_length * oblique, base + half_length * oblique, radius}}, surface, inside};
}

/// `corners`: from axis to axis, or closed by repeating the first; `inside(r, z)`.
template <class Inside>
Specimen turned(const Revolved& solid, const std::vector<Eigen::Vector2d>& corners, Inside inside) {
  SurfaceSamples surface;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i)
    surface.add_band(solid.base, solid.axis, corners[i], corners[i + 1], spacing);
  return {{solid}, surface, [=](const Eigen::Vector3d& p) {
            return inside(solid.axis.cross(p - solid.base).norm(), solid.axis.dot(p - solid.base));
          }};
}

Specimen a_cylinder() {
  return turned(cylinder(base, oblique, 0.4, 0.9), {{0, 0}, {0.4, 0}, {0.4, 0.9}, {0, 0.9}},
                [](double r, double z) { return r < 0.4 && z > 0.0 && z < 0.9; });
}

Specimen upright_cylinder() {
  return turned(cylinder(base, Eigen::Vector3d::UnitZ(), 0.4, 0.9), {{0, 0}, {0.4, 0}, {0.4, 0.9}, {0, 0.9}},
                [](double r, double z) { return r < 0.4 && z > 0.0 && z < 0.9; });
}

Specimen pointed_cone() {
  return turned(cone(base, oblique, 0.5, 0.0, 1.0), {{0, 0}, {0.5, 0}, {0, 1}},
                [](double r, double z) { return z > 0.0 && r < 0.5 * (1.0 - z); });
}

Specimen frustum() {
  return turned(cone(base, oblique, 0.2, 0.6, 0.8), {{0, 0}, {0.2, 0}, {0.6, 0.8}, {0, 0.8}},
                [](double r, double z) { return z > 0.0 && z < 0.8 && r < 0.2 + 0.5 * z; });
}

Specimen an_hourglass() {
  // Cones of 45 degrees from 0.4 to 0.1: 0.3 high. Levels 0, 0.2, 0.5, 0.6, 0.9, 1.1.
  const auto solid = hourglass(base, oblique, {0.4, 0.2, 0.1, 0.1, std::numbers::pi / 4});
  return turned(solid,
                {{0, 0}, {0.4, 0}, {0.4, 0.2}, {0.1, 0.5}, {0.1, 0.6}, {0.4, 0.9}, {0.4, 1.1}, {0, 1.1}},
                [](double r, double z) {
                  const double from_middle = std::abs(z - 0.55);
                  return from_middle < 0.55 && r < std::clamp(0.05 + from_middle, 0.1, 0.4);
                });
}

Specimen hollow_hourglass() {
  Specimen specimen = an_hourglass();
  specimen.shape.hollow = true;
  specimen.inside = [filled = specimen.inside](const Eigen::Vector3d& p) { return !filled(p); };
  return specimen;
}

Specimen ring() {  // off the axis, with an L for its section
  const std::vector<Eigen::Vector2d> corners{{0.3, 0},   {0.8, 0},   {0.8, 0.2},
                                             {0.5, 0.2}, {0.5, 0.6}, {0.3, 0.6}};
  auto closed = corners;
  closed.push_back(corners.front());
  return turned(Revolved{base, oblique, corners}, closed, [](double r, double z) {
    return z > 0.0 && r > 0.3 && ((r < 0.8 && z < 0.2) || (r < 0.5 && z < 0.6));
  });
}

Specimen dented() {  // touches the axis in two points only, and turns the other way round
  const std::vector<Eigen::Vector2d> corners{{0, 0}, {0.4, 1.0}, {0.8, 0.4}, {0, -0.6}};
  return turned(
      Revolved{base, oblique, corners}, {{0, 0}, {0.4, 1.0}, {0.8, 0.4}, {0, -0.6}},
      [](double r, double z) { return z < 2.5 * r && z < 1.0 - 1.5 * (r - 0.4) && z > -0.6 + 1.25 * r; });
}

/// How often the surface winds round `point`: the sum of solid angles over 4 pi (van Oosterom and Strackee 1983).
double winding_number(const Triangles& triangles, const Eigen::Vector3d& point) {
  double sum = 0.0;
  for (const Triangle& t : triangles) {
    const Eigen::Vector3d a = t[0] - point, b = t[1] - point, c = t[2] - point;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (2.0 * std::numbers::pi);
}

Specimen mesh() {  // a coarse torus, and inside its hole a box with a cavity
  const Triangles triangles = together(
      torus_mesh(0.9, 0.4, 8), together(box_mesh({-0.25, -0.25, -0.25}, {0.25, 0.125, 0.5}),
                                        flipped(box_mesh({-0.125, -0.125, -0.125}, {0.125, 0.0, 0.25}))));
  const TestFolder folder;
  write_text_stl(folder.path() / "mesh.stl", triangles);
  SurfaceSamples surface;
  for (const Triangle& t : triangles) surface.add_patch(t[0], t[1] - t[0], t[2] - t[0], 1.5 * spacing, true);
  return {{read_mesh(folder.path() / "mesh.stl")}, surface, [=](const Eigen::Vector3d& p) {
            return winding_number(triangles, p) > 0.5;
          }};
}

}  // namespace

std::vector<SpecimenMaker> specimens() {
  return {{"Plane", plane},
          {"Box", box},
          {"RotatedBox", rotated_box},
          {"Sphere", sphere},
          {"Capsule", capsule},
          {"Cylinder", a_cylinder},
          {"UprightCylinder", upright_cylinder},
          {"PointedCone", pointed_cone},
          {"Frustum", frustum},
          {"Hourglass", an_hourglass},
          {"HollowHourglass", hollow_hourglass},
          {"Ring", ring},
          {"Dented", dented},
          {"Mesh", mesh}};
}

}  // namespace talus::testing
