#include "continuum/stress/friction_rows.h"

#include <numbers>

#include "continuum/grid/row_lanes.h"

namespace talus {
namespace {

// Shares of a stress among its copies, in the orthonormal basis of friction.h; 1/4 as in friction.cpp.
constexpr double difference_share = 0.25 / std::numbers::sqrt2;  // of (S_xx - S_zz) / sqrt 2
constexpr double upright_share = 0.25 * std::numbers::inv_sqrt3 / std::numbers::sqrt2;  // of sqrt(3/2) S_yy
constexpr double shear_share = 0.25 / std::numbers::sqrt2;                              // of sqrt 2 S_bc

template <class Real>
constexpr int lanes = static_cast<int>(RowLanes<Real>::size());

/// One copy of each of a few cells in a row.
template <class Real>
using Copy = std::array<RowLanes<Real>, components_per_copy>;

template <class Real>
RowLanes<Real> dot(const Copy<Real>& a, const Copy<Real>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4];
}

template <class Real>
Copy<Real> within(const Copy<Real>& copy, const RowLanes<Real>& radius) {
  const RowLanes<Real> norm = sqrt(dot<Real>(copy, copy));
  const RowLanes<Real> scale = either(norm > radius, RowLanes<Real>(radius / norm), RowLanes<Real>(Real{1}));
  return {scale * copy[0], scale * copy[1], scale * copy[2], scale * copy[3], scale * copy[4]};
}

/// One slot's copies in a row.
template <class Value>
struct Slot {
  Value* first;
  int stride;
  using Real = std::remove_const_t<Value>;

  Slot(Value* cells, const Row& row, int slot) : first(run(cells, row, slot, 0)), stride(row.length()) {}
  Copy<Real> at(int node) const {
    return {load(first + node), load(first + stride + node), load(first + 2 * stride + node),
            load(first + 3 * stride + node), load(first + 4 * stride + node)};
  }
  void set(int node, const Copy<Real>& copy) const {
    for (int c = 0; c < components_per_copy; ++c)
      store(copy[static_cast<std::size_t>(c)], first + c * stride + node);
  }
};

}  // namespace

template <class Real>
void FrictionRows<Real>::prepare(const ActiveRegion& region, const Field& inverse_mass,
                                 const BodyCoupling& bodies, const BallBlocks& balls) {
  region_ = &region;
  bodies_ = &bodies;
  layout_ = make_row_layout(region);
  for (auto* fields : {&edge_share_, &inverse_mass_, &mass_, &free_velocity_, &edge_strain_, &cell_strain_,
                       &stress_.shear, &stress_.diagonal, &stress_.push})
    talus::reset(layout_, *fields);
  const auto nodes = static_cast<std::size_t>(layout_.nodes);
  radius_.assign(nodes, Real{});
  odd_.assign(nodes, Real{});
  for (auto& curvature : curvature_) curvature.assign(nodes, Real{1});
  read_constants(inverse_mass, balls);
  tractions_.prepare(region, layout_, bodies, balls);
}

template <class Real>
void FrictionRows<Real>::read_constants(const Field& inverse_mass, const BallBlocks& balls) {
  for (int face = 0; face < region_->open_faces; ++face) {
    const auto f = static_cast<std::size_t>(face);
    const auto axis = static_cast<std::size_t>(region_->face_axis[f]);
    const auto node = static_cast<std::size_t>(layout_.node_of_face[f]);
    inverse_mass_[axis][node] = static_cast<Real>(inverse_mass[face]);
    mass_[axis][node] = inverse_mass[face] > 0.0 ? static_cast<Real>(1.0 / inverse_mass[face]) : Real{};
  }
  for (int edge = 0; edge < region_->inner_edges; ++edge) {
    const auto e = static_cast<std::size_t>(edge);
    edge_share_[static_cast<std::size_t>(region_->edge_axis[e])]
               [static_cast<std::size_t>(layout_.node_of_edge[e])] = static_cast<Real>(shear_share);
  }
  for (int cell = 0; cell < region_->cell_count(); ++cell) {
    const auto c = static_cast<std::size_t>(cell);
    const auto node = static_cast<std::size_t>(layout_.node_of_cell[c]);
    odd_[node] = static_cast<Real>(region_->cell_parity[c]);
    for (int copy = 0; copy < copies_per_cell; ++copy) {
      curvature_[static_cast<std::size_t>(slot_of(region_->cell_parity[c], copy))][node] =
          static_cast<Real>(balls.curvature[copies_per_cell * cell + copy]);
    }
  }
  if (layout_.period > 0) {
    for (const Row& row : layout_.rows) wrap_row(layout_, row, odd_.data());
  }
}

template <class Real>
void FrictionRows<Real>::read(const BallBlocks& balls, const Field& free_velocity, const Field& free_speeds,
                              const Eigen::ArrayXd& from, RowCopies<Real>& copies) {
  free_speeds_ = free_speeds;
  for (int face = 0; face < region_->open_faces; ++face) {
    const auto f = static_cast<std::size_t>(face);
    free_velocity_[static_cast<std::size_t>(region_->face_axis[f])]
                  [static_cast<std::size_t>(layout_.node_of_face[f])] =
                      static_cast<Real>(free_velocity[face]);
  }
  for (int cell = 0; cell < region_->cell_count(); ++cell) {
    radius_[static_cast<std::size_t>(layout_.node_of_cell[static_cast<std::size_t>(cell)])] =
        static_cast<Real>(balls.radius[copies_per_cell * cell]);
  }
  read_copies(*region_, layout_, from, copies);
  tractions_.set_radii(balls);
}

/// Copies of cells are read at the lower side alone; sums over whole lanes must not meet them again at the upper.
template <class Real>
void FrictionRows<Real>::wrap_cells(std::vector<Real>& cells) const {
  if (layout_.period == 0) return;
  for (const Row& row : layout_.rows) {
    if (row.items_begin == row.items_end) continue;
    for (int slot = 0; slot < copies_per_cell; ++slot) {
      for (int component = 0; component < components_per_copy; ++component) {
        Real* field = run(cells.data(), row, slot, component);
        field[row.items_begin - 1] = field[row.items_begin + layout_.period - 1];
      }
    }
  }
}

// ---- 1. strain ----

template <class Real>
void FrictionRows<Real>::strain_of(const RowVelocity<Real>& velocity) {
  for_each_row(layout_, [&](const Row& row) {
    const Real *vx = velocity.faces[0].data(), *vy = velocity.faces[1].data(), *vz = velocity.faces[2].data();
    const int y = row.to(1, 0), z = row.to(0, 1), below_y = row.to(-1, 0), below_z = row.to(0, -1);
    Real *yz = edge_strain_[0].data(), *zx = edge_strain_[1].data(), *xy = edge_strain_[2].data();
    const Real *share_yz = edge_share_[0].data(), *share_zx = edge_share_[1].data(),
               *share_xy = edge_share_[2].data();
    Real *xx = cell_strain_[0].data(), *yy = cell_strain_[1].data(), *zz = cell_strain_[2].data();
#pragma omp simd
    for (int i = row.items_begin; i < row.items_end; ++i) {
      yz[i] = share_yz[i] * (vy[i + below_z] - vy[i] + vz[i + below_y] - vz[i]);
      zx[i] = share_zx[i] * (vz[i - 1] - vz[i] + vx[i + below_z] - vx[i]);
      xy[i] = share_xy[i] * (vx[i + below_y] - vx[i] + vy[i - 1] - vy[i]);
      xx[i] = vx[i] - vx[i + 1];
      yy[i] = vy[i] - vy[i + y];
      zz[i] = vz[i] - vz[i + z];
    }
  });
  wrap(layout_, edge_strain_);
  tractions_.strain_of(velocity, cell_strain_);
}

/// Reads the strains of one slot's copies.
template <class Real>
struct FrictionRows<Real>::Strains {
  const Real *xx, *yy, *zz, *odd, *yz, *zx_even, *zx_odd, *xy_even, *xy_odd;

  Copy<Real> at(int node) const {
    const RowLanes<Real> x = load(xx + node), y = load(yy + node), z = load(zz + node);
    const auto is_odd = load(odd + node) > Real{};
    return {static_cast<Real>(difference_share) * (x - z), static_cast<Real>(upright_share) * (y + y - x - z),
            load(yz + node), either(is_odd, load(zx_odd + node), load(zx_even + node)),
            either(is_odd, load(xy_odd + node), load(xy_even + node))};
  }
};

template <class Real>
typename FrictionRows<Real>::Strains FrictionRows<Real>::strains_of(const Row& row, int slot) const {
  const int y = slot & 1, z = slot >> 1, even = even_sits_above(slot), odd = 1 - even;
  const Real *zx = edge_strain_[1].data() + row.to(0, z), *xy = edge_strain_[2].data() + row.to(y, 0);
  return {cell_strain_[0].data(),
          cell_strain_[1].data(),
          cell_strain_[2].data(),
          odd_.data(),
          edge_strain_[0].data() + row.to(y, z),
          zx + even,
          zx + odd,
          xy + even,
          xy + odd};
}

// ---- 2. copies ----

template <class Real>
double FrictionRows<Real>::duality_gap(const RowCopies<Real>& copies) const {
  const PassSums sums = sum_over_rows(layout_, [&](const Row& row) {
    RowLanes<Real> gap{};
    for (int slot = 0; slot < copies_per_cell; ++slot) {
      const Strains strains = strains_of(row, slot);
      const Slot<const Real> s(copies.cells.data(), row, slot);
      for (int i = row.cells_begin; i < row.cells_end; i += lanes<Real>) {
        const Copy<Real> e = strains.at(i);
        gap += load(radius_.data() + i) * sqrt(dot<Real>(e, e)) + dot<Real>(s.at(i), e);
      }
    }
    return PassSums{static_cast<double>(reduce(gap)), 0.0};
  });
  return std::max(0.0, sums.first + tractions_.duality_gap(copies));  // below 0 only by round-off
}

template <class Real>
PassSums FrictionRows<Real>::step(double lipschitz, Real beta, const RowCopies<Real>& now,
                                  const RowCopies<Real>& before, RowCopies<Real>& next) const {
  const Real inverse_lipschitz = static_cast<Real>(1.0 / lipschitz);
  PassSums sums = sum_over_rows(layout_, [&](const Row& row) {
    RowLanes<Real> slope{}, length{};
    for (int slot = 0; slot < copies_per_cell; ++slot) {
      const Strains strains = strains_of(row, slot);
      const Slot<const Real> from(now.cells.data(), row, slot), earlier(before.cells.data(), row, slot);
      const Slot<Real> to(next.cells.data(), row, slot);
      const Real* curvature = curvature_[static_cast<std::size_t>(slot)].data();
      for (int i = row.cells_begin; i < row.cells_end; i += lanes<Real>) {
        const Copy<Real> e = strains.at(i), s = from.at(i), s_before = earlier.at(i);
        const RowLanes<Real> d = load(curvature + i), step_length = inverse_lipschitz / d;
        Copy<Real> ahead, moved, gained, taken;
        for (std::size_t c = 0; c < components_per_copy; ++c) {
          ahead[c] = s[c] + beta * (s[c] - s_before[c]);
          moved[c] = ahead[c] - step_length * e[c];
        }
        const Copy<Real> s_next = within<Real>(moved, load(radius_.data() + i));
        for (std::size_t c = 0; c < components_per_copy; ++c) {
          gained[c] = s_next[c] - s[c];
          taken[c] = s_next[c] - ahead[c];
        }
        slope += dot<Real>(e, gained);
        length += d * dot<Real>(taken, taken);
        to.set(i, s_next);
      }
    }
    return PassSums{static_cast<double>(reduce(slope)), static_cast<double>(reduce(length))};
  });
  wrap_cells(next.cells);
  sums += tractions_.step(lipschitz, beta, now, before, next);
  return sums;
}

template <class Real>
void FrictionRows<Real>::project(RowCopies<Real>& copies) const {
  for_each_row(layout_, [&](const Row& row) {
    for (int slot = 0; slot < copies_per_cell; ++slot) {
      const Slot<Real> s(copies.cells.data(), row, slot);
      for (int i = row.cells_begin; i < row.cells_end; i += lanes<Real>)
        s.set(i, within<Real>(s.at(i), load(radius_.data() + i)));
    }
  });
  wrap_cells(copies.cells);
  tractions_.project(copies);
}

// ---- 3. stress ----

template <class Real>
void FrictionRows<Real>::stress_of(const RowCopies<Real>& copies) {
  const Real* cells = copies.cells.data();
  for_each_row(layout_, [&](const Row& row) {
    const auto own = [&](int slot, int component) { return run(cells, row, slot, component); };
    /// The same in the row at (dj, dk), still to be indexed by the nodes of this one.
    const auto other = [&](int dj, int dk, int slot, int component) {
      return run(cells, layout_.rows[static_cast<std::size_t>(row.row_at(dj, dk))], slot, component) +
             row.to(dj, dk);
    };
    Real *xx = stress_.diagonal[0].data(), *yy = stress_.diagonal[1].data(), *zz = stress_.diagonal[2].data();
    {
      const Real *a0 = own(0, 0), *a1 = own(1, 0), *a2 = own(2, 0), *a3 = own(3, 0);
      const Real *b0 = own(0, 1), *b1 = own(1, 1), *b2 = own(2, 1), *b3 = own(3, 1);
#pragma omp simd
      for (int i = row.items_begin; i < row.items_end; ++i) {
        const Real a = static_cast<Real>(difference_share) * (a0[i] + a1[i] + a2[i] + a3[i]);
        const Real b = static_cast<Real>(upright_share) * (b0[i] + b1[i] + b2[i] + b3[i]);
        xx[i] = a - b;
        yy[i] = b + b;
        zz[i] = -a - b;
      }
    }
    // An edge along x meets, in the cell that lies at (-y, -z) of it, the slot of that corner.
    Real *yz = stress_.shear[0].data(), *zx = stress_.shear[1].data(), *xy = stress_.shear[2].data();
    const Real *share_yz = edge_share_[0].data(), *share_zx = edge_share_[1].data(),
               *share_xy = edge_share_[2].data();
    {
      const Real *s0 = own(0, 2), *s1 = other(-1, 0, 1, 2), *s2 = other(0, -1, 2, 2),
                 *s3 = other(-1, -1, 3, 2);
#pragma omp simd
      for (int i = row.items_begin; i < row.items_end; ++i)
        yz[i] = share_yz[i] * (s0[i] + s1[i] + s2[i] + s3[i]);
    }
    // One along y or z meets, on either side along x, the slot whose copy sits there: which one tells the cell's parity.
    const auto chosen = [](const Real* odd, const Real* if_odd, const Real* if_even) {
      return either(load(odd) > Real{}, load(if_odd), load(if_even));
    };
    const Real *odd = odd_.data(), *odd_z = odd + row.to(0, -1), *odd_y = odd + row.to(-1, 0);
    const Real *zx0 = own(0, 3), *zx1 = own(1, 3), *zx2 = other(0, -1, 2, 3), *zx3 = other(0, -1, 3, 3);
    const Real *xy0 = own(0, 4), *xy2 = own(2, 4), *xy1 = other(-1, 0, 1, 4), *xy3 = other(-1, 0, 3, 4);
    for (int i = row.items_begin; i < row.items_end; i += lanes<Real>) {
      const int b = i - 1;
      const RowLanes<Real> zx_sum = chosen(odd + i, zx1 + i, zx0 + i) + chosen(odd + b, zx0 + b, zx1 + b) +
                                    chosen(odd_z + i, zx2 + i, zx3 + i) + chosen(odd_z + b, zx3 + b, zx2 + b);
      const RowLanes<Real> xy_sum = chosen(odd + i, xy2 + i, xy0 + i) + chosen(odd + b, xy0 + b, xy2 + b) +
                                    chosen(odd_y + i, xy1 + i, xy3 + i) + chosen(odd_y + b, xy3 + b, xy1 + b);
      store(RowLanes<Real>(load(share_zx + i) * zx_sum), zx + i);
      store(RowLanes<Real>(load(share_xy + i) * xy_sum), xy + i);
    }
  });
  tractions_.add_stress(copies, stress_, body_impulse_);
  wrap(layout_, stress_.shear);
  wrap(layout_, stress_.diagonal);
}

// ---- 4. faces ----

template <class Real>
PassSums FrictionRows<Real>::move_faces(const RowVelocity<Real>& ahead, RowVelocity<Real>& velocity) const {
  PassSums sums = sum_over_rows(layout_, [&](const Row& row) {
    const Real *xx = stress_.diagonal[0].data(), *yy = stress_.diagonal[1].data(),
               *zz = stress_.diagonal[2].data();
    const Real *yz = stress_.shear[0].data(), *zx = stress_.shear[1].data(), *xy = stress_.shear[2].data();
    const Real *px = stress_.push[0].data(), *py = stress_.push[1].data(), *pz = stress_.push[2].data();
    const Real *ix = inverse_mass_[0].data(), *iy = inverse_mass_[1].data(), *iz = inverse_mass_[2].data();
    const Real *mx = mass_[0].data(), *my = mass_[1].data(), *mz = mass_[2].data();
    const Real *fx = free_velocity_[0].data(), *fy = free_velocity_[1].data(), *fz = free_velocity_[2].data();
    const Real *ax = ahead.faces[0].data(), *ay = ahead.faces[1].data(), *az = ahead.faces[2].data();
    Real *vx = velocity.faces[0].data(), *vy = velocity.faces[1].data(), *vz = velocity.faces[2].data();
    const int y = row.to(1, 0), z = row.to(0, 1), below_y = row.to(-1, 0), below_z = row.to(0, -1);
    Real taken{}, whole{};
#pragma omp simd reduction(+ : taken, whole)
    for (int i = row.items_begin; i < row.items_end; ++i) {
      const Real x_now = fx[i] + ix[i] * (xx[i] - xx[i - 1] + xy[i + y] - xy[i] + zx[i + z] - zx[i] + px[i]);
      const Real y_now =
          fy[i] + iy[i] * (yy[i] - yy[i + below_y] + yz[i + z] - yz[i] + xy[i + 1] - xy[i] + py[i]);
      const Real z_now =
          fz[i] + iz[i] * (zz[i] - zz[i + below_z] + zx[i + 1] - zx[i] + yz[i + y] - yz[i] + pz[i]);
      taken += mx[i] * (x_now - ax[i]) * (x_now - ax[i]) + my[i] * (y_now - ay[i]) * (y_now - ay[i]) +
               mz[i] * (z_now - az[i]) * (z_now - az[i]);
      whole += mx[i] * ax[i] * ax[i] + my[i] * ay[i] * ay[i] + mz[i] * az[i] * az[i];
      vx[i] = x_now;
      vy[i] = y_now;
      vz[i] = z_now;
    }
    return PassSums{static_cast<double>(taken), static_cast<double>(whole)};
  });
  wrap(layout_, velocity.faces);
  sums += move_bodies(ahead.bodies, velocity.bodies);
  return sums;
}

/// Modes have mass 1, or do not move.
template <class Real>
PassSums FrictionRows<Real>::move_bodies(const Field& ahead, Field& speeds) const {
  const Field& movable = bodies_->inverse_mass();
  speeds = free_speeds_ + movable * body_impulse_;
  return {(movable * (speeds - ahead).square()).sum(), (movable * ahead.square()).sum()};
}

template <class Real>
void FrictionRows<Real>::extrapolate(const RowVelocity<Real>& now, const RowVelocity<Real>& before, Real beta,
                                     RowVelocity<Real>& ahead) const {
  ahead.bodies = now.bodies + static_cast<double>(beta) * (now.bodies - before.bodies);
  constexpr std::ptrdiff_t block = 4096;
  for_each_block(layout_.nodes, block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::size_t axis = 0; axis < 3; ++axis) {  // within the block: one barrier, not three
      const Real *v = now.faces[axis].data(), *v_before = before.faces[axis].data();
      Real* v_ahead = ahead.faces[axis].data();
#pragma omp simd
      for (std::ptrdiff_t i = begin; i < end; ++i) v_ahead[i] = v[i] + beta * (v[i] - v_before[i]);
    }
  });
}

template class FrictionRows<float>;
template class FrictionRows<double>;

}  // namespace talus
