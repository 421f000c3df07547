// Spheres that fall or are pushed into sand, against what was measured of real ones. Figures: README.md.
//
// A steel sphere falls into a bed of glass beads at 1 to 4 m/s: the force law of Katsuragi & Durian (Nature Physics 3, 420, 2007),
// m z'' = m g - k z - m z'^2 / d_1, z downwards from the surface, with their constants for an inch; depth ~ (D^2 H)^(1/3), H the whole drop
// (Uehara et al., Phys. Rev. Lett. 90, 194301, 2003). Nothing is fitted. TALUS_CELLS_PER_RADIUS sets the grid, 2 by default.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "tests/continuum/scenes.h"

namespace talus {
namespace {

using Eigen::Vector3d;
using testing::gravity;

constexpr double inch_radius = 0.0127;       // m
constexpr double steel = 7800.0;             // kg/m^3
constexpr double d_1 = 0.087;                // m
constexpr double k_over_m = 1040.0;          // 1/s^2
constexpr double friction_angle_deg = 24.0;  // of glass beads at rest

double cells_per_radius() {
  const char* wanted = std::getenv("TALUS_CELLS_PER_RADIUS");
  return wanted ? std::atof(wanted) : 2.0;
}

double force_law_depth(double speed) {
  constexpr double dt = 1e-6;
  double z = 0.0, v = speed;
  while (v > 0.0 || z == 0.0) {
    v += dt * (gravity - k_over_m * z - v * v / d_1);
    z += dt * v;
  }
  return z;
}

/// A bed 8 radii wide and 10 deep with the sphere just above it, moving down at `speed`; held to it if `pushed`.
State bed_under_sphere(double radius, double speed, bool pushed) {
  const double h = radius / cells_per_radius(), mu = testing::mu_of_deg(friction_angle_deg);
  const int across = static_cast<int>(8.0 * cells_per_radius()),
            deep = static_cast<int>(10.0 * cells_per_radius());
  Scene scene = testing::box_scene({across, across, deep + static_cast<int>(6.0 * cells_per_radius())},
                                   Vector3d(across, across, deep), h, mu);
  scene.jitter = 0.5;
  scene.sides[0] = scene.sides[1] = {Side{true, mu}, Side{true, mu}};
  scene.sides[2][0] = {true, mu};
  State state = initial_state(scene);
  const Vector3d centre(0.5 * across * h, 0.5 * across * h, deep * h + radius + 1e-4);
  const Twist down{{0.0, 0.0, -speed}, Vector3d::Zero()};
  BodyMotion motion = Free{};
  if (pushed) motion = Prescribed{down, 0.0, 100.0};
  Body sphere = make_body("sphere", Shape{Sphere{centre, radius}}, steel, motion, down);
  sphere.friction = mu;
  add_bodies(state, {sphere});
  return state;
}

/// How deep its lowest point comes below the surface, m.
double depth_of_impact(double radius, double speed) {
  State state = bed_under_sphere(radius, speed, false);
  const double start = state.bodies[0].pose.position[2] - 1e-4;
  double deepest = 0.0;
  testing::run_for(state, testing::step_settings(), 0.1, [&](const State& now, const StepReport&) {
    deepest = std::max(deepest, start - now.bodies[0].pose.position[2]);
  });
  return deepest;
}

/// Least squares.
double slope(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<Eigen::Index>(x.size());
  const Eigen::Map<const Eigen::ArrayXd> u(x.data(), n), v(y.data(), n);
  return ((u - u.mean()) * (v - v.mean())).sum() / (u - u.mean()).square().sum();
}

double drop(double speed, double depth) { return speed * speed / (2.0 * gravity) + depth; }

TEST(Impact, GoesAsDeepAsTheForceLawOfKatsuragiAndDurianSays) {
  std::vector<double> drops, depths;
  for (const double speed : {1.0, 2.0, 3.0, 4.0}) {
    const double depth = depth_of_impact(inch_radius, speed), law = force_law_depth(speed);
    fmt::print("[ measured ] {} m/s: {:.1f} mm; force law {:.1f} mm; ratio {:.2f}\n", speed, 1e3 * depth,
               1e3 * law, depth / law);
    EXPECT_NEAR(depth / law, 1.0, 0.15);
    drops.push_back(std::log(drop(speed, depth)));
    depths.push_back(std::log(depth));
  }
  fmt::print("[ measured ] depth ~ H^{:.2f}; Uehara et al. 1/3\n", slope(drops, depths));
  EXPECT_NEAR(slope(drops, depths), 1.0 / 3.0, 0.05);
}

TEST(Impact, DepthGrowsWithTheDiameterSquaredTimesTheDropToTheThird) {
  std::vector<double> scaled, depths;
  for (const double radius : {0.5 * inch_radius, inch_radius, 2.0 * inch_radius}) {
    const double depth = depth_of_impact(radius, 2.0);
    fmt::print("[ measured ] D = {:.1f} mm: {:.1f} mm\n", 2e3 * radius, 1e3 * depth);
    scaled.push_back(std::log(4.0 * radius * radius * drop(2.0, depth)));
    depths.push_back(std::log(depth));
  }
  fmt::print("[ measured ] depth ~ (D^2 H)^{:.2f}; Uehara et al. 1/3\n", slope(scaled, depths));
  EXPECT_NEAR(slope(scaled, depths), 1.0 / 3.0, 0.05);
}

TEST(Impact, ASpherePushedInSlowlyFeelsAForceThatGrowsWithDepth) {
  State state = bed_under_sphere(inch_radius, 0.1, true);
  const double start = state.bodies[0].pose.position[2] - 1e-4, mass = state.bodies[0].mass;
  constexpr double bin = 0.01;
  std::vector<double> impulse(5, 0.0), time(5, 0.0);
  testing::run_for(state, testing::step_settings(), 0.49, [&](const State& now, const StepReport& report) {
    const double depth = start - now.bodies[0].pose.position[2];
    const auto b = static_cast<std::size_t>(std::max(0.0, depth / bin));
    impulse.at(b) += report.on_bodies[0].linear[2];
    time.at(b) += report.dt;
  });
  double before = 0.0;
  for (std::size_t b = 0; b < time.size(); ++b) {
    const double depth = (static_cast<double>(b) + 0.5) * bin, force = impulse[b] / time[b],
                 theirs = k_over_m * mass * depth;
    fmt::print("[ measured ] {:.0f} mm: {:.2f} N; k z {:.2f} N\n", 1e3 * depth, force, theirs);
    EXPECT_GT(force, before);
    before = force;
    // Their k is inferred from impacts: what pushes slowly feels is the same when the sphere is just covered, and 1.6 times as much at 4 R.
    if (depth > 0.5 * inch_radius) {
      EXPECT_GT(force, 0.6 * theirs);
      EXPECT_LT(force, 1.8 * theirs);
    }
  }
}

}  // namespace
}  // namespace talus
