// Rigid spheres and sand, measured: body_study impact | push. Run by hand; the figures are in physics/README.md.
//
// impact: a steel sphere of one inch falls into a bed at 1 to 4 m/s, against the force law of Katsuragi & Durian (Nature Physics 3,
// 420, 2007), m z'' = m g - k z - m z'^2 / d_1, z downwards from the surface, with their constants for glass beads.
// push: the same sphere pushed in slowly: how its force grows with depth, against their k.
#include <fmt/format.h>

#include <cmath>
#include <cstring>

#include "tests/continuum/scenes.h"

namespace {

using namespace talus;
using Eigen::Vector3d;

constexpr double radius = 0.0127;            // m
constexpr double steel = 7800.0;             // kg/m^3
constexpr double d_1 = 0.087;                // m
constexpr double k_over_m = 1040.0;          // 1/s^2
constexpr double friction_angle_deg = 24.0;  // of glass beads at rest; not fitted

double force_law_depth(double speed) {
  constexpr double dt = 1e-6;
  double z = 0.0, v = speed;
  while (v > 0.0 || z == 0.0) {
    v += dt * (testing::gravity - k_over_m * z - v * v / d_1);
    z += dt * v;
  }
  return z;
}

/// A bed with the sphere just above it, moving down at `speed`; held to it if `pushed`.
State bed(double cells_per_radius, double width, double depth, double speed, bool pushed) {
  const double h = radius / cells_per_radius, mu = testing::mu_of_deg(friction_angle_deg);
  const int across = static_cast<int>(width / h), deep = static_cast<int>(depth / h);
  Scene scene = testing::box_scene({across, across, deep + static_cast<int>(6.0 * cells_per_radius)},
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

void impact(double cells_per_radius) {
  fmt::print("| v, m/s | deepest, mm | force law, mm | ratio | stops after, ms | steps | cap hits |\n");
  std::vector<double> log_height, log_depth;
  for (const double speed : {1.0, 2.0, 3.0, 4.0}) {
    State state = bed(cells_per_radius, 0.1, 0.13, speed, false);
    const double surface = state.bodies[0].pose.position[2] - radius - 1e-4;
    double deepest = 0.0, stopped = 0.0;
    int steps = 0, caps = 0;
    testing::run_for(state, testing::step_settings(), 0.1, [&](const State& now, const StepReport& report) {
      const double depth = surface - (now.bodies[0].pose.position[2] - radius);
      ++steps;
      caps += report.cap_hits();
      if (depth > deepest + 1e-5) stopped = now.time;
      deepest = std::max(deepest, depth);
    });
    const double law = force_law_depth(speed);
    fmt::print("| {} | {:.1f} | {:.1f} | {:.2f} | {:.0f} | {} | {} |\n", speed, 1e3 * deepest, 1e3 * law,
               deepest / law, 1e3 * stopped, steps, caps);
    std::fflush(stdout);
    log_height.push_back(std::log(speed * speed / (2.0 * testing::gravity) + deepest));
    log_depth.push_back(std::log(deepest));
  }
  const Eigen::Map<const Eigen::ArrayXd> x(log_height.data(), 4), y(log_depth.data(), 4);
  const double exponent = ((x - x.mean()) * (y - y.mean())).sum() / (x - x.mean()).square().sum();
  fmt::print("depth grows with the drop H = v^2 / 2g + depth to the {:.2f}; Uehara et al. 2003: 1/3\n",
             exponent);
}

void push(double cells_per_radius) {
  State state = bed(cells_per_radius, 0.1, 0.11, 0.1, true);
  const double surface = state.bodies[0].pose.position[2] - radius - 1e-4, mass = state.bodies[0].mass;
  constexpr double bin = 0.005;
  std::vector<double> impulse(20, 0.0), time(20, 0.0);
  testing::run_for(state, testing::step_settings(), 0.6, [&](const State& now, const StepReport& report) {
    const auto b =
        static_cast<std::size_t>(std::max(0.0, (surface - (now.bodies[0].pose.position[2] - radius)) / bin));
    impulse.at(b) += report.on_bodies[0].linear[2];
    time.at(b) += report.dt;
  });
  fmt::print("| depth of the lowest point, mm | force, N | k z, N |\n");
  for (std::size_t b = 0; b < 20; ++b) {
    const double depth = (static_cast<double>(b) + 0.5) * bin;
    if (time[b] > 0.0)
      fmt::print("| {:.1f} | {:.2f} | {:.2f} |\n", 1e3 * depth, impulse[b] / time[b],
                 k_over_m * mass * depth);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const double cells = argc > 2 ? std::atof(argv[2]) : 3.0;
  if (argc > 1 && std::strcmp(argv[1], "impact") == 0) return impact(cells), 0;
  if (argc > 1 && std::strcmp(argv[1], "push") == 0) return push(cells), 0;
  fmt::print(stderr, "body_study impact | push [cells per radius]\n");
  return 2;
}
