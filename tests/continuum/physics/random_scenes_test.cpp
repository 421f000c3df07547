// Scenes that nobody thought of: random materials, shapes, walls, gates, bodies and sources. All run to their end with their books
// closed: mass exact, everything finite and inside, energy never above what it was at the start unless something brought it in.
//
// TALUS_RANDOM_SCENES says how many (default 200, numbered from 1); each is its number's own, so that one that fails can be had again.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <random>

#include "continuum/files/input_error.h"
#include "continuum/io/budget.h"
#include "tests/continuum/scenes.h"

namespace talus {
namespace {

constexpr double h = 0.01;  // m

/// Whole numbers and fractions that are the same on every machine.
class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  int whole(int low, int high) {  // both may come
    return low + static_cast<int>(random_() % static_cast<unsigned>(high - low + 1));
  }
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(random_()) / 4294967296.0;
  }
  bool once_in(int n) { return whole(1, n) == 1; }
  Eigen::Vector3d place(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) {
    return {between(lower[0], upper[0]), between(lower[1], upper[1]), between(lower[2], upper[2])};
  }

 private:
  std::mt19937 random_;
};

Material random_material(Dice& dice, int number) {
  Material material{fmt::format("sand {}", number),
                    dice.between(500.0, 5000.0),
                    dice.between(0.4, 0.7),
                    testing::mu_of_deg(dice.between(0.0, 45.0)),
                    {}};
  if (dice.once_in(3))
    material.rate = {material.friction + dice.between(0.0, 0.3), dice.between(0.1, 1.0),
                     dice.between(1e-3, 5e-3)};
  return material;
}

Shape random_shape(Dice& dice, const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) {
  const Eigen::Vector3d centre = 0.5 * (lower + upper), half = 0.5 * (upper - lower);
  const double least = half.minCoeff();
  switch (dice.whole(0, 2)) {
    case 0:
      return {Box{centre, half}};
    case 1:
      return {Sphere{centre, least}};
    default:
      return {Capsule{centre - 0.4 * least * Eigen::Vector3d::UnitX(),
                      centre + 0.4 * least * Eigen::Vector3d::UnitX(), 0.6 * least}};
  }
}

void add_walls(Dice& dice, Scene& scene) {
  for (int axis = 0; axis < 3; ++axis) {
    for (auto& side : scene.sides[static_cast<std::size_t>(axis)])
      side = {!dice.once_in(3), dice.between(0.0, 0.8)};
  }
  if (dice.once_in(2)) {
    scene.grid.periodic[1] = true;
    scene.sides[1] = {};
  }
  scene.sides[2][0] = {true, dice.between(0.0, 0.8)};
  if (!dice.once_in(2)) return;
  // A gate or a step across the whole width, below where bodies start: a file with a body in a wall is refused.
  const double at = dice.between(0.05, 0.08), height = dice.between(0.02, 0.085);
  Wall wall{Shape{Box{{at, 0.03, 0.5 * height}, {0.012, 0.3, 0.5 * height}}}, dice.between(0.0, 0.8)};
  if (dice.once_in(2)) wall.opens_at = dice.between(0.005, 0.03);
  scene.walls.push_back(wall);
}

void add_bodies(Dice& dice, Scene& scene) {
  for (int b = 0, count = dice.whole(0, 2); b < count; ++b) {
    const double size = dice.between(0.008, 0.014);
    const Eigen::Vector3d centre(0.03 + 0.05 * b, 0.03, dice.between(0.1, 0.12));
    Body body = make_body(
        fmt::format("body {}", b), random_shape(dice, centre.array() - size, centre.array() + size),
        dice.between(200.0, 8000.0), Free{}, {dice.place({-1, -1, -1}, {1, 1, 0}), Eigen::Vector3d::Zero()});
    body.friction = dice.between(0.0, 0.8);
    scene.bodies.push_back(body);
  }
}

Scene random_scene(unsigned seed) {
  Dice dice(seed);
  Scene scene = testing::box_scene({14, 6, 14}, {1.0, 1.0, 1.0}, h, 0.5);
  scene.seed = seed;
  scene.jitter = dice.between(0.0, 1.0);
  scene.materials = {random_material(dice, 1), random_material(dice, 2)};
  add_walls(dice, scene);
  add_bodies(dice, scene);
  scene.fillings.clear();
  for (std::size_t s = 0; s < 2; ++s) {
    const double left = 0.07 * static_cast<double>(s), width = dice.between(0.02, 0.068);
    scene.fillings.push_back(
        {s, random_shape(dice, {left, 0.0, 0.0}, {left + width, 0.06, dice.between(0.02, 0.08)}),
         dice.place({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5})});
  }
  if (dice.once_in(3))
    scene.sources = {{0,
                      {0.05, 0.01, 0.135},
                      {0.09, 0.05, 0.135},
                      dice.once_in(2),
                      {0.0, 0.0, dice.between(-2.0, -0.5)},
                      dice.between(0.3, 1.0),
                      0.0,
                      dice.between(0.02, 0.05),
                      0.5 * h}};
  scene.settings.transfer = dice.once_in(3) ? Transfer::apic : Transfer::flip;
  if (dice.once_in(4)) scene.render_points_per_particle = 2;
  return scene;
}

int scene_count() {
  const char* wanted = std::getenv("TALUS_RANDOM_SCENES");
  return wanted ? std::atoi(wanted) : 200;
}

TEST(RandomScenes, RunToTheirEndWithTheirBooksClosed) {
  int with_bodies = 0, with_sources = 0, with_gates = 0, refused = 0;
  long cap_hits = 0, stagnations = 0, steps = 0;
  for (unsigned seed = 1; seed <= static_cast<unsigned>(scene_count()); ++seed) {
    SCOPED_TRACE(fmt::format("scene {}", seed));
    const Scene scene = random_scene(seed);
    State state;
    try {
      state = initial_state(scene);
    } catch (const InputError&) {  // a body may have taken all the place that there was for a shape of sand
      ++refused;
      continue;
    }
    Budget budget(state);
    try {
      testing::run_for(state, scene.settings, 0.1, [&](const State& now, const StepReport& report) {
        budget.add(now, report);
        stagnations += report.stagnations;
        cap_hits += report.cap_hits();
        ++steps;
      });
    } catch (const std::exception& error) {
      FAIL() << error.what();
    }
    const nlohmann::json books = budget.summary();
    EXPECT_NEAR(books["mass_error"].get<double>(), 0.0, 1e-12);
    EXPECT_EQ(books["shapes_not_finite"], 0);
    EXPECT_LE(books["largest_move_cells"].get<double>(), 0.5 + 1e-9);
    require_sound(state.grid, state.particles, state.time);
    require_sound(state.bodies, state.time);
    if (scene.sources.empty()) {  // what they send has energy
      const double start = books["energy_start_j"], highest = books["energy_highest_j"];
      EXPECT_LE(highest, start * (1.0 + 1e-9)) << start;
    }
    with_bodies += !scene.bodies.empty();
    with_sources += !scene.sources.empty();
    with_gates += !scene.walls.empty();
  }
  std::printf(
      "%d scenes (%d with bodies, %d with sources, %d with walls or gates; %d refused), %ld steps, %ld cap "
      "hits, %ld stagnations\n",
      scene_count(), with_bodies, with_sources, with_gates, refused, steps, cap_hits, stagnations);
  EXPECT_LE(100 * refused, scene_count());
  EXPECT_GT(with_bodies, 0);
  EXPECT_GT(with_sources, 0);
  EXPECT_GT(with_gates, 0);
}

}  // namespace
}  // namespace talus
