#include "continuum/stress/assemble.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>

namespace talus {
namespace {

using Array = Eigen::ArrayXd;
using SparseMatrix = Eigen::SparseMatrix<double>;
using Lists = std::vector<std::vector<int>>;

std::size_t at(Eigen::Index i) { return static_cast<std::size_t>(i); }

Lists rows_of_columns(const Pattern& pattern) {
  Lists rows(at(pattern.columns));
  for (std::size_t row = 0; row < pattern.of_row.size(); ++row) {
    for (const int column : pattern.of_row[row]) rows[at(column)].push_back(static_cast<int>(row));
  }
  return rows;
}

/// Columns by colour, such that no two of a colour share a row: each takes the first colour that is not around it.
Lists coloured(const Pattern& pattern, const Lists& rows) {
  Lists columns_of_colour;
  std::vector<int> colour(rows.size(), -1);
  std::vector<int> seen_by;  // per colour, the last column that met it
  for (std::size_t column = 0; column < rows.size(); ++column) {
    const int self = static_cast<int>(column);
    for (const int row : rows[column]) {
      for (const int other : pattern.of_row[at(row)]) {
        if (colour[at(other)] >= 0) seen_by[at(colour[at(other)])] = self;
      }
    }
    const auto free = std::find_if(seen_by.begin(), seen_by.end(), [&](int by) { return by != self; });
    colour[column] = static_cast<int>(free - seen_by.begin());
    if (free == seen_by.end()) {
      seen_by.push_back(-1);
      columns_of_colour.emplace_back();
    }
    columns_of_colour[at(colour[column])].push_back(self);
  }
  return columns_of_colour;
}

/// Fractions of the golden ratio: as good as random, and the same every time.
Array dense_probe(Eigen::Index size) {
  constexpr double golden = 0.6180339887498949;
  const Array multiples = golden * Array::LinSpaced(size, 1.0, static_cast<double>(size));
  return 0.5 + multiples - multiples.floor();
}

void require_same(const LinearOperator& apply, const SparseMatrix& matrix) {
  constexpr double roundoff = 1e-10;  // of the largest value
  const Array x = dense_probe(matrix.cols());
  Array y(matrix.rows());
  apply(x, y);
  const Array error = (matrix * x.matrix()).array() - y;
  if (y.size() > 0 && !(error.abs().maxCoeff() <= roundoff * y.abs().maxCoeff()))
    throw std::logic_error("assemble: the operator acts outside of its pattern");
}

void add(std::vector<int>& row, int column, int null) {
  if (column != null && std::find(row.begin(), row.end(), column) == row.end()) row.push_back(column);
}

Pattern empty_pattern(const ActiveRegion& region, Eigen::Index columns) {
  return {columns, Lists(at(region.open_faces))};
}

Pattern cell_pattern(const ActiveRegion& region) {
  Pattern pattern = empty_pattern(region, region.cell_count());
  for (std::size_t face = 0; face < pattern.of_row.size(); ++face) {
    for (const int cell : region.face_cells[face]) add(pattern.of_row[face], cell, region.null_cell());
  }
  return pattern;
}

Pattern edge_pattern(const ActiveRegion& region) {
  Pattern pattern = empty_pattern(region, region.edge_count());
  for (std::size_t face = 0; face < pattern.of_row.size(); ++face) {
    for (const int edge : region.face_edges[face]) add(pattern.of_row[face], edge, region.null_edge());
  }
  return pattern;
}

/// Values of the copies that carry the shear stress of an edge.
std::vector<int> values_on_edge(const ActiveRegion& region, int edge) {
  const int axis = region.edge_axis[at(edge)];
  const int walls = components_per_copy * copies_per_cell * region.cell_count();
  std::vector<int> values;
  for (const int copy : region.edge_copies[at(edge)]) {
    if (copy < 0) continue;
    if (edge < region.inner_edges) {
      values.push_back(components_per_copy * copy + 2 + axis);
    } else {  // traction along one tangent lives on edges along the other
      const WallFace& wall = region.wall_faces[at(copy / copies_per_wall_face)];
      values.push_back(walls + 2 * copy + (wall.along[1] == axis ? 0 : 1));
    }
  }
  return values;
}

Pattern contact_pattern(const ActiveRegion& region) {
  constexpr int no_null = -1;
  Pattern pattern =
      empty_pattern(region, values_per_contact * static_cast<Eigen::Index>(region.contacts.size()));
  int value = 0;
  for (const Contact& contact : region.contacts) {
    for (const auto& faces : contact.faces) {
      for (const int face : faces) {
        if (face == region.null_face()) continue;
        add(pattern.of_row[at(face)], value, no_null);
        add(pattern.of_row[at(face)], value + 1, no_null);
      }
      value += 2;
    }
  }
  return pattern;
}

Pattern friction_pattern(const ActiveRegion& region) {
  constexpr int no_null = -1;
  const auto walls = static_cast<Eigen::Index>(region.wall_faces.size());
  const Pattern contacts = contact_pattern(region);
  const Eigen::Index first_contact =
      components_per_copy * copies_per_cell * region.cell_count() + 2 * copies_per_wall_face * walls;
  Pattern pattern = empty_pattern(region, first_contact + contacts.columns);
  const Pattern cells = cell_pattern(region), edges = edge_pattern(region);
  for (std::size_t face = 0; face < pattern.of_row.size(); ++face) {
    for (const int cell : cells.of_row[face]) {
      for (int copy = 0; copy < copies_per_cell; ++copy) {
        const int first = components_per_copy * (copies_per_cell * cell + copy);
        add(pattern.of_row[face], first, no_null);
        add(pattern.of_row[face], first + 1, no_null);
      }
    }
    for (const int edge : edges.of_row[face]) {
      for (const int value : values_on_edge(region, edge)) add(pattern.of_row[face], value, no_null);
    }
    for (const int value : contacts.of_row[face])
      add(pattern.of_row[face], static_cast<int>(first_contact) + value, no_null);
  }
  return pattern;
}

/// D2 of a stress that `fill` has filled, as an operator on what it fills from.
template <class Fill>
LinearOperator stress_operator(const ActiveRegion& region, Fill fill) {
  return [&region, fill](const Array& x, Array& y) {
    StressField stress = make_stress_field(region);
    fill(x, stress);
    Field faces = Field::Zero(region.open_faces + 1);
    add_stress_divergence(region, stress, faces);
    y = faces.head(region.open_faces);
  };
}

}  // namespace

SparseMatrix assemble(const LinearOperator& apply, const Pattern& pattern) {
  const Lists rows = rows_of_columns(pattern);
  std::vector<Eigen::Triplet<double>> entries;
  Array x = Array::Zero(pattern.columns), y(static_cast<Eigen::Index>(pattern.of_row.size()));
  for (const std::vector<int>& columns : coloured(pattern, rows)) {
    for (const int column : columns) x[column] = 1.0;
    apply(x, y);
    for (const int column : columns) {
      x[column] = 0.0;
      for (const int row : rows[at(column)]) {
        if (y[row] != 0.0) entries.emplace_back(row, column, y[row]);
      }
    }
  }
  SparseMatrix matrix(y.size(), pattern.columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  require_same(apply, matrix);
  return matrix;
}

SparseMatrix sparse_gradient(const ActiveRegion& region) {
  const auto apply = [&](const Array& x, Array& y) {
    Field cells = Field::Zero(region.cell_count() + 1), faces = Field::Zero(region.open_faces + 1);
    cells.head(region.cell_count()) = x;
    add_gradient(region, cells, 1.0, faces);
    y = faces.head(region.open_faces);
  };
  return assemble(apply, cell_pattern(region));
}

SparseMatrix sparse_diagonal_divergence(const ActiveRegion& region, int axis) {
  const auto fill = [&region, axis](const Array& x, StressField& stress) {
    stress.diagonal.row(axis).head(region.cell_count()) = x.transpose();
  };
  return assemble(stress_operator(region, fill), cell_pattern(region));
}

SparseMatrix sparse_shear_divergence(const ActiveRegion& region) {
  const auto fill = [&region](const Array& x, StressField& stress) {
    stress.shear.head(region.edge_count()) = x;
  };
  return assemble(stress_operator(region, fill), edge_pattern(region));
}

SparseMatrix sparse_contact_divergence(const ActiveRegion& region) {
  const auto fill = [](const Array& x, StressField& stress) { stress.contact = x; };
  return assemble(stress_operator(region, fill), contact_pattern(region));
}

namespace {

SparseMatrix sparse_friction_of_faces(const ActiveRegion& region, const FrictionOperator& friction) {
  const auto apply = [&](const Array& x, Array& y) {
    Field faces(region.open_faces + 1);
    friction.apply(x, faces);
    y = faces.head(region.open_faces);
  };
  return assemble(apply, friction_pattern(region));
}

}  // namespace

SparseMatrix sparse_friction(const ActiveRegion& region, const FrictionOperator& friction,
                             const BodyCoupling& bodies) {
  const SparseMatrix faces = sparse_friction_of_faces(region, friction);
  if (!bodies.any()) return faces;
  // A row of its own for each mode, below those of the faces.
  std::vector<Eigen::Triplet<double>> entries;
  for (int column = 0; column < faces.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(faces, column); entry; ++entry)
      entries.emplace_back(static_cast<int>(entry.row()), column, entry.value());
  }
  const auto add = [&](const BodyRow& row, Eigen::Index column, double share) {
    for (int k = 0; k < row.count; ++k)
      entries.emplace_back(region.open_faces + row.first + k, static_cast<int>(column),
                           share * row.values[at(k)]);
  };
  const Eigen::Index first_contact =
      faces.cols() - values_per_contact * static_cast<Eigen::Index>(region.contacts.size());
  for (std::size_t row = 0; row < bodies.contact_rows().size(); ++row) {
    for (int copy = 0; copy < copies_per_contact; ++copy)
      add(bodies.contact_rows()[row],
          first_contact + static_cast<Eigen::Index>(values_per_contact * (row / 2) + row % 2) + 2 * copy,
          1.0);
  }
  for (std::size_t c = 0; c < region.closures.size(); ++c) {
    const Closure& closure = region.closures[c];
    const Eigen::Vector2d share = FrictionOperator::diagonal_share(closure.axis);
    for (int copy = 0; copy < copies_per_cell; ++copy) {
      const Eigen::Index first = components_per_copy * (copies_per_cell * closure.cell + copy);
      add(bodies.closure_rows()[c], first, share[0]);
      add(bodies.closure_rows()[c], first + 1, share[1]);
    }
  }
  SparseMatrix matrix(region.open_faces + bodies.inverse_mass().size(), faces.cols());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

SparseMatrix normal_matrix(const SparseMatrix& d, const Array& weight) {
  const SparseMatrix weighted = weight.matrix().asDiagonal() * d;
  const SparseMatrix product = SparseMatrix(d.transpose()) * weighted;
  // Rounding may differ on the two sides of the diagonal.
  SparseMatrix symmetric = 0.5 * (product + SparseMatrix(product.transpose()));
  symmetric.makeCompressed();
  return symmetric;
}

}  // namespace talus
