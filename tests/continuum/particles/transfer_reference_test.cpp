// The fast transfer against the slow one, on ragged regions with walls, solids and periodic axes; and with more threads.
#include <gtest/gtest.h>

#include <random>

#include "continuum/parallel.h"
#include "continuum/particles/move.h"
#include "tests/continuum/grid/ragged_region.h"
#include "tests/continuum/particles/particle_sums.h"
#include "tests/continuum/particles/slow_transfer.h"

namespace talus {
namespace {

const std::vector<Material> materials{{"sand", 2500.0, 0.6, 0.5, {}}, {"gravel", 2600.0, 0.55, 0.7, {}}};

class TransferReference : public ::testing::TestWithParam<testing::Setting> {
 protected:
  TransferReference() {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    // In each cell of the sand's a few particles, in no order; some on the planes between half cells.
    const Eigen::Index n = 5 * sand_.positions.cols();
    particles_.resize(n);
    for (Eigen::Index p = 0; p < n; ++p) {
      const Eigen::Vector3d cell =
          sand_.grid.cell_at(sand_.positions.col(p * 7 % sand_.positions.cols())).cast<double>();
      for (int axis = 0; axis < 3; ++axis)
        particles_.positions(axis, p) = 0.5 * (cell[axis] + (p % 11 == axis ? 0.5 : unit(random_)));
      particles_.masses[p] = 0.5 + unit(random_);
      particles_.materials[static_cast<std::size_t>(p)] = p % 3 == 0;
      const double axes = 0.1 + 0.2 * unit(random_);
      set_shape_matrix(testing::ellipsoid(axes, 0.2, 0.15), particles_, p);
    }
    for (double& v : particles_.velocities.reshaped()) v = normal(random_);
    friction_ = testing::random_field(n, random_).abs();
    faces_ = testing::random_field(region_.face_count(), random_);
    faces_[region_.null_face()] = 0.0;
  }

  void carry_gradients() {
    particles_.gradients.resize(9, particles_.count());
    particles_.gradients.reshaped() = testing::random_field(9 * particles_.count(), random_).matrix();
  }

  void expect_same(const Field& fast, const Field& slow) {
    ASSERT_EQ(fast.size(), slow.size());
    EXPECT_LT((fast - slow).abs().maxCoeff(), 1e-12 * (1.0 + slow.abs().maxCoeff()));
    EXPECT_GT(slow.abs().maxCoeff(), 0.0);
  }

  void expect_same_deposit() {
    const GridState fast = deposit(region_, particles_, materials, friction_);
    const GridState slow = slow_.deposit(particles_, minimum_volumes(particles_, materials), friction_);
    expect_same(fast.fill, slow.fill);
    expect_same(fast.friction, slow.friction);
    expect_same(fast.face_mass, slow.face_mass);
    expect_same(fast.face_volume, slow.face_volume);
    // A face that hardly any mass reached has lost digits.
    expect_same(fast.velocity * fast.face_mass, slow.velocity * slow.face_mass);
  }

  std::mt19937_64 random_{17};
  testing::RaggedSand sand_ = testing::ragged_sand(GetParam(), random_);
  ActiveRegion region_ = sand_.region();
  testing::SlowTransfer slow_{region_, sand_.openings};
  Particles particles_;
  Eigen::ArrayXd friction_;
  Field faces_;
};

TEST_P(TransferReference, Deposit) { expect_same_deposit(); }

TEST_P(TransferReference, DepositWithGradients) {
  carry_gradients();
  expect_same_deposit();
}

TEST_P(TransferReference, FillForTheDensityCorrection) {
  const Eigen::ArrayXd volumes = minimum_volumes(particles_, materials);
  const DepositedVolume fast =
      deposit_volume(region_, points_by_cell(region_.grid, particles_.positions), particles_, materials);
  expect_same(fast.fill, slow_.fill(particles_, volumes, false));
  expect_same(fast.faces, slow_.deposit(particles_, volumes, friction_).face_volume);
}

TEST_P(TransferReference, Interpolation) {
  const Eigen::Matrix3Xd& x = particles_.positions;
  EXPECT_LT((interpolate(region_, faces_, x) - slow_.interpolate(faces_, x)).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_LT((interpolate_gradient(region_, faces_, x) - slow_.gradient(faces_, x)).cwiseAbs().maxCoeff(),
            1e-12);
}

TEST_P(TransferReference, AdvanceIsItsPartsOneByOne) {
  const Field before = 0.5 * faces_ + testing::random_field(faces_.size(), random_);
  const double dt = 0.05, pic = 0.1;
  for (const Transfer transfer : {Transfer::flip, Transfer::apic}) {
    Particles fast = particles_, slow = particles_;
    const AdvanceReport report = advance(region_, points_by_cell(region_.grid, fast.positions), before,
                                         faces_, {dt, transfer, pic, true}, materials, fast);
    const Eigen::Matrix3Xd on_grid = slow_.interpolate(faces_, slow.positions);
    const Eigen::Matrix3Xd gained = slow_.interpolate(faces_ - before, slow.positions);
    const auto gradients = slow_.gradient(faces_, slow.positions);
    EXPECT_LT((fast.positions - slow.positions - dt * on_grid).cwiseAbs().maxCoeff(), 1e-13);
    EXPECT_NEAR(report.largest_move, dt * on_grid.cwiseAbs().maxCoeff() / region_.grid.spacing, 1e-13);
    const Eigen::Matrix3Xd flip = (1.0 - pic) * (slow.velocities + gained) + pic * on_grid;
    const Eigen::Matrix3Xd& velocities = transfer == Transfer::flip ? flip : on_grid;
    EXPECT_LT((fast.velocities - velocities).cwiseAbs().maxCoeff(), 1e-13);
    EXPECT_EQ(fast.has_gradients(), transfer == Transfer::apic);
    if (fast.has_gradients()) {
      EXPECT_LT((fast.gradients - gradients).cwiseAbs().maxCoeff(), 1e-12);
    }
    const DeformReport deformed = deform(gradients, dt, materials, region_.grid.spacing, slow);
    EXPECT_LT((fast.shapes - slow.shapes).cwiseAbs().maxCoeff(), 1e-13);
    EXPECT_EQ(report.deform.enlarged, deformed.enlarged);
    EXPECT_EQ(report.deform.thickened, deformed.thickened);
  }
}

TEST_P(TransferReference, ThreadsChangeNothing) {
  const auto results = [&](int threads) {
    set_thread_count(threads);
    GridState state = deposit(region_, particles_, materials, friction_);
    Particles moved = particles_;
    advance(region_, points_by_cell(region_.grid, moved.positions), state.velocity, faces_,
            {0.05, Transfer::flip, 0.1, true}, materials, moved);
    set_thread_count(1);
    return std::pair(std::move(state), std::move(moved));
  };
  const auto [state, moved] = results(1);
  const auto [state_of_two, moved_of_two] = results(2);
  EXPECT_TRUE((state.fill == state_of_two.fill).all());
  EXPECT_TRUE((state.friction == state_of_two.friction).all());
  EXPECT_TRUE((state.face_mass == state_of_two.face_mass).all());
  EXPECT_TRUE((state.velocity == state_of_two.velocity).all());
  EXPECT_TRUE(testing::identical(moved, moved_of_two));
}

TEST_P(TransferReference, ParticlesOutsideTheRegionAreRefused) {
  particles_.positions.col(3).setConstant(-1.0);
  EXPECT_THROW(deposit(region_, particles_, materials, friction_), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(Settings, TransferReference,
                         ::testing::Values(testing::Setting{"box", {false, false, false}, {5, 6, 4}},
                                           testing::Setting{"periodic", {true, true, true}, {4, 6, 4}},
                                           testing::Setting{"odd_ring", {true, true, false}, {13, 2, 3}},
                                           testing::Setting{"plane_strain", {false, true, false}, {19, 1, 7}},
                                           testing::Setting{"tower", {false, false, true}, {3, 3, 21}},
                                           testing::Setting{"solids", {false, false, false}, {7, 6, 6}, true},
                                           testing::Setting{"slope", {false, true, false}, {9, 1, 9}, true}),
                         testing::name_of_setting);

}  // namespace
}  // namespace talus
