// The fields of the friction problem on rows (grid/row_layout.h), and how loops go over them. Shared by the passes over
// cells, edges and faces (friction_rows.h) and over walls and contacts (friction_tractions.h).
#pragma once

#include "continuum/grid/row_layout.h"
#include "continuum/parallel.h"
#include "continuum/stress/friction.h"

namespace talus {

inline constexpr int values_per_cell = components_per_copy * copies_per_cell;

template <class Real>
using RowField = std::vector<Real>;  // by node
template <class Real>
using RowFields = std::array<std::vector<Real>, 3>;  // by axis of faces or edges, or diagonal component

/// The copies of the stress, N s.
template <class Real>
struct RowCopies {
  std::vector<Real> cells;     // by row: values_per_cell runs of its length, 5 components of each of 4 slots
  std::vector<Real> walls;     // two tractions a copy, in the order of FrictionOperator
  std::vector<Real> contacts;  // the same
};

/// Velocities of faces, and the speeds of bodies' modes (body_coupling.h).
template <class Real>
struct RowVelocity {
  RowFields<Real> faces;
  Field bodies;
};

/// Stress on edges and in cells, or their strains; `push`: impulses on faces that come from the lists of contacts.
template <class Real>
struct RowStress {
  RowFields<Real> shear, diagonal, push;
};

/// Two sums that a pass gives beside its fields.
struct PassSums {
  double first = 0.0, second = 0.0;
  PassSums& operator+=(const PassSums& other) {
    first += other.first;
    second += other.second;
    return *this;
  }
};

/// f(row) for every row with something in it.
template <class Function>
void for_each_row(const RowLayout& layout, const Function& f) {
  for_each_block(layout.tasks(), 1,
                 [&](std::ptrdiff_t task, std::ptrdiff_t) { rows_of_task(layout, task, f); });
}
template <class Function>
PassSums sum_over_rows(const RowLayout& layout, const Function& f) {
  return sum_over_blocks<PassSums>(layout.tasks(), 1, [&](std::ptrdiff_t task, std::ptrdiff_t) {
    PassSums sums;
    rows_of_task(layout, task, [&](const Row& row) { sums += f(row); });
    return sums;
  });
}
template <class Function>
void rows_of_task(const RowLayout& layout, std::ptrdiff_t task, const Function& f) {
  const auto t = static_cast<std::size_t>(task);
  for (int r = layout.first_row_of_task[t]; r < layout.first_row_of_task[t + 1]; ++r) {
    const Row& row = layout.rows[static_cast<std::size_t>(r)];
    if (row.items_begin < row.items_end) f(row);
  }
}

/// Copies one period along x to the nodes beside it.
template <class Real>
void wrap_row(const RowLayout& layout, const Row& row, Real* field) {
  if (row.items_begin == row.items_end) return;
  const int end = row.items_begin + layout.period;
  field[row.items_begin - 1] = field[end - 1];
  field[end] = field[row.items_begin];
}
template <class Real>
void wrap(const RowLayout& layout, RowFields<Real>& fields) {
  if (layout.period == 0) return;
  for (auto& field : fields) {
    for (const Row& row : layout.rows) wrap_row(layout, row, field.data());
  }
}

template <class Real>
void reset(const RowLayout& layout, RowFields<Real>& fields) {
  for (auto& field : fields) field.assign(static_cast<std::size_t>(layout.nodes), Real{});
}

}  // namespace talus
