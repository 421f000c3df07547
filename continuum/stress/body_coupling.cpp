#include "continuum/stress/body_coupling.h"

#include <Eigen/Eigenvalues>

#include "continuum/solids/body_images.h"

namespace talus {
namespace {

/// Below this share of the largest, an eigenvalue of the inverse mass is round-off: the body cannot move that way.
constexpr double smallest_eigenvalue = 1e-12;

using Vector6 = Eigen::Matrix<double, 6, 1>;

Vector6 vector_of(const Twist& twist) {
  Vector6 vector;
  vector << twist.velocity, twist.angular_velocity;
  return vector;
}

Eigen::Vector3d centre_of(const ActiveRegion& region, int cell) {
  const Grid& grid = region.grid;
  const Eigen::Vector3i at = grid.cell_of_index(region.dense_of_cell[static_cast<std::size_t>(cell)]);
  return grid.origin + grid.spacing * (at.cast<double>().array() + 0.5).matrix();
}

/// From bodies' centres of mass to cells, m, over periodic seams where that is nearer.
class Arms {
 public:
  Arms(const ActiveRegion& region, std::span<const Body> bodies)
      : region_(region), bodies_(bodies), middles_(middles(bodies)) {}

  Eigen::Vector3d to(int cell, int body) const {
    const auto b = static_cast<std::size_t>(body);
    return nearest_image(region_.grid, centre_of(region_, cell), middles_[b]) - bodies_[b].pose.position;
  }

 private:
  const ActiveRegion& region_;
  std::span<const Body> bodies_;
  std::vector<Eigen::Vector3d> middles_;
};

}  // namespace

BodyCoupling::BodyCoupling(const ActiveRegion& region, std::span<const Body> bodies)
    : cell_count_(region.cell_count()) {
  int modes = 0;
  std::vector<double> inverse_mass;
  for (const Body& body : bodies) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(talus::inverse_mass(body));
    Modes of{modes, 0, Eigen::Matrix<double, 6, 6>::Zero(), Eigen::Matrix<double, 6, 6>::Zero()};
    const double largest = eigen.eigenvalues().maxCoeff();
    for (int k = 0; k < 6; ++k) {
      const double value = eigen.eigenvalues()[k];
      if (largest > 0.0 && value <= smallest_eigenvalue * largest) continue;
      const double scale = largest > 0.0 ? std::sqrt(value) : 1.0;
      of.to_twist.col(of.count) = scale * eigen.eigenvectors().col(k);
      of.to_speeds.row(of.count) = eigen.eigenvectors().col(k).transpose() / scale;
      ++of.count;
      inverse_mass.push_back(largest > 0.0 ? 1.0 : 0.0);
    }
    modes += of.count;
    bodies_.push_back(of);
  }
  inverse_mass_ = Eigen::Map<const Field>(inverse_mass.data(), modes);
  const Arms arms(region, bodies);
  const auto row_at = [&](int cell, int body, const Eigen::Vector3d& direction) {
    return body < 0 ? BodyRow{} : row(body, arms.to(cell, body), direction);
  };
  for (const Contact& contact : region.contacts) {
    for (int t = 0; t < 2; ++t)
      contact_rows_.push_back(row_at(contact.cell, contact.body, -contact.tangents.col(t)));
    if (contact.body >= 0)
      cells_.push_back({contact.cell, row_at(contact.cell, contact.body, contact.area * contact.normal)});
  }
  for (const Closure& closure : region.closures) {
    closure_rows_.push_back(row_at(closure.cell, closure.body, closure.normal_share * closure.normal));
    closures_.emplace_back(closure.cell, closure.axis);
  }
}

std::vector<BodyImpulse> impulses_on_bodies(const ActiveRegion& region, std::span<const Body> bodies,
                                            const Field& pressure, const StressField& friction) {
  std::vector<BodyImpulse> impulses(bodies.size());
  const Arms arms(region, bodies);
  const auto push = [&](int body, int cell, const Eigen::Vector3d& impulse) {
    if (body < 0) return;
    const auto b = static_cast<std::size_t>(body);
    impulses[b].linear += impulse;
    impulses[b].angular += arms.to(cell, body).cross(impulse);
  };
  Eigen::Index value = 0;
  for (const Contact& contact : region.contacts) {
    push(contact.body, contact.cell, -pressure[contact.cell] * contact.area * contact.normal);
    for (int copy = 0; copy < copies_per_contact; ++copy, value += 2)
      push(contact.body, contact.cell, -(contact.tangents * friction.contact.segment<2>(value).matrix()));
  }
  for (const Closure& closure : region.closures) {
    push(closure.body, closure.cell,
         friction.diagonal(closure.axis, closure.cell) * closure.normal_share * closure.normal);
  }
  return impulses;
}

const BodyCoupling& no_bodies() {
  static const BodyCoupling none;
  return none;
}

BodyRow BodyCoupling::row(int body, const Eigen::Vector3d& arm, const Eigen::Vector3d& direction) const {
  const Modes& modes = bodies_[static_cast<std::size_t>(body)];
  Vector6 wrench;
  wrench << direction, arm.cross(direction);
  BodyRow row{modes.first, modes.count, body, {}};
  for (int k = 0; k < modes.count; ++k)
    row.values[static_cast<std::size_t>(k)] = wrench.dot(modes.to_twist.col(k));
  return row;
}

// Products of fixed size alone: where Eigen's vector instructions begin in one of fewer rows hangs on where the stack lies, and with
// it the last bit.
Field BodyCoupling::speeds(std::span<const Twist> twists) const {
  Field speeds = Field::Zero(inverse_mass_.size());
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Modes& of = bodies_[b];
    const Vector6 all = of.to_speeds * vector_of(twists[b]);
    speeds.segment(of.first, of.count) = all.head(of.count).array();
  }
  return speeds;
}

std::vector<Twist> BodyCoupling::twists(const Field& speeds) const {
  std::vector<Twist> twists;
  for (const Modes& of : bodies_) {
    Vector6 all = Vector6::Zero();
    all.head(of.count) = speeds.segment(of.first, of.count).matrix();
    const Vector6 vector = of.to_twist * all;
    twists.push_back({vector.head<3>(), vector.tail<3>()});
  }
  return twists;
}

void BodyCoupling::add_compression(const Field& speeds, Field& cells) const {
  for (const Cell& cell : cells_) cells[cell.cell] += cell.row.times(speeds);
}

void BodyCoupling::add_pressure(const Field& pressure, double factor, Field& speeds) const {
  Field impulse = Field::Zero(speeds.size());
  for (const Cell& cell : cells_) cell.row.add_to(impulse, factor * pressure[cell.cell]);
  speeds += inverse_mass_ * impulse;
}

void BodyCoupling::add_strain(const Field& speeds, StressField& strain) const {
  for (std::size_t row = 0; row < contact_rows_.size(); ++row) {
    const double slip = contact_rows_[row].times(speeds);
    const auto first = static_cast<Eigen::Index>(values_per_contact * (row / 2) + row % 2);
    for (int copy = 0; copy < copies_per_contact; ++copy) strain.contact[first + 2 * copy] += slip;
  }
  for (std::size_t c = 0; c < closures_.size(); ++c)
    strain.diagonal(closures_[c].second, closures_[c].first) += closure_rows_[c].times(speeds);
}

void BodyCoupling::add_friction(const StressField& stress, Field& speeds) const {
  Field impulse = Field::Zero(speeds.size());
  for (std::size_t row = 0; row < contact_rows_.size(); ++row) {
    const auto first = static_cast<Eigen::Index>(values_per_contact * (row / 2) + row % 2);
    double traction = 0.0;
    for (int copy = 0; copy < copies_per_contact; ++copy) traction += stress.contact[first + 2 * copy];
    contact_rows_[row].add_to(impulse, traction);
  }
  for (std::size_t c = 0; c < closures_.size(); ++c)
    closure_rows_[c].add_to(impulse, stress.diagonal(closures_[c].second, closures_[c].first));
  speeds += inverse_mass_ * impulse;
}

std::vector<double> BodyCoupling::friction_curvature() const {
  std::vector<Eigen::Matrix<double, 6, 6>> squares(bodies_.size(), Eigen::Matrix<double, 6, 6>::Zero());
  for (const BodyRow& row : contact_rows_) {
    if (row.count == 0) continue;
    Vector6 values = Vector6::Zero();
    for (int k = 0; k < row.count; ++k)
      values[k] = std::sqrt(inverse_mass_[row.first + k]) * row.values[static_cast<std::size_t>(k)];
    squares[static_cast<std::size_t>(row.body)] += copies_per_contact * values * values.transpose();
  }
  std::vector<double> largest;
  for (const auto& square : squares) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(square, Eigen::EigenvaluesOnly);
    largest.push_back(std::max(0.0, eigen.eigenvalues().maxCoeff()));
  }
  return largest;
}

Eigen::SparseMatrix<double> BodyCoupling::pressure_modes() const {
  std::vector<Eigen::Triplet<double>> entries;
  for (const Cell& cell : cells_) {
    for (int k = 0; k < cell.row.count; ++k) {
      const int mode = cell.row.first + k;
      entries.emplace_back(cell.cell, mode,
                           std::sqrt(inverse_mass_[mode]) * cell.row.values[static_cast<std::size_t>(k)]);
    }
  }
  Eigen::SparseMatrix<double> modes(cell_count_, inverse_mass_.size());
  modes.setFromTriplets(entries.begin(), entries.end());
  return modes;
}

}  // namespace talus
