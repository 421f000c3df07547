// The scenes of the source at half the cells along each axis: what its text says of each, measured. Figures: README.md.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "continuum/io/budget.h"
#include "tests/continuum/splash.h"

namespace talus {
namespace {

using Eigen::Vector3d;

Scene small_scene(const std::string& name) {
  return read_scene(std::filesystem::path(TALUS_SOURCE_DIR) / "continuum/scenes/seed" /
                    (name + "_small.toml"));
}

/// Runs to `end` (s); calls observe(state, report) after each step. Returns how many solves stopped at their cap.
template <class Observe>
int run_to(const Scene& scene, State& state, double end, Observe&& observe) {
  int caps = 0;
  while (end - state.time > 1e-9) {
    const StepReport report = step(state, scene.settings, end - state.time);
    caps += report.cap_hits();
    observe(state, report);
  }
  return caps;
}
int run_to(const Scene& scene, State& state, double end) {
  return run_to(scene, state, end, [](const State&, const StepReport&) {});
}

Scene without_render_points(Scene scene) {
  scene.render_points_per_particle = 0;
  return scene;
}

const Body& body_named(const State& state, std::string_view name) {
  return *std::find_if(state.bodies.begin(), state.bodies.end(),
                       [&](const Body& b) { return b.name == name; });
}

/// Share of the sand's mass whose cell is filled by less than half: what flies dispersed.
double dispersed_share(const State& state) {
  const ActiveRegion region =
      make_active_region(state.grid, state.sides, state.particles.positions, state.openings);
  const Field fill = deposit_fill(region, state.particles, state.materials);
  double dispersed = 0.0;
  for (Eigen::Index p = 0; p < state.particles.count(); ++p) {
    const int dense = state.grid.cell_index(state.grid.cell_at(state.particles.positions.col(p)));
    if (fill[region.cell_of_dense[static_cast<std::size_t>(dense)]] < 0.5)
      dispersed += state.particles.masses[p];
  }
  return dispersed / state.particles.masses.sum();
}

// "In an incompressible fluid, this divergence would be immediately nullified by the pressure projection, but the cohesionless
// pressure solve allows the sand to disperse."
TEST(SeedScenes, ExplosionDispersesSandAndThrowsBodies) {
  const Scene scene = without_render_points(small_scene("explosion"));
  State state = initial_state(scene);
  EXPECT_EQ(run_to(scene, state, 0.1), 0);
  const double before = dispersed_share(state);
  std::vector<double> highest;
  for (const Body& body : state.bodies) highest.push_back(body.pose.position[2]);
  const std::vector<double> at_rest = highest;
  double most = 0.0;
  const int caps = run_to(scene, state, 0.3, [&](const State& now, const StepReport&) {
    most = std::max(most, dispersed_share(now));
    for (std::size_t b = 0; b < highest.size(); ++b)
      highest[b] = std::max(highest[b], now.bodies[b].pose.position[2]);
  });
  fmt::print(
      "[ measured ] dispersed: {:.3f} of the sand before, {:.3f} at most after; {} solves at their cap\n",
      before, most, caps);
  for (std::size_t b = 0; b < highest.size(); ++b) {
    fmt::print("[ measured ] {} rose by {:.3f} m\n", state.bodies[b].name, highest[b] - at_rest[b]);
    EXPECT_GT(highest[b] - at_rest[b], 0.02) << state.bodies[b].name;
  }
  EXPECT_GT(most, 2.0 * before);
  EXPECT_EQ(caps, 0);  // 4, to 0.01 g dt alone
}

/// Rates (kg/s) at which sand leaves the upper bulb while it holds from 75 to 60 % of its mass, and from 45 to 30 %.
std::array<double, 2> rates_of_hourglass(double friction_factor) {
  Scene scene = without_render_points(small_scene("hourglass"));
  for (Material& material : scene.materials) material.friction *= friction_factor;
  for (Wall& wall : scene.walls) wall.friction *= friction_factor;
  State state = initial_state(scene);
  const double neck = 0.0985, total = state.particles.masses.sum();
  std::array<double, 4> passed{};  // when the bulb held 75, 60, 45 and 30 %
  constexpr std::array<double, 4> marks{0.75, 0.60, 0.45, 0.30};
  while (passed[3] == 0.0 && state.time < scene.end_time) {
    step(state, scene.settings, 0.01);
    double above = 0.0;
    for (Eigen::Index p = 0; p < state.particles.count(); ++p)
      above += state.particles.positions(2, p) > neck ? state.particles.masses[p] : 0.0;
    for (std::size_t m = 0; m < marks.size(); ++m) {
      if (passed[m] == 0.0 && above < marks[m] * total) passed[m] = state.time;
    }
  }
  return {0.15 * total / (passed[1] - passed[0]), 0.15 * total / (passed[3] - passed[2])};
}

// "Friction ... maintains a constant rate of flow of sand through the neck of the hourglass, unlike a traditional liquid whose
// rate of flow would depend on the height of the liquid above it."
TEST(SeedScenes, HourglassRunsAtAConstantRateByFrictionAlone) {
  const auto [early, late] = rates_of_hourglass(1.0);
  const auto [liquid_early, liquid_late] = rates_of_hourglass(0.0);
  fmt::print(
      "[ measured ] rate {:.4f}, then {:.4f} kg/s ({:+.1f} %); without friction {:.4f}, {:.4f} ({:+.1f} %)\n",
      early, late, 100.0 * (late / early - 1.0), liquid_early, liquid_late,
      100.0 * (liquid_late / liquid_early - 1.0));
  EXPECT_NEAR(late / early, 1.0, 0.05);
  EXPECT_LT(liquid_late / liquid_early, 0.9);
}

// "Accurate coupling of frictional stress is necessary for the material to be able to support the weight of bodies much denser
// than itself. Friction also causes the lighter spheres roll without slipping on the sand surface."
TEST(SeedScenes, HeavySpheresAreCarriedAndLightOnesRoll) {
  const Scene scene = without_render_points(small_scene("impacts"));
  State state = initial_state(scene);
  EXPECT_EQ(run_to(scene, state, 0.45), 0);
  for (const char* name : {"light_1", "light_2"}) {
    const Body& ball = body_named(state, name);
    const double speed = ball.twist.velocity[0], surface = 0.08 * ball.twist.angular_velocity[1];
    const double way = ball.pose.position[0] - body_named(initial_state(scene), name).pose.position[0];
    fmt::print("[ measured ] {}: came {:.3f} m; v {:.3f} m/s, omega R {:.3f} m/s; at the start 1 and 0\n",
               name, way, speed, surface);
    EXPECT_GT(way, 0.08) << name;
    EXPECT_GT(speed, 0.05) << name;
    EXPECT_GT(surface, 0.8 * speed) << name;  // it lies in a rut, which has it turn the faster
    EXPECT_LT(surface, 1.5 * speed) << name;
  }
  run_to(scene, state, 0.9);
  std::vector<double> heights;
  for (const char* name : {"heavy_1", "heavy_2", "heavy_3"})
    heights.push_back(body_named(state, name).pose.position[2]);
  run_to(scene, state, 1.1);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const Body& ball = body_named(state, fmt::format("heavy_{}", i + 1));
    const double sank = heights[i] - ball.pose.position[2];
    fmt::print(
        "[ measured ] {} ({} kg/m3): centre {:.3f} m above the floor, {:.1e} m lower after another 0.2 s\n",
        ball.name, ball.density, ball.pose.position[2], sank);
    EXPECT_GT(ball.pose.position[2], 0.082) << "not through the bed";
    EXPECT_LT(std::abs(sank), 2e-3);
  }
}

TEST(SeedScenes, PaddleWheelsTurn) {
  const Scene scene = without_render_points(small_scene("paddles"));
  State state = initial_state(scene);
  std::vector<double> net(3, 0.0), turned(3, 0.0);  // turned: to and fro
  run_to(scene, state, 0.9, [&](const State& now, const StepReport& report) {
    for (std::size_t b = 0; b < 3; ++b) {
      const double by = report.dt * now.bodies[b].twist.angular_velocity[1];
      net[b] += by;
      turned[b] += std::abs(by);
    }
    EXPECT_EQ(report.particles_left, 0);
    EXPECT_LT(report.collisions.deepest, now.grid.spacing);
  });
  for (std::size_t b = 0; b < 3; ++b) {
    fmt::print("[ measured ] {} turned by {:.2f} rad, in all {:+.2f}\n", state.bodies[b].name, turned[b],
               net[b]);
    EXPECT_GT(turned[b], 1.0) << state.bodies[b].name;
  }
}

// "The differing densities and friction of the materials give rise to different interactions."
TEST(SeedScenes, MaterialsSpreadByTheirFrictionAndPushByTheirDensity) {
  const Scene scene = without_render_points(small_scene("materials"));
  State state = initial_state(scene);
  run_to(scene, state, 1.2);
  std::array<double, 3> mass{}, along{}, spread{}, height{};
  for (Eigen::Index p = 0; p < state.particles.count(); ++p) {
    const auto m = static_cast<std::size_t>(state.particles.materials[static_cast<std::size_t>(p)]);
    const Vector3d x = state.particles.positions.col(p);
    mass[m] += state.particles.masses[p];
    along[m] += state.particles.masses[p] * x[0];
    spread[m] += state.particles.masses[p] * std::pow(x[1] - 0.6, 2);
    height[m] += state.particles.masses[p] * x[2];
  }
  for (std::size_t m = 0; m < 3; ++m) {
    along[m] /= mass[m];
    spread[m] = std::sqrt(spread[m] / mass[m]);
    height[m] /= mass[m];
    fmt::print("[ measured ] {}: mean x {:.3f} m, spread along y {:.3f} m, mean height {:.3f} m\n",
               scene.materials[m].name, along[m], spread[m], height[m]);
  }
  EXPECT_LT(spread[0], spread[1]);
  EXPECT_LT(spread[1], spread[2]);
  // The dense one, in the gap beside it, pushes the one in between further than that pushes back.
  EXPECT_GT(along[1] - 0.6, 0.0);
}

TEST(SeedScenes, ColumnCollapsesToAMoundThatHardlyMoves) {
  const Scene scene = without_render_points(small_scene("comparison"));
  State state = initial_state(scene);
  const double energy = total_energy(state);
  double highest = energy;
  run_to(scene, state, 1.3,
         [&](const State& now, const StepReport&) { highest = std::max(highest, total_energy(now)); });
  const double height = state.particles.positions.row(2).maxCoeff();
  const double speed =
      std::sqrt((state.particles.velocities.colwise().squaredNorm() * state.particles.masses.matrix())[0] /
                state.particles.masses.sum());
  fmt::print("[ measured ] from 0.912 m high to {:.3f} m; mean speed {:.4f} m/s\n", height, speed);
  EXPECT_LT(highest, 1.001 * energy);
  EXPECT_LT(height, 0.6);
  EXPECT_LT(speed, 0.15);
}

/// The splash after each of the splash_moments, of three arrangements of the same sand together.
std::array<testing::Splash, 3> splash(Scheme scheme) {
  Scene scene = without_render_points(small_scene("splash"));
  scene.settings.scheme = scheme;
  return testing::splashes(scene, 3);
}

// "Some anisotropy visible in the splash is due to the linearization of the friction constraint (5.15)": ours has the cone.
TEST(SeedScenes, SplashIsRoundWithTheConeAndSquareWithTheBox) {
  const auto cone = splash(Scheme::consistent), box = splash(Scheme::paper);
  for (std::size_t moment = 0; moment < cone.size(); ++moment) {
    const auto told = [&](const testing::Splash& s) {
      return fmt::format("{:.3f} (by chance {:.3f}, {} particles)", s.anisotropy(), s.by_chance(),
                         s.particles);
    };
    fmt::print("[ measured ] splash after {:.2f} s: anisotropy {} with the cone, {} with the source's box\n",
               testing::splash_moments[moment], told(cone[moment]), told(box[moment]));
  }
  EXPECT_GT(cone[0].particles, 500);
  EXPECT_LT(cone[0].anisotropy(), 0.05);
  // At first too little rises by the box's scheme to tell anything of it.
  EXPECT_GT(box[1].anisotropy(), 2.0 * box[1].by_chance());
  EXPECT_GT(box[1].anisotropy(), cone[1].anisotropy());
}

}  // namespace
}  // namespace talus
