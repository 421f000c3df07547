#include "tests/continuum/bench/specimen.h"

#include <map>

#include "tests/continuum/scenes.h"

namespace talus::bench {
namespace {

constexpr double cell_size = 0.01;         // m
constexpr double largest_velocity = 0.05;  // m/s, along each axis
constexpr int steps_before = 4;            // one cold, the others warm

Scene scene_of(const Eigen::Vector3i& sand) {
  const Eigen::Vector3i domain(2 * sand[0], 2 * sand[1], sand[2] + 8);
  Scene scene = testing::box_scene(domain, sand.cast<double>(), cell_size, 0.5);
  const Eigen::Vector3d lower(0.5 * sand[0] * cell_size, 0.5 * sand[1] * cell_size, 0.0);
  scene.fillings = {testing::box_of(0, lower, lower + cell_size * sand.cast<double>())};
  scene.sides[2][0] = {true, as_rough_as_sand};
  scene.jitter = 0.5;
  return scene;
}

Specimen make_specimen(const Eigen::Vector3i& sand) {
  State state = initial_state(scene_of(sand));
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> velocity(-largest_velocity, largest_velocity);
  state.particles.velocities =
      Eigen::Matrix3Xd::NullaryExpr(3, state.particles.count(), [&] { return velocity(random); });
  for (int i = 0; i < steps_before; ++i) step(state, StepSettings{}, 1.0);

  PointsByCell points = points_by_cell(state.grid, state.particles.positions);
  sort_by_cell(points, state.particles);
  testing::CollapseMoment moment = testing::moment_of(state);
  const Eigen::Index open = moment.region.open_faces;
  Field inverse_mass = Field::Zero(open + 1), all_faces = moment.grid.velocity;
  inverse_mass.head(open) = moment.inverse_mass;
  all_faces.head(open) = moment.velocity;
  for (const WallFace& wall : moment.region.wall_faces)
    all_faces[wall.face] += moment.dt * state.gravity[wall.axis];
  Eigen::ArrayXd friction = Eigen::ArrayXd::Constant(state.particles.count(), 0.5);
  return {std::move(state),    std::move(points),       std::move(moment),
          std::move(friction), std::move(inverse_mass), std::move(all_faces)};
}

}  // namespace

const Specimen& specimen(int size) {
  static const std::map<int, Eigen::Vector3i> sand_of{
      {1, {16, 16, 16}}, {2, {32, 16, 16}}, {4, {32, 32, 16}}, {8, {32, 32, 32}}};
  static std::map<int, Specimen> made;
  const auto there = made.find(size);
  return there != made.end() ? there->second
                             : made.emplace(size, make_specimen(sand_of.at(size))).first->second;
}

}  // namespace talus::bench
