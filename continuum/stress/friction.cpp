#include "continuum/stress/friction.h"

#include <numbers>

namespace talus {
namespace {

constexpr double inverse_sqrt2 = 1.0 / std::numbers::sqrt2;
const double inverse_sqrt6 = 1.0 / std::sqrt(6.0);
// An inner edge shares its stress equally over the four cells around it, an empty one counting as
// stress-free; a wall edge over the two wall faces beside it. A cell's diagonal stress is the mean of its
// four copies.
constexpr double cell_share = 1.0 / copies_per_cell;
constexpr double inner_edge_share = 1.0 / 4.0;
constexpr double wall_edge_share = 1.0 / 2.0;

}  // namespace

Field confining_pressure(const ActiveRegion& region, const Field& fill, const Field& pressure,
                         const Field& velocity, double loosening, const BodyCoupling& bodies,
                         const Field& speeds) {
  Field confining = pressure.max(0.0), compression(region.cell_count() + 1);
  gradient_transpose(region, velocity, compression);  // - h div v
  bodies.add_compression(speeds, compression);
  for (int cell = 0; cell < region.cell_count(); ++cell) {
    if (fill[cell] >= packed_fill || -compression[cell] > loosening) continue;
    double sum = 0.0;
    int pressed = 0;
    for (const int face : region.cell_faces[static_cast<std::size_t>(cell)]) {
      if (face == region.null_face()) continue;
      for (const int other : region.face_cells[static_cast<std::size_t>(face)]) {
        if (other == cell || fill[other] < packed_fill || pressure[other] <= 0.0) continue;
        sum += pressure[other];
        ++pressed;
      }
    }
    if (pressed > 0) confining[cell] = std::max(pressure[cell], skin_share * sum / pressed);
  }
  return confining;
}

FrictionOperator::FrictionOperator(const ActiveRegion& region)
    : region_(region), stress_(make_stress_field(region)) {
  edge_of_shear_.reserve(static_cast<std::size_t>(3 * copies_per_cell * region.cell_count()));
  for (std::size_t cell = 0; cell < region.dense_of_cell.size(); ++cell) {
    for (int copy = 0; copy < copies_per_cell; ++copy) {
      const auto corner = copy_corner(region.cell_parity[cell], copy);
      for (int axis = 0; axis < 3; ++axis) {
        const int edge = local_edge(axis, corner[static_cast<std::size_t>(next_axis(axis))],
                                    corner[static_cast<std::size_t>(last_axis(axis))]);
        edge_of_shear_.push_back(region.cell_edges[cell][static_cast<std::size_t>(edge)]);
      }
    }
  }
}

template <class Function>
void FrictionOperator::for_each_shear(Function&& f) const {
  const int copies = copies_per_cell * region_.cell_count();
  for (int copy = 0; copy < copies; ++copy) {
    for (int axis = 0; axis < 3; ++axis) {
      f(components_per_copy * copy + 2 + axis, edge_of_shear_[static_cast<std::size_t>(3 * copy + axis)]);
    }
  }
}

template <class Function>
void FrictionOperator::for_each_traction(Function&& f) const {
  Eigen::Index value = wall_offset();
  for (const WallFace& wall : region_.wall_faces) {
    for (std::size_t copy = 0; copy < copies_per_wall_face; ++copy) {
      f(value++, wall.edges[0][copy]);
      f(value++, wall.edges[1][copy]);
    }
  }
}

void FrictionOperator::stress_of(const Eigen::ArrayXd& copies, StressField& stress) const {
  for (int cell = 0; cell < region_.cell_count(); ++cell) {
    double a = 0.0, b = 0.0;
    for (int copy = 0; copy < copies_per_cell; ++copy) {
      const Eigen::Index first = components_per_copy * (copies_per_cell * cell + copy);
      a += copies[first];
      b += copies[first + 1];
    }
    a *= cell_share * inverse_sqrt2;
    b *= cell_share * inverse_sqrt6;
    stress.diagonal.col(cell) << a - b, 2.0 * b, -a - b;
  }
  stress.shear.setZero();
  for_each_shear([&](Eigen::Index value, int edge) {
    stress.shear[edge] += inner_edge_share * inverse_sqrt2 * copies[value];
  });
  for_each_traction(
      [&](Eigen::Index value, int edge) { stress.shear[edge] += wall_edge_share * copies[value]; });
  stress.shear[region_.null_edge()] = 0.0;
  stress.contact = copies.tail(stress.contact.size());
}

void FrictionOperator::apply(const Eigen::ArrayXd& copies, Field& impulse) const {
  stress_of(copies, stress_);
  impulse.setZero();
  add_stress_divergence(region_, stress_, impulse);
}

void FrictionOperator::apply_transpose(const Field& velocity, Eigen::ArrayXd& strain) const {
  stress_divergence_transpose(region_, velocity, stress_);
  for (int cell = 0; cell < region_.cell_count(); ++cell) {
    const auto e = stress_.diagonal.col(cell);
    const double a = cell_share * inverse_sqrt2 * (e[0] - e[2]);
    const double b = cell_share * inverse_sqrt6 * (2.0 * e[1] - e[0] - e[2]);
    for (int copy = 0; copy < copies_per_cell; ++copy) {
      const Eigen::Index first = components_per_copy * (copies_per_cell * cell + copy);
      strain[first] = a;
      strain[first + 1] = b;
    }
  }
  for_each_shear([&](Eigen::Index value, int edge) {
    strain[value] = inner_edge_share * inverse_sqrt2 * stress_.shear[edge];
  });
  for_each_traction(
      [&](Eigen::Index value, int edge) { strain[value] = wall_edge_share * stress_.shear[edge]; });
  strain.tail(stress_.contact.size()) = stress_.contact;
}

BallBlocks FrictionOperator::blocks(const Field& inverse_mass, const BodyCoupling& bodies) const {
  BallBlocks balls;
  balls.size = {components_per_copy, 2};
  balls.count = {copies_per_cell * region_.cell_count(),
                 copies_per_wall_face * static_cast<Eigen::Index>(region_.wall_faces.size()) +
                     copies_per_contact * static_cast<Eigen::Index>(region_.contacts.size())};
  balls.radius = Eigen::ArrayXd::Zero(balls.blocks());
  balls.curvature = Eigen::ArrayXd::Zero(balls.blocks());
  // Copies of one cell, and of one edge, act together; the curvature is that of their joint motion.
  Field edge_curvature = Field::Zero(region_.edge_count() + 1);
  for (int e = 0; e < region_.edge_count(); ++e) {
    for (const int face : region_.edge_faces[static_cast<std::size_t>(e)])
      edge_curvature[e] += inverse_mass[face];
  }
  for (int cell = 0; cell < region_.cell_count(); ++cell) {
    double sum = 0.0;
    for (const int face : region_.cell_faces[static_cast<std::size_t>(cell)]) sum += inverse_mass[face];
    balls.curvature.segment(copies_per_cell * cell, copies_per_cell) = cell_share * 0.5 * sum;
  }
  for_each_shear([&](Eigen::Index value, int edge) {
    double& curvature = balls.curvature[value / components_per_copy];
    curvature = std::max(curvature, inner_edge_share * 0.5 * edge_curvature[edge]);
  });
  for_each_traction([&](Eigen::Index value, int edge) {
    double& curvature = balls.curvature[balls.count[0] + (value - wall_offset()) / 2];
    curvature = std::max(curvature, wall_edge_share * edge_curvature[edge]);
  });
  // A face is shared by two copies of the contact in either cell beside it.
  Eigen::Index block =
      balls.count[0] + copies_per_wall_face * static_cast<Eigen::Index>(region_.wall_faces.size());
  const std::vector<double> of_body = bodies.friction_curvature();
  for (const Contact& contact : region_.contacts) {
    for (const auto& faces : contact.faces) {
      for (const int face : faces)
        balls.curvature[block] = std::max(balls.curvature[block], 2.0 * inverse_mass[face]);
      if (contact.body >= 0) balls.curvature[block] += of_body[static_cast<std::size_t>(contact.body)];
      ++block;
    }
  }
  // A block with nothing to act on has no gradient; any positive curvature will do.
  balls.curvature = (balls.curvature > 0.0).select(balls.curvature, 1.0);
  return balls;
}

Eigen::Vector2d FrictionOperator::diagonal_share(int axis) {
  const double a = cell_share * inverse_sqrt2, b = cell_share * inverse_sqrt6;
  if (axis == 0) return {a, -b};
  if (axis == 1) return {0.0, 2.0 * b};
  return {-a, -b};
}

void FrictionOperator::clear_idle(Eigen::ArrayXd& copies) const {
  const auto clear = [&](Eigen::Index value, int edge) {
    if (edge == region_.null_edge()) copies[value] = 0.0;
  };
  for_each_shear(clear);
  for_each_traction(clear);
}

void set_friction_radii(const ActiveRegion& region, const FrictionOperator& friction,
                        const Field& cell_friction, const Field& confining, const Field& pressure,
                        const Eigen::ArrayXd& wall_reaction, const Eigen::ArrayXd& copies,
                        BallBlocks& balls) {
  for (int cell = 0; cell < region.cell_count(); ++cell) {
    balls.radius.segment(copies_per_cell * cell, copies_per_cell) =
        std::numbers::sqrt2 * cell_friction[cell] * confining[cell] * region.cell_share[cell];
  }
  StressField stress = make_stress_field(region);
  friction.stress_of(copies, stress);
  const auto wall_friction = [&](double friction_coefficient, int cell) {
    return friction_coefficient < 0.0 ? cell_friction[cell] : friction_coefficient;
  };
  for (std::size_t w = 0; w < region.wall_faces.size(); ++w) {
    const WallFace& wall = region.wall_faces[w];
    const auto face = static_cast<Eigen::Index>(w);
    const double normal =
        wall.area * pressure[wall.cell] - stress.diagonal(wall.axis, wall.cell) + wall_reaction[face];
    balls.radius.segment(balls.count[0] + copies_per_wall_face * face, copies_per_wall_face) =
        wall_friction(wall.friction, wall.cell) * std::max(0.0, normal);
  }
  if (region.contacts.empty()) return;
  Field normal_of_cell = Field::Zero(region.cell_count());
  for (const Contact& contact : region.contacts)
    normal_of_cell[contact.cell] = contact.area * pressure[contact.cell];
  for (const Closure& closure : region.closures)
    normal_of_cell[closure.cell] -= closure.normal_share * stress.diagonal(closure.axis, closure.cell);
  Eigen::Index block =
      balls.count[0] + copies_per_wall_face * static_cast<Eigen::Index>(region.wall_faces.size());
  for (const Contact& contact : region.contacts) {
    balls.radius.segment(block, copies_per_contact) = wall_friction(contact.friction, contact.cell) *
                                                      std::max(0.0, normal_of_cell[contact.cell]) /
                                                      copies_per_contact;
    block += copies_per_contact;
  }
}

}  // namespace talus
