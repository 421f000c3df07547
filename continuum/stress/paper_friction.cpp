#include "continuum/stress/paper_friction.h"

#include <array>
#include <map>

#include "continuum/stress/assemble.h"

namespace talus {
namespace {

constexpr int cells_around_inner_edge = 4;
constexpr int cells_beside_wall_edge = 2;
const double box_over_cone = std::sqrt(2.0 / 3.0);  // alpha / mu
// Gershgorin: no face is touched by more than two unknowns of a component, with equal weight.
constexpr double scaled_norm = 2.0;

/// x in the diagonal of each cell, along `direction`.
struct CellComponent {
  Eigen::Vector3d direction;

  void place(const Field& x, StressField& stress) const {
    stress.diagonal.leftCols(x.size()) = (direction * x.matrix().transpose()).array();
  }
  void take(const StressField& strain, Field& x) const {
    x = (direction.transpose() * strain.diagonal.leftCols(x.size()).matrix()).transpose();
  }
  Eigen::SparseMatrix<double> matrix(const ActiveRegion& region) const {
    Eigen::SparseMatrix<double> sum(region.open_faces, region.cell_count());
    for (int axis = 0; axis < 3; ++axis) {
      if (direction[axis] != 0.0) sum += direction[axis] * sparse_diagonal_divergence(region, axis);
    }
    return sum;
  }
};

/// x in the shear of each of some edges.
struct EdgeComponent {
  std::vector<int> edges;

  void place(const Field& x, StressField& stress) const { stress.shear(edges) = x; }
  void take(const StressField& strain, Field& x) const { x = strain.shear(edges); }
  Eigen::SparseMatrix<double> matrix(const ActiveRegion& region) const {
    std::vector<Eigen::Triplet<double>> chosen;
    for (std::size_t i = 0; i < edges.size(); ++i) chosen.emplace_back(edges[i], static_cast<int>(i), 1.0);
    Eigen::SparseMatrix<double> choice(region.edge_count(), static_cast<Eigen::Index>(edges.size()));
    choice.setFromTriplets(chosen.begin(), chosen.end());
    return sparse_shear_divergence(region) * choice;
  }
};

/// x in all tractions of all contacts.
struct ContactComponent {
  void place(const Field& x, StressField& stress) const { stress.contact = x; }
  void take(const StressField& strain, Field& x) const { x = strain.contact; }
  Eigen::SparseMatrix<double> matrix(const ActiveRegion& region) const {
    return sparse_contact_divergence(region);
  }
};

/// What a variable may be, and how much its face velocities resist it; one that moves no face is held at zero.
struct Variables {
  Field lower, upper, curvature;

  Variables(const Field& low, const Field& high, const Field& sum)
      : lower((sum > 0.0).select(low, 0.0)),
        upper((sum > 0.0).select(high, 0.0)),
        curvature((sum > 0.0).select(sum, 1.0)) {}
};

/// Pairs of faces that a variable pushes apart: nothing where they are one and the same (a periodic axis one cell long).
double pair_curvature(const Field& inverse_mass, int a, int b) {
  return a == b ? 0.0 : inverse_mass[a] + inverse_mass[b];
}

Field cell_curvature(const ActiveRegion& region, const Field& inverse_mass, int axis) {
  Field sum(region.cell_count());
  for (int c = 0; c < region.cell_count(); ++c) {
    const auto& face = region.cell_faces[static_cast<std::size_t>(c)];
    const auto lower = static_cast<std::size_t>(2 * axis);
    sum[c] = pair_curvature(inverse_mass, face[lower], face[lower + 1]);
  }
  // A closure acts on all faces of its cell, each with a weight of at most 1.
  for (const Closure& closure : region.closures) {
    if (closure.axis != axis) continue;
    sum[closure.cell] = 0.0;
    for (std::size_t k = 0; k < closure.faces.size(); ++k)
      sum[closure.cell] += 2.0 * std::abs(closure.weight[k]) * inverse_mass[closure.faces[k]];
  }
  return sum;
}

Field edge_curvature(const ActiveRegion& region, const Field& inverse_mass, const std::vector<int>& edges) {
  Field sum(static_cast<Eigen::Index>(edges.size()));
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto& face = region.edge_faces[static_cast<std::size_t>(edges[i])];
    sum[static_cast<Eigen::Index>(i)] =
        pair_curvature(inverse_mass, face[0], face[1]) + pair_curvature(inverse_mass, face[2], face[3]);
  }
  return sum;
}

/// So that scaled_norm holds: a face carries at most four contact copies, two of either cell beside it, each with two
/// tangents; 4 sqrt 2 / 3 < 2.
Field contact_curvature(const ActiveRegion& region, const Field& inverse_mass) {
  Field sum(values_per_contact * static_cast<Eigen::Index>(region.contacts.size()));
  Eigen::Index value = 0;
  for (const Contact& contact : region.contacts) {
    for (const auto& faces : contact.faces) {
      const Eigen::Vector3d mobility(inverse_mass[faces[0]], inverse_mass[faces[1]], inverse_mass[faces[2]]);
      sum.segment<2>(value) = 3.0 * (contact.tangents.cwiseAbs().transpose() * mobility).array();
      value += 2;
    }
  }
  return sum;
}

/// The problem of one component as a value; x is its warm start, b what minimise() has.
template <class Component>
BoundQp problem_of(const char* name, const ActiveRegion& region, const Field& inverse_mass,
                   const Component& component, const Variables& variables, const Field& b,
                   const BoundQpSettings& settings, const Field& x) {
  return {name,
          normal_matrix(component.matrix(region), inverse_mass.head(region.open_faces)),
          b,
          variables.lower,
          variables.upper,
          x,
          scaled_norm,
          settings};
}

/// Position of a cell along an axis, and a number that all cells of its column share.
struct PlaceInColumn {
  int height;
  std::array<int, 2> column;
};
PlaceInColumn place_in_column(const ActiveRegion& region, int cell, int up) {
  const auto i = region.grid.cell_of_index(region.dense_of_cell[static_cast<std::size_t>(cell)]);
  return {i[up], {i[next_axis(up)], i[last_axis(up)]}};
}

}  // namespace

FrictionBox friction_box(const ActiveRegion& region, const Field& cell_friction, const Field& pressure) {
  FrictionBox box{box_over_cone * cell_friction * pressure, Field::Zero(region.edge_count() + 1),
                  Field(values_per_contact * static_cast<Eigen::Index>(region.contacts.size()))};
  const auto wall_friction = [&](double friction, int cell) {
    return friction < 0.0 ? cell_friction[cell] : friction;
  };
  for (int e = 0; e < region.edge_count(); ++e) {
    for (const int copy : region.edge_copies[static_cast<std::size_t>(e)]) {
      if (copy < 0) continue;
      if (e < region.inner_edges) {
        box.edge[e] += box.cell[copy / copies_per_cell] / cells_around_inner_edge;
      } else {
        const WallFace& wall = region.wall_faces[static_cast<std::size_t>(copy / copies_per_wall_face)];
        box.edge[e] += wall_friction(wall.friction, wall.cell) * pressure[wall.cell] / cells_beside_wall_edge;
      }
    }
  }
  for (std::size_t c = 0; c < region.contacts.size(); ++c) {
    const Contact& contact = region.contacts[c];
    box.contact.segment<values_per_contact>(values_per_contact * static_cast<Eigen::Index>(c)) =
        wall_friction(contact.friction, contact.cell) * contact.area * pressure[contact.cell] /
        copies_per_contact;
  }
  return box;
}

int up_axis(const Eigen::Vector3d& gravity) {
  int up = 2;
  for (int axis = 0; axis < 2; ++axis) {
    if (std::abs(gravity[axis]) > std::abs(gravity[up])) up = axis;
  }
  return up;
}

PaperFriction::PaperFriction(const ActiveRegion& region, const Field& inverse_mass, int up,
                             ProblemRecorder record)
    : region_(region),
      inverse_mass_(inverse_mass),
      up_(up),
      record_(std::move(record)),
      columns_(make_columns()) {}

StressField PaperFriction::strain(const Field& flux) const {
  StressField strain = make_stress_field(region_);
  stress_divergence_transpose(region_, flux, strain);
  if (of_bodies_) {
    strain.diagonal += of_bodies_->diagonal;
    strain.contact += of_bodies_->contact;
  }
  return strain;
}

template <class Component, class Variables>
BoundQpResult PaperFriction::minimise(const char* name, const Component& component,
                                      const Variables& variables, const Field& rest,
                                      const BoundQpSettings& settings, Field& x) const {
  if (x.size() == 0) return {0, 0.0, true};
  StressField stress = make_stress_field(region_), strained = make_stress_field(region_);
  Field faces(region_.open_faces + 1);
  const auto apply = [&](const Field& in, Field& out) {
    component.place(in, stress);
    faces.setZero();
    add_stress_divergence(region_, stress, faces);
    faces *= inverse_mass_;
    stress_divergence_transpose(region_, faces, strained);
    component.take(strained, out);
  };
  Field b(x.size());
  component.take(strain(rest), b);
  if (record_) record_(problem_of(name, region_, inverse_mass_, component, variables, b, settings, x));
  return minimise_bound_qp(apply, b, variables.lower, variables.upper, variables.curvature, scaled_norm,
                           settings, x);
}

PaperFriction::Result PaperFriction::solve(const Field& frictionless, const FrictionBox& box,
                                           const BoundQpSettings& settings, StressField& stress) const {
  Result total;
  const auto count = [&](const BoundQpResult& component) {
    total.iterations += component.iterations;
    total.unconverged += !component.converged;
    total.residual = std::max(total.residual, component.residual);
  };
  count(solve_columns(frictionless, box, settings, stress));
  count(solve_pair(frictionless, box, settings, stress));
  for (const int axis : {next_axis(up_), last_axis(up_), up_})
    count(solve_shear(axis, frictionless, box, settings, stress));
  count(solve_contacts(frictionless, box, settings, stress));
  return total;
}

BoundQpResult PaperFriction::solve_columns(const Field& frictionless, const FrictionBox& box,
                                           const BoundQpSettings& settings, StressField& stress) const {
  if (columns_.empty()) return solve_up(frictionless, box, settings, stress);
  const Eigen::Index n = region_.cell_count();
  Field vertical = stress.diagonal.row(up_).transpose();
  stress.diagonal.row(up_).setZero();
  const StressField strained = strain(flux(frictionless, stress));

  if (record_) {
    const Variables all(-box.cell.head(n), box.cell.head(n), cell_curvature(region_, inverse_mass_, up_));
    record_(problem_of("stress_up", region_, inverse_mass_, CellComponent{Eigen::Vector3d::Unit(up_)}, all,
                       strained.diagonal.row(up_).head(n).transpose(), settings, vertical.head(n)));
  }
  BoundQpResult result{0, 0.0, true};
  for (const Column& column : columns_) {
    const auto size = static_cast<Eigen::Index>(column.cells.size());
    const auto apply = [&](const Field& x, Field& product) {
      product = column.diagonal * x;
      product.tail(size - 1) += column.below.tail(size - 1) * x.head(size - 1);
      product.head(size - 1) += column.above.head(size - 1) * x.tail(size - 1);
    };
    const Field radius = box.cell(column.cells);
    const Variables variables(-radius, radius, column.diagonal);
    const Field b = strained.diagonal.row(up_).transpose()(column.cells);
    Field x = vertical(column.cells);
    const auto solved = minimise_bound_qp(apply, b, variables.lower, variables.upper, variables.curvature,
                                          scaled_norm, settings, x);
    vertical(column.cells) = x;
    result.iterations = std::max(result.iterations, solved.iterations);
    result.residual = std::max(result.residual, solved.residual);
    result.converged = result.converged && solved.converged;
  }
  stress.diagonal.row(up_).head(n) = vertical.head(n).transpose();
  return result;
}

BoundQpResult PaperFriction::solve_up(const Field& frictionless, const FrictionBox& box,
                                      const BoundQpSettings& settings, StressField& stress) const {
  const Eigen::Index n = region_.cell_count();
  Field x = stress.diagonal.row(up_).head(n).transpose();
  stress.diagonal.row(up_).setZero();
  const Variables variables(-box.cell.head(n), box.cell.head(n), cell_curvature(region_, inverse_mass_, up_));
  const auto result = minimise("stress_up", CellComponent{Eigen::Vector3d::Unit(up_)}, variables,
                               flux(frictionless, stress), settings, x);
  stress.diagonal.row(up_).head(n) = x.transpose();
  return result;
}

BoundQpResult PaperFriction::solve_pair(const Field& frictionless, const FrictionBox& box,
                                        const BoundQpSettings& settings, StressField& stress) const {
  const int next = next_axis(up_), last = last_axis(up_);
  const Eigen::Index n = region_.cell_count();
  const Field vertical = stress.diagonal.row(up_).head(n).transpose(), radius = box.cell.head(n);
  // Both bounds at once: |x| <= alpha P and |-S_up,up - x| <= alpha P.
  const Variables variables(
      (-radius).max(-vertical - radius), radius.min(radius - vertical),
      cell_curvature(region_, inverse_mass_, next) + cell_curvature(region_, inverse_mass_, last));
  Field x = stress.diagonal.row(last).head(n).transpose();
  stress.diagonal.row(last).setZero();
  stress.diagonal.row(next).head(n) = -vertical.transpose();
  const CellComponent pair{Eigen::Vector3d::Unit(last) - Eigen::Vector3d::Unit(next)};
  const auto result = minimise("stress_pair", pair, variables, flux(frictionless, stress), settings, x);
  stress.diagonal.row(last).head(n) = x.transpose();
  stress.diagonal.row(next).head(n) = -(vertical + x).transpose();
  return result;
}

BoundQpResult PaperFriction::solve_shear(int axis, const Field& frictionless, const FrictionBox& box,
                                         const BoundQpSettings& settings, StressField& stress) const {
  EdgeComponent component;
  for (int e = 0; e < region_.edge_count(); ++e) {
    if (region_.edge_axis[static_cast<std::size_t>(e)] == axis) component.edges.push_back(e);
  }
  Field x = stress.shear(component.edges);
  stress.shear(component.edges).setZero();
  const Field radius = box.edge(component.edges);
  const Variables variables(-radius, radius, edge_curvature(region_, inverse_mass_, component.edges));
  const auto result = minimise("stress_shear", component, variables, flux(frictionless, stress), settings, x);
  component.place(x, stress);
  return result;
}

BoundQpResult PaperFriction::solve_contacts(const Field& frictionless, const FrictionBox& box,
                                            const BoundQpSettings& settings, StressField& stress) const {
  Field x = stress.contact;
  stress.contact.setZero();
  const Variables variables(-box.contact, box.contact, contact_curvature(region_, inverse_mass_));
  const auto result =
      minimise("contact", ContactComponent{}, variables, flux(frictionless, stress), settings, x);
  stress.contact = x;
  return result;
}

Field PaperFriction::flux(const Field& frictionless, const StressField& stress) const {
  Field impulse = Field::Zero(region_.open_faces + 1);
  add_stress_divergence(region_, stress, impulse);
  return frictionless + inverse_mass_ * impulse;
}

std::vector<PaperFriction::Column> PaperFriction::make_columns() const {
  if (region_.grid.periodic[static_cast<std::size_t>(up_)]) return {};
  // Where a solid closes a face along up, the cell's stress acts on its lateral faces too, and couples columns.
  for (const Closure& closure : region_.closures) {
    if (closure.axis == up_) return {};
  }
  // A cell couples to the one below and the one above it: three unit fields, of every third layer each, show every entry
  // of the matrix.
  constexpr int layers = 3;
  const Eigen::Index n = region_.cell_count();
  std::array<Field, layers> product;
  StressField stress = make_stress_field(region_), strain = make_stress_field(region_);
  for (int layer = 0; layer < layers; ++layer) {
    for (int c = 0; c < region_.cell_count(); ++c)
      stress.diagonal(up_, c) = place_in_column(region_, c, up_).height % layers == layer;
    stress_divergence_transpose(region_, flux(Field::Zero(region_.open_faces + 1), stress), strain);
    product[static_cast<std::size_t>(layer)] = strain.diagonal.row(up_).head(n).transpose();
  }
  std::map<std::array<int, 2>, std::vector<int>> cells_of_column;  // ascending in height, as cells are
  for (int c = 0; c < region_.cell_count(); ++c)
    cells_of_column[place_in_column(region_, c, up_).column].push_back(c);

  std::vector<Column> columns;
  for (auto& [place, cells] : cells_of_column) {
    const auto size = static_cast<Eigen::Index>(cells.size());
    Column column{std::move(cells), Eigen::ArrayXd(size), Eigen::ArrayXd(size), Eigen::ArrayXd(size)};
    for (Eigen::Index i = 0; i < size; ++i) {
      const int c = column.cells[static_cast<std::size_t>(i)];
      const int height = place_in_column(region_, c, up_).height;
      const auto entry = [&](int offset) {
        return product[static_cast<std::size_t>((height + offset + layers) % layers)][c];
      };
      column.below[i] = entry(-1);
      column.diagonal[i] = entry(0);
      column.above[i] = entry(1);
    }
    columns.push_back(std::move(column));
  }
  return columns;
}

}  // namespace talus
