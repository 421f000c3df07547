// Sand on inclined planes that cut the cells, against the same plane aligned with the grid (method.md, section 10).
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "tests/continuum/scenes.h"

namespace talus {
namespace {

using Eigen::Vector3d;
using testing::gravity;

constexpr double h = 0.01;  // m

/// A slab of sand on a plane that goes down along x at `angle`; periodic and one cell thick along y.
struct Slab {
  double angle_deg;
  double cells_deep;
  double wall_friction;
  double offset;  // of the plane against the cells

  double angle() const { return angle_deg * std::numbers::pi / 180.0; }
  Vector3d downhill() const { return {std::cos(angle()), 0.0, -std::sin(angle())}; }
  Vector3d normal() const { return {std::sin(angle()), 0.0, std::cos(angle())}; }
};

void PrintTo(const Slab& slab, std::ostream* out) {
  *out << slab.angle_deg << " degrees, " << slab.cells_deep << " cells deep, mu_w = " << slab.wall_friction;
}

constexpr double cells_long = 50.0;
constexpr double sand_friction = 0.9;  // well above the wall's, so that the slab keeps its shape

State state_of(const Slab& slab) {
  const double run = cells_long + 40.0;  // what the slab covers and slides
  const int nx = static_cast<int>(std::ceil(run * std::cos(slab.angle()) + 10.0));
  const int nz = static_cast<int>(std::ceil(run * std::sin(slab.angle()) + slab.cells_deep + 8.0));
  Scene scene = testing::box_scene({nx, 1, nz}, {1.0, 1.0, 1.0}, h, sand_friction);
  scene.grid.periodic[1] = true;
  State state = initial_state(scene);
  const Vector3d start =
      h * Vector3d(4.0 + slab.offset, 0.0, nz - slab.cells_deep - 4.0 + 0.61 * slab.offset);
  state.openings = make_openings(state.grid, [&](const Vector3d& x) {
    return WallDistance{(x - start).dot(slab.normal()), slab.wall_friction};
  });
  // A lattice along the plane, two particles to a cell's width and at least two to the depth.
  const int n_along = static_cast<int>(2.0 * cells_long),
            n_up = std::max(2, static_cast<int>(2.0 * slab.cells_deep));
  Particles& p = state.particles;
  p.resize(2 * n_along * n_up);
  Eigen::Index k = 0;
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < n_along; ++i) {
      for (int up = 0; up < n_up; ++up) {
        p.positions.col(k++) = start + (i + 0.5) * 0.5 * h * slab.downhill() +
                               (up + 0.5) * slab.cells_deep * h / n_up * slab.normal() +
                               Vector3d(0.0, (j + 0.5) * 0.5 * h, 0.0);
      }
    }
  }
  p.velocities.setZero();
  const double mass = state.materials[0].max_density() * cells_long * slab.cells_deep * h * h * h;
  p.masses.setConstant(mass / static_cast<double>(p.count()));
  std::fill(p.materials.begin(), p.materials.end(), 0);
  for (Eigen::Index i = 0; i < p.count(); ++i)
    set_shape_matrix(sphere_of_volume(p.masses[i] / state.materials[0].max_density()), p, i);
  return state;
}

double speed_downhill(const State& state, const Slab& slab) {
  const Particles& p = state.particles;
  return (slab.downhill().transpose() * p.velocities).transpose().array().cwiseProduct(p.masses).sum() /
         p.masses.sum();
}

class Slope : public ::testing::TestWithParam<Slab> {};

TEST_P(Slope, SlidesAtConstantAcceleration) {
  const Slab& slab = GetParam();
  State state = state_of(slab);
  if (slab.angle_deg == 0.0) state.particles.velocities.row(0).setConstant(1.0);
  int cap_hits = 0;
  const auto observe = [&](const State&, const StepReport& r) { cap_hits += r.projection.cap_hits; };
  testing::run_for(state, testing::step_settings(), 0.03, observe);  // the contact settles
  const double expected = gravity * (std::sin(slab.angle()) - slab.wall_friction * std::cos(slab.angle()));
  std::string ratios;
  for (int part = 0; part < 2; ++part) {
    const double speed = speed_downhill(state, slab), time = state.time;
    testing::run_for(state, testing::step_settings(), 0.08, observe);
    const double ratio = (speed_downhill(state, slab) - speed) / (state.time - time) / expected;
    EXPECT_NEAR(ratio, 1.0, 0.03);
    ratios += fmt::format(" {:.4f}", ratio);
  }
  EXPECT_EQ(cap_hits, 0);
  fmt::print("[ measured ] {} deg, {} cells deep, mu_w = {}: a / g (sin - mu cos) ={}\n", slab.angle_deg,
             slab.cells_deep, slab.wall_friction, ratios);
}

INSTANTIATE_TEST_SUITE_P(Section12, Slope,
                         ::testing::Values(Slab{35.0, 4.0, 0.4, 0.3}, Slab{35.0, 4.0, 0.4, 0.7},
                                           Slab{35.0, 1.0, 0.4, 0.3}, Slab{35.0, 4.0, 0.0, 0.3},
                                           Slab{55.0, 4.0, 0.4, 0.1}, Slab{0.0, 4.0, 0.4, 0.0},
                                           Slab{0.0, 4.0, 0.4, 0.5}),
                         [](const auto& instance) {
                           const Slab& s = instance.param;
                           return fmt::format("deg_{:.0f}_cells_{:.0f}_friction_x10_{:.0f}_offset_x10_{:.0f}",
                                              s.angle_deg, s.cells_deep, 10 * s.wall_friction, 10 * s.offset);
                         });

TEST(SlopeAtRest, SandStaysBelowTheWallFrictionAngle) {
  // The slab's steep ends slump, and its surface settles into the cells it fills in part; what lies between must stay.
  StepSettings settings = testing::step_settings();
  settings.reshape = false;  // each particle is followed
  for (const Slab& slab : {Slab{15.0, 4.0, 0.4, 0.1}, Slab{30.0, 4.0, 0.7, 0.2}}) {
    State state = state_of(slab);
    testing::tag(state);
    const Eigen::Matrix3Xd start = testing::positions_by_tag(state);
    const Eigen::ArrayXd along = (slab.downhill().transpose() * start).transpose().array();
    const Eigen::ArrayXd up = (slab.normal().transpose() * start).transpose().array();
    const auto inner = (along - along.mean()).abs() < 8.0 * h && up - up.minCoeff() < 2.5 * h;
    const auto drift_after = [&](double duration) {
      testing::run_for(state, settings, duration, [](const State&, const StepReport&) {});
      const Eigen::ArrayXd moved =
          (slab.downhill().transpose() * (testing::positions_by_tag(state) - start)).transpose().array();
      return inner.select(moved, 0.0).sum() / static_cast<double>(inner.count());
    };
    const double settled = drift_after(0.2), crept = drift_after(0.8) - settled;
    fmt::print("[ measured ] {} deg, mu_w = {}: settles by {:.4f} cells, then creeps {:.5f} cells in 0.8 s\n",
               slab.angle_deg, slab.wall_friction, settled / h, crept / h);
    EXPECT_LT(std::abs(settled), 0.02 * h);
    EXPECT_LT(std::abs(crept), 0.02 * h);
  }
}

}  // namespace
}  // namespace talus
