#include "continuum/stress/friction_tractions.h"

#include <algorithm>

namespace talus {
namespace {

constexpr double wall_share = 0.5;      // a wall edge shares its stress over the two wall faces beside it
constexpr std::ptrdiff_t block = 2048;  // below this a second thread costs more than it brings

template <class Real>
Real norm_of(Real a, Real b) {
  return std::sqrt(a * a + b * b);
}

}  // namespace

template <class Real>
void FrictionTractions<Real>::prepare(const ActiveRegion& region, const RowLayout& layout,
                                      const BodyCoupling& bodies, const BallBlocks& balls) {
  region_ = &region;
  layout_ = &layout;
  bodies_ = &bodies;
  wall_edges_.clear();
  edge_of_wall_value_.clear();
  listed_.assign(static_cast<std::size_t>(region.edge_count() + 1), -1);
  for (const WallFace& wall : region.wall_faces) {
    for (std::size_t copy = 0; copy < copies_per_wall_face; ++copy) {
      for (std::size_t t = 0; t < 2; ++t) {
        const auto edge = static_cast<std::size_t>(wall.edges[t][copy]);
        int& place = listed_[edge];
        if (static_cast<int>(edge) != region.null_edge()) {
          if (place < 0) {
            place = static_cast<int>(wall_edges_.size());
            WallEdge added{region.edge_axis[edge], layout.node_of_edge[edge], {}, {-1, -1, -1, -1}};
            for (std::size_t k = 0; k < 4; ++k)
              added.face_nodes[k] = node_of_face(region.edge_faces[edge][k]);
            wall_edges_.push_back(added);
          }
          auto& values = wall_edges_[static_cast<std::size_t>(place)].wall_values;
          *std::find(values.begin(), values.end(), -1) = static_cast<int>(edge_of_wall_value_.size());
        }
        edge_of_wall_value_.push_back(place);
      }
    }
  }
  wall_edge_strain_.resize(wall_edges_.size());
  const auto curvature = [&](Eigen::Index first, std::size_t count, Balls& of) {
    const auto values = balls.curvature.segment(first, static_cast<Eigen::Index>(count));
    of.curvature.assign(values.begin(), values.end());
    of.strain.assign(2 * count, Real{});
  };
  const std::size_t wall_copies = copies_per_wall_face * region.wall_faces.size();
  curvature(balls.count[0], wall_copies, walls_);
  curvature(balls.count[0] + static_cast<Eigen::Index>(wall_copies),
            copies_per_contact * region.contacts.size(), contacts_);
}

template <class Real>
void FrictionTractions<Real>::set_radii(const BallBlocks& balls) {
  const auto walls = static_cast<Eigen::Index>(walls_.curvature.size()),
             contacts = static_cast<Eigen::Index>(contacts_.curvature.size());
  const auto of_walls = balls.radius.segment(balls.count[0], walls);
  const auto of_contacts = balls.radius.segment(balls.count[0] + walls, contacts);
  walls_.radius.assign(of_walls.begin(), of_walls.end());
  contacts_.radius.assign(of_contacts.begin(), of_contacts.end());
}

template <class Real>
void FrictionTractions<Real>::strain_of(const RowVelocity<Real>& velocity, RowFields<Real>& cell_strain) {
  const auto at = [&](int axis, int node) {
    return velocity.faces[static_cast<std::size_t>(axis)][static_cast<std::size_t>(node)];
  };
  for_each_block(std::ssize(wall_edges_), block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e) {
      const WallEdge& edge = wall_edges_[e];
      const int b = next_axis(edge.axis), c = last_axis(edge.axis);
      wall_edge_strain_[e] =
          static_cast<Real>(wall_share) * (at(b, edge.face_nodes[0]) - at(b, edge.face_nodes[1]) +
                                           at(c, edge.face_nodes[2]) - at(c, edge.face_nodes[3]));
    }
  });
  for_each_block(std::ssize(edge_of_wall_value_), block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto value = static_cast<std::size_t>(begin); value < static_cast<std::size_t>(end); ++value) {
      const int edge = edge_of_wall_value_[value];
      walls_.strain[value] = edge < 0 ? Real{} : wall_edge_strain_[static_cast<std::size_t>(edge)];
    }
  });
  std::size_t value = 0;
  const BodyRow* rows = bodies_->contact_rows().data();
  for (const Contact& contact : region_->contacts) {
    Eigen::Vector2d of_body = Eigen::Vector2d::Zero();
    if (contact.body >= 0) of_body << rows[0].times(velocity.bodies), rows[1].times(velocity.bodies);
    rows += bodies_->any() ? 2 : 0;
    for (const auto& face : contact.faces) {
      const Eigen::Vector3d slip(at(0, node_of_face(face[0])), at(1, node_of_face(face[1])),
                                 at(2, node_of_face(face[2])));
      const Eigen::Vector2d along = contact.tangents.transpose() * slip + of_body;
      contacts_.strain[value++] = static_cast<Real>(along[0]);
      contacts_.strain[value++] = static_cast<Real>(along[1]);
    }
  }
  for (std::size_t c = 0; c < region_->closures.size(); ++c) {
    const Closure& closure = region_->closures[c];
    double strained = closure.body >= 0 ? bodies_->closure_rows()[c].times(velocity.bodies) : 0.0;
    for (std::size_t k = 0; k < closure.faces.size(); ++k)
      strained += closure.weight[k] * at(static_cast<int>(k / 2), node_of_face(closure.faces[k]));
    const int node = layout_->node_of_cell[static_cast<std::size_t>(closure.cell)];
    cell_strain[static_cast<std::size_t>(closure.axis)][static_cast<std::size_t>(node)] =
        static_cast<Real>(strained);
  }
}

template <class Real>
PassSums FrictionTractions<Real>::step(const Balls& balls, double lipschitz, Real beta,
                                       const std::vector<Real>& now, const std::vector<Real>& before,
                                       std::vector<Real>& next) {
  const Real inverse_lipschitz = static_cast<Real>(1.0 / lipschitz);
  return sum_over_blocks<PassSums>(
      std::ssize(balls.radius), block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
        PassSums sums;
        for (auto copy = static_cast<std::size_t>(begin); copy < static_cast<std::size_t>(end); ++copy) {
          const std::size_t u = 2 * copy, v = u + 1;
          const Real strain_u = balls.strain[u], strain_v = balls.strain[v];
          const Real ahead_u = now[u] + beta * (now[u] - before[u]),
                     ahead_v = now[v] + beta * (now[v] - before[v]);
          const Real length = inverse_lipschitz / balls.curvature[copy];
          const Real moved_u = ahead_u - length * strain_u, moved_v = ahead_v - length * strain_v;
          const Real norm = norm_of(moved_u, moved_v);
          const Real scale = norm > balls.radius[copy] ? balls.radius[copy] / norm : Real{1};
          next[u] = scale * moved_u;
          next[v] = scale * moved_v;
          sums.first += strain_u * (next[u] - now[u]) + strain_v * (next[v] - now[v]);
          sums.second += balls.curvature[copy] * ((next[u] - ahead_u) * (next[u] - ahead_u) +
                                                  (next[v] - ahead_v) * (next[v] - ahead_v));
        }
        return sums;
      });
}

template <class Real>
PassSums FrictionTractions<Real>::step(double lipschitz, Real beta, const RowCopies<Real>& now,
                                       const RowCopies<Real>& before, RowCopies<Real>& next) const {
  PassSums sums = step(walls_, lipschitz, beta, now.walls, before.walls, next.walls);
  sums += step(contacts_, lipschitz, beta, now.contacts, before.contacts, next.contacts);
  return sums;
}

template <class Real>
void FrictionTractions<Real>::project(RowCopies<Real>& copies) const {
  const auto shrink = [](const Balls& balls, std::vector<Real>& values) {
    for (std::size_t copy = 0; copy < balls.radius.size(); ++copy) {
      const Real norm = norm_of(values[2 * copy], values[2 * copy + 1]);
      if (norm <= balls.radius[copy]) continue;
      values[2 * copy] *= balls.radius[copy] / norm;
      values[2 * copy + 1] *= balls.radius[copy] / norm;
    }
  };
  shrink(walls_, copies.walls);
  shrink(contacts_, copies.contacts);
}

template <class Real>
double FrictionTractions<Real>::duality_gap(const RowCopies<Real>& copies) const {
  const auto gap = [](const Balls& balls, const std::vector<Real>& values) {
    double total = 0.0;
    for (std::size_t copy = 0; copy < balls.radius.size(); ++copy) {
      const Real u = balls.strain[2 * copy], v = balls.strain[2 * copy + 1];
      total += balls.radius[copy] * norm_of(u, v) + values[2 * copy] * u + values[2 * copy + 1] * v;
    }
    return total;
  };
  return gap(walls_, copies.walls) + gap(contacts_, copies.contacts);
}

template <class Real>
void FrictionTractions<Real>::add_stress(const RowCopies<Real>& copies, RowStress<Real>& stress,
                                         Field& body_impulse) const {
  body_impulse = Field::Zero(bodies_->inverse_mass().size());
  for_each_block(std::ssize(wall_edges_), block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e) {
      const WallEdge& edge = wall_edges_[e];
      Real sum{};
      for (const int value : edge.wall_values)
        sum += value < 0 ? Real{} : copies.walls[static_cast<std::size_t>(value)];
      stress.shear[static_cast<std::size_t>(edge.axis)][static_cast<std::size_t>(edge.node)] =
          static_cast<Real>(wall_share) * sum;
    }
  });
  const auto push = [&](std::size_t axis, int face) -> Real& {
    return stress.push[axis][static_cast<std::size_t>(node_of_face(face))];
  };
  for (const Contact& contact : region_->contacts) {
    for (const auto& face : contact.faces) {
      for (std::size_t axis = 0; axis < 3; ++axis) push(axis, face[axis]) = Real{};
    }
  }
  for (const Closure& closure : region_->closures) {
    for (std::size_t k = 0; k < closure.faces.size(); ++k) push(k / 2, closure.faces[k]) = Real{};
  }
  for (std::size_t c = 0; c < region_->closures.size(); ++c) {
    const Closure& closure = region_->closures[c];
    Real& diagonal = stress.diagonal[static_cast<std::size_t>(closure.axis)][static_cast<std::size_t>(
        layout_->node_of_cell[static_cast<std::size_t>(closure.cell)])];
    for (std::size_t k = 0; k < closure.faces.size(); ++k)
      push(k / 2, closure.faces[k]) += static_cast<Real>(closure.weight[k]) * diagonal;
    if (closure.body >= 0) bodies_->closure_rows()[c].add_to(body_impulse, static_cast<double>(diagonal));
    diagonal = Real{};
  }
  std::size_t value = 0;
  const BodyRow* rows = bodies_->contact_rows().data();
  for (const Contact& contact : region_->contacts) {
    Eigen::Vector2d on_body = Eigen::Vector2d::Zero();
    for (const auto& face : contact.faces) {
      const Eigen::Vector2d along(copies.contacts[value], copies.contacts[value + 1]);
      const Eigen::Vector3d traction = contact.tangents * along;
      on_body += along;
      for (std::size_t axis = 0; axis < 3; ++axis)
        push(axis, face[axis]) += static_cast<Real>(traction[static_cast<int>(axis)]);
      value += 2;
    }
    for (int t = 0; t < 2 && contact.body >= 0; ++t) rows[t].add_to(body_impulse, on_body[t]);
    rows += bodies_->any() ? 2 : 0;
  }
}

template class FrictionTractions<float>;
template class FrictionTractions<double>;

}  // namespace talus
