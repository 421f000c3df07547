// Coarse graining against lattices, piles and shear whose fields are known.
#include "analysis/coarse_graining/coarse_graining.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

namespace talus::analysis {
namespace {

constexpr double grain_density = 2500.0;  // kg/m^3
constexpr double h = 0.01;                // m
const CoarseGrid box{.origin = {0.1, -0.2, 0.0},
                     .spacing = {h, h, h},
                     .cells = {6, 5, 8},
                     .edges = {Edge::periodic, Edge::wall, Edge::wall}};
const std::vector<Kernel> kernels{Hat{}, Gaussian{0.8 * h}};

Eigen::Vector3d extent(const CoarseGrid& grid) { return grid.spacing.array() * grid.cells.cast<double>(); }

Snapshot random_grains(int count, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Snapshot grains{0.0, Vectors(3, count), Vectors(3, count), Eigen::VectorXd(count)};
  for (int grain = 0; grain < count; ++grain) {
    const Eigen::Vector3d share(uniform(generator), uniform(generator), uniform(generator));
    grains.positions.col(grain) = box.origin + share.cwiseProduct(extent(box));
    grains.velocities.col(grain) << uniform(generator), uniform(generator) - 2.0, uniform(generator);
    grains.volumes[grain] = 1e-8 * (1.0 + uniform(generator));
  }
  return grains;
}

/// Grains on a simple cubic lattice, `per_cell` along each axis of every cell, filling the grid; each fills half its cube.
Snapshot lattice(const CoarseGrid& grid, int per_cell,
                 const std::function<Eigen::Vector3d(Eigen::Vector3d)>& velocity) {
  const Eigen::Array3i sites = per_cell * grid.cells;
  const Eigen::Vector3d step = grid.spacing / per_cell;
  Snapshot grains{0.0, Vectors(3, sites.prod()), Vectors(3, sites.prod()),
                  Eigen::VectorXd::Constant(sites.prod(), 0.5 * step.prod())};
  for (int grain = 0; grain < sites.prod(); ++grain) {
    const Eigen::Array3d site(grain % sites.x(), grain / sites.x() % sites.y(),
                              grain / (sites.x() * sites.y()));
    grains.positions.col(grain) = grid.origin.array() + (site + 0.5) * step.array();
    grains.velocities.col(grain) = velocity(grains.positions.col(grain));
  }
  return grains;
}

Eigen::Vector3d at_rest(const Eigen::Vector3d&) { return Eigen::Vector3d::Zero(); }

Eigen::Matrix3d sum_of(const CoarseFields::Tensors& tensors) {
  const Eigen::Matrix<double, 9, 1> sum = tensors.rowwise().sum();
  return Eigen::Map<const Eigen::Matrix3d>(sum.data());
}

TEST(CoarseGraining, VolumeMassAndMomentumAreConserved) {
  const Snapshot grains = random_grains(500, 1);
  const Eigen::Vector3d momentum = grain_density * grains.velocities * grains.volumes;
  for (const Kernel& kernel : kernels) {
    const auto fields = coarse_grain(grains, grain_density, {}, box, kernel);
    const double volume = fields.volume_fraction.sum() * box.cell_volume();
    EXPECT_NEAR(volume / grains.volumes.sum(), 1.0, 1e-13);
    EXPECT_NEAR(fields.density.sum() * box.cell_volume() / grains.volumes.sum(), grain_density, 1e-9);
    EXPECT_TRUE((fields.momentum_density.rowwise().sum() * box.cell_volume()).isApprox(momentum, 1e-12));
  }
}

TEST(CoarseGraining, ALatticeIsUniformUpToTheWalls) {
  for (const int per_cell : {1, 2, 3}) {
    const Snapshot grains = lattice(box, per_cell, at_rest);
    const auto hat = coarse_grain(grains, grain_density, {}, box, Hat{}).volume_fraction;
    EXPECT_TRUE(hat.isApproxToConstant(0.5, 1e-12)) << per_cell;
    const auto gaussian = coarse_grain(grains, grain_density, {}, box, Gaussian{0.8 * h}).volume_fraction;
    EXPECT_TRUE(gaussian.isApproxToConstant(0.5, 1e-3)) << per_cell << ' ' << gaussian.minCoeff();
  }
}

TEST(CoarseGraining, ShearIsLinearUpToTheWalls) {
  constexpr double rate = 3.0;  // 1/s
  const auto shear = [](const Eigen::Vector3d& at) { return Eigen::Vector3d(rate * at.z(), 0.0, 0.0); };
  const auto fields = coarse_grain(lattice(box, 20, shear), grain_density, {}, box, Hat{});
  for (int k = 0; k < box.cells.z(); ++k) {
    // In the wall's cell the hat's centre of mass is at 13/24 of a cell, of which 1/24 is the fold's.
    double z = (k + 0.5) * h;
    if (k == 0) z += h / 24.0;
    if (k == box.cells.z() - 1) z -= h / 24.0;
    const Eigen::Index cell = box.index(2, 1, k);
    EXPECT_NEAR(fields.velocity(0, cell), rate * z, 2e-3 * rate * h) << k;
    EXPECT_NEAR(fields.velocity(2, cell), 0.0, 1e-12);
  }
  // Within a hat the height varies by h^2/6 about the centre: that much kinetic stress is the gradient's.
  const double kinetic = -fields.density[0] * rate * rate * h * h / 6.0;
  EXPECT_NEAR(fields.stress(box.index(2, 1, 4))(0, 0), kinetic, 0.01 * std::abs(kinetic));
}

TEST(CoarseGraining, KineticStressIsThatOfTheFluctuations) {
  // By turns +c and -c along x, on top of a common velocity.
  constexpr double c = 0.2;
  const Eigen::Vector3d common(3.0, -1.0, 0.5);
  Snapshot grains = lattice(box, 2, [&](const Eigen::Vector3d&) { return common; });
  for (Eigen::Index grain = 0; grain < grains.volumes.size(); ++grain) {
    grains.velocities(0, grain) += grain % 2 == 0 ? c : -c;
  }
  const auto fields = coarse_grain(grains, grain_density, {}, box, Hat{});
  for (Eigen::Index cell = 0; cell < box.count(); ++cell) {
    EXPECT_TRUE(fields.velocity.col(cell).isApprox(common, 1e-12));
    Eigen::Matrix3d expected = Eigen::Matrix3d::Zero();
    expected(0, 0) = -0.5 * grain_density * c * c;
    EXPECT_TRUE((fields.stress(cell) - expected).isZero(1e-9));
  }
}

/// A square array of stacks of spheres on the floor, each carrying what is above it.
struct Pile {
  Snapshot grains;
  std::vector<GrainContact> contacts;
};

constexpr double diameter = 0.5 * h;
constexpr double gravity = 9.81;

Pile pile(int layers) {
  const double volume = std::numbers::pi / 6.0 * std::pow(diameter, 3);
  const double weight = grain_density * volume * gravity;
  const int columns = 2 * box.cells.x() * 2 * box.cells.y();
  Pile result{{0.0, Vectors(3, columns * layers), Vectors::Zero(3, columns * layers),
               Eigen::VectorXd::Constant(columns * layers, volume)},
              {}};
  for (int grain = 0; grain < columns * layers; ++grain) {
    const int column = grain / layers, layer = grain % layers;
    const Eigen::Array3d site(column % (2 * box.cells.x()), column / (2 * box.cells.x()), layer);
    const Eigen::Vector3d centre = box.origin.array() + (site + 0.5) * diameter;
    result.grains.positions.col(grain) = centre;
    const double below =
        layer == 0 ? 0.5 * diameter : diameter;  // the floor is touched, the next grain's centre is farther
    result.contacts.push_back({centre, centre - below * Eigen::Vector3d::UnitZ(),
                               (layers - layer) * weight * Eigen::Vector3d::UnitZ()});
  }
  return result;
}

TEST(CoarseGraining, APileCarriesTheWeightAbove) {
  constexpr int layers = 12;
  constexpr double height = layers * diameter;
  const Pile spheres = pile(layers);
  const double bulk_weight =
      grain_density * std::numbers::pi / 6.0 * gravity;  // N/m^3, as each sphere fills its cube
  for (const Kernel& kernel : kernels) {
    const auto fields = coarse_grain(spheres.grains, grain_density, spheres.contacts, box, kernel);
    const bool is_hat = std::holds_alternative<Hat>(kernel);
    for (int k = 0; (k + 2.5) * h < height; ++k) {
      const Eigen::Matrix3d stress = fields.stress(box.index(3, 2, k));
      const double expected = -bulk_weight * (height - (k + 0.5) * h);
      // The floor's own cell is read a little farther in: h/24 by the hat, 0.4 w by the Gaussian.
      const double tolerance = k == 0 ? (is_hat ? 0.05 : 0.4) * h : (is_hat ? 1e-6 : 0.1) * h;
      EXPECT_NEAR(stress(2, 2), expected, tolerance * bulk_weight) << k << " of kernel " << kernel.index();
      EXPECT_NEAR(stress(0, 0), 0.0, 1e-9);
      EXPECT_NEAR(stress(0, 2), 0.0, 1e-9);
    }
  }
}

TEST(CoarseGraining, TheFloorsForceIsPartOfTheStress) {
  Pile spheres = pile(12);
  const double with =
      coarse_grain(spheres.grains, grain_density, spheres.contacts, box, Hat{}).stress(0)(2, 2);
  std::erase_if(spheres.contacts, [](const GrainContact& contact) { return contact.other.z() <= 0.0; });
  const double without =
      coarse_grain(spheres.grains, grain_density, spheres.contacts, box, Hat{}).stress(0)(2, 2);
  EXPECT_LT(std::abs(without), 0.8 * std::abs(with));
}

TEST(CoarseGraining, ContactMomentsAreConserved) {
  std::mt19937 generator(7);
  std::normal_distribution<double> normal(0.0, 1.0);
  const Snapshot grains = random_grains(200, 2);
  std::vector<GrainContact> contacts;
  Eigen::Matrix3d expected = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector3d branch =
        0.6 * h * Eigen::Vector3d(normal(generator), normal(generator), normal(generator)).normalized();
    const Eigen::Vector3d force(normal(generator), normal(generator), normal(generator));
    contacts.push_back({grains.positions.col(k), grains.positions.col(k) - branch, force});
    expected -= force * branch.transpose();
  }
  for (const Kernel& kernel : kernels) {
    const auto fields = coarse_grain(grains, grain_density, contacts, box, kernel);
    EXPECT_TRUE((sum_of(fields.contact_stress) * box.cell_volume()).isApprox(expected, 1e-11));
  }
}

/// Weight of the cell whose centre is `away` cells off, from the definition; the sum over all cells is 1.
double reference_weight(double away, const Kernel& kernel) {
  const auto raw = [&](double distance) {
    if (std::holds_alternative<Hat>(kernel)) return std::max(0.0, 1.0 - std::abs(distance));
    return std::abs(distance) > 3.2 ? 0.0 : std::exp(-0.5 * distance * distance / 0.64);
  };
  double sum = 0.0;
  for (int cell = -8; cell <= 8; ++cell) sum += raw(away + cell);
  return raw(away) / sum;
}

/// The kernel's integral along a branch well inside the grid, by a sum of many points.
double brute_force(const Eigen::Vector3d& at, const GrainContact& contact, const Kernel& kernel) {
  constexpr int points = 5000;
  double sum = 0.0;
  for (int k = 0; k < points; ++k) {
    const Eigen::Vector3d away =
        (contact.centre + (k + 0.5) / points * (contact.other - contact.centre) - at) / h;
    sum += reference_weight(away.x(), kernel) * reference_weight(away.y(), kernel) *
           reference_weight(away.z(), kernel);
  }
  return sum / points / (h * h * h);
}

TEST(CoarseGraining, IntegralAlongTheBranch) {
  CoarseGrid wide = box;
  wide.origin.setZero();
  wide.cells << 16, 16, 16;
  const Snapshot none{0.0, Vectors(3, 0), Vectors(3, 0), Eigen::VectorXd(0)};
  const Eigen::Vector3d branch = h * Eigen::Vector3d(0.7, -0.5, 0.4);
  const GrainContact contact{Eigen::Vector3d(7.63, 8.21, 8.07) * h,
                             Eigen::Vector3d(7.63, 8.21, 8.07) * h - branch, Eigen::Vector3d(1.0, 0.0, 0.0)};
  for (const Kernel& kernel : kernels) {
    const auto fields = coarse_grain(none, grain_density, {{contact}}, wide, kernel);
    double largest = 0.0, worst = 0.0;
    for (int i = 6; i < 10; ++i) {
      for (int j = 6; j < 11; ++j) {
        const Eigen::Vector3d centre = h * Eigen::Vector3d(i + 0.5, j + 0.5, 8.5);
        const double expected = -branch.x() * brute_force(centre, contact, kernel);
        largest = std::max(largest, std::abs(expected));
        worst = std::max(worst, std::abs(fields.stress(wide.index(i, j, 8))(0, 0) - expected));
      }
    }
    EXPECT_LT(worst, (std::holds_alternative<Hat>(kernel) ? 1e-7 : 2e-5) * largest) << kernel.index();
    EXPECT_TRUE(std::isnan(fields.velocity(0, 0)));
  }
}

TEST(CoarseGraining, PeriodicAxesWrap) {
  Snapshot grains = random_grains(100, 3);
  const GrainContact across{box.origin + Eigen::Vector3d(0.2, 2.3, 3.0) * h,
                            box.origin + Eigen::Vector3d(5.9, 2.3, 3.0) * h, Eigen::Vector3d(1.0, 0.5, 0.0)};
  GrainContact inside = across;  // the same, two cells farther on
  inside.centre.x() += 2.0 * h;
  inside.other.x() += -4.0 * h;
  for (const Kernel& kernel : kernels) {
    const auto before = coarse_grain(grains, grain_density, {{across}}, box, kernel);
    Snapshot moved = grains;
    moved.positions.row(0).array() += (2 + 3 * 6) * h;  // whole turns do not matter
    const auto after = coarse_grain(moved, grain_density, {{inside}}, box, kernel);
    for (int k = 0; k < box.cells.z(); ++k) {
      for (int i = 0; i < box.cells.x(); ++i) {
        const auto from = box.index(i, 2, k), to = box.index((i + 2) % 6, 2, k);
        EXPECT_NEAR(after.volume_fraction[to], before.volume_fraction[from], 1e-12);
        EXPECT_TRUE((after.stress(to) - before.stress(from)).isZero(1e-7)) << i << ' ' << k;
      }
    }
    // The branch of 0.3 cells goes the short way round: there is none of it in the middle.
    EXPECT_TRUE(
        (sum_of(before.contact_stress) * box.cell_volume()).col(0).isApprox(-0.3 * h * across.force, 1e-9));
    if (std::holds_alternative<Hat>(kernel)) {
      EXPECT_TRUE(before.contact_stress.col(box.index(3, 2, 2)).isZero());
    }
  }
}

TEST(CoarseGraining, WhatCannotBeCoarseGrained) {
  const Snapshot grains = random_grains(10, 4);
  Snapshot outside = grains;
  outside.positions(2, 3) = -0.001;
  EXPECT_THROW(coarse_grain(outside, grain_density, {}, box, Hat{}), SnapshotError);
  outside = grains;
  outside.positions(0, 3) = 7.0;  // periodic there
  EXPECT_NO_THROW(coarse_grain(outside, grain_density, {}, box, Hat{}));
  EXPECT_THROW(coarse_grain(grains, 0.0, {}, box, Hat{}), std::invalid_argument);
  EXPECT_THROW(coarse_grain(grains, grain_density, {}, box, Gaussian{0.4 * h}), std::invalid_argument);
  const GrainContact broken{Eigen::Vector3d::Zero(), Eigen::Vector3d(0.0, NAN, 0.0), Eigen::Vector3d::Zero()};
  EXPECT_THROW(coarse_grain(grains, grain_density, {{broken}}, box, Hat{}), SnapshotError);
  CoarseGrid no_cells = box;
  no_cells.cells.y() = 0;
  EXPECT_THROW(coarse_grain(grains, grain_density, {}, no_cells, Hat{}), std::invalid_argument);
}

}  // namespace
}  // namespace talus::analysis
