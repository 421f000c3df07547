// A bed of sand that drains over the edge of its floor until it rests, in a grid that is turned against it.
#pragma once

#include <Eigen/Geometry>

#include "tests/continuum/scenes.h"

namespace talus::testing {

/// In the bed's own frame: x from the back wall to the edge, z up. The floor is as rough as the sand, the back wall
/// smooth. Lengths in cells.
struct DrainingBed {
  double length, depth;
  double width = 1.0;        // below 2: plane strain, y periodic, and no turn about z
  double about_y_deg = 0.0;  // how the grid is turned against the bed
  double about_z_deg = 0.0;
  double friction_angle_deg = 30.0;
};

struct DrainedAngle {
  double angle_deg;
  double left;   // share of the mass
  double speed;  // mean at the end, m/s
  int cap_hits;
};

/// Drains for `duration` seconds and fits a line to the surface where its height is 20 to 85 % of the bed's depth.
inline DrainedAngle drain(const DrainingBed& bed, double h, double duration) {
  using Eigen::Vector3d;
  const bool thin = bed.width < 2.0;
  const auto radians = [](double degrees) { return degrees * std::numbers::pi / 180.0; };
  const Eigen::Matrix3d turn = (Eigen::AngleAxisd(radians(bed.about_y_deg), Vector3d::UnitY()) *
                                Eigen::AngleAxisd(radians(bed.about_z_deg), Vector3d::UnitZ()))
                                   .toRotationMatrix();
  constexpr double thick = 3.0, room = 4.0;  // of the solids, and around the bed
  // The domain holds the bed, its solids and some air beyond the edge.
  Eigen::AlignedBox3d hull;
  for (const double x : {-thick, bed.length + room}) {
    for (const double y : {thin ? 0.0 : -thick, thin ? 1.0 : bed.width + thick}) {
      for (const double z : {-thick, bed.depth + 2.0}) hull.extend(turn * Vector3d(x, y, z));
    }
  }
  Vector3d cells = hull.sizes().array().ceil();
  if (thin) cells[1] = 1.0;
  const double mu = mu_of_deg(bed.friction_angle_deg);
  Scene scene = box_scene(cells.cast<int>(), {1.0, 1.0, 1.0}, h, mu);
  scene.grid.origin = h * hull.min();
  if (thin) scene.grid.origin[1] = 0.0;
  scene.grid.periodic[1] = thin;
  scene.gravity = turn * Vector3d(0.0, 0.0, -gravity);
  scene.jitter = 0.5;
  const auto solid = [&](const Vector3d& low, const Vector3d& high, double friction) {
    Box box{turn * (0.5 * h * (low + high)), 0.5 * h * (high - low), turn};
    return Wall{Shape{box}, friction};
  };
  const double far = thin ? 50.0 : thick, near = thin ? -50.0 : -thick;
  const double side = thin ? 50.0 : bed.width + far;
  scene.walls = {solid({-50.0, near, -thick - 50.0}, {bed.length, side, 0.0}, as_rough_as_sand),
                 solid({-thick - 50.0, near, -50.0}, {0.0, side, bed.depth + 50.0}, 0.0)};
  if (!thin) {
    scene.walls.push_back(
        solid({-50.0, -thick - 50.0, -50.0}, {bed.length + 50.0, 0.0, bed.depth + 50.0}, 0.0));
    scene.walls.push_back(
        solid({-50.0, bed.width, -50.0}, {bed.length + 50.0, bed.width + 50.0, bed.depth + 50.0}, 0.0));
  }
  Shape sand{Box{turn * (0.5 * h * Vector3d(bed.length, thin ? 1.0 : bed.width, bed.depth)),
                 0.5 * h * Vector3d(bed.length, thin ? 1.0 : bed.width, bed.depth), turn}};
  scene.fillings = {{0, sand}};
  State state = initial_state(scene);

  DrainedAngle result{};
  const double start = state.particles.masses.sum();
  run_for(state, step_settings(), duration,
          [&](const State&, const StepReport& report) { result.cap_hits += report.cap_hits(); });
  const Particles& p = state.particles;
  result.left = p.masses.sum() / start;
  result.speed = (p.velocities.colwise().norm() * p.masses.matrix()).value() / p.masses.sum();
  // Height of each column of a cell's width, from its mass.
  const int columns = static_cast<int>(bed.length);
  Eigen::ArrayXd height = Eigen::ArrayXd::Zero(columns);
  for (Eigen::Index i = 0; i < p.count(); ++i) {
    const Vector3d at = turn.transpose() * p.positions.col(i) / h;
    if (at[0] >= 0.0 && at[0] < columns) height[static_cast<int>(at[0])] += p.masses[i];
  }
  height /= state.materials[0].max_density() * h * h * h * (thin ? 1.0 : bed.width);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  for (int i = 0; i < columns; ++i) {
    if (height[i] < 0.2 * bed.depth || height[i] > 0.85 * bed.depth) continue;
    const Eigen::Vector2d row(1.0, i + 0.5);
    normal += row * row.transpose();
    sum += row * height[i];
  }
  result.angle_deg =
      -std::atan(normal.inverse().eval()(1, 0) * sum[0] + normal.inverse().eval()(1, 1) * sum[1]) * 180.0 /
      std::numbers::pi;
  return result;
}

}  // namespace talus::testing
