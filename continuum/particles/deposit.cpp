// The particles to the grid. What a cell's particles deposit is added up around the cell first, and then on the grid.
#include "continuum/parallel.h"
#include "continuum/particles/gather.h"
#include "continuum/particles/slabs.h"
#include "continuum/particles/transfer.h"

namespace talus {
namespace {

constexpr std::ptrdiff_t entries_per_block = 8192;

/// One particle's kernel: along each axis, where the two rows with weight start among the three around its cell.
struct Kernel {
  std::array<int, 3> start;
  std::array<std::array<double, 2>, 3> row;
  std::array<double, 3> local;
};

Kernel kernel_of(const Grid& grid, const Eigen::Matrix3Xd& positions, int p) {
  Kernel kernel;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const double scaled = (positions(axis, p) - grid.origin[axis]) / grid.spacing;
    const double local = kernel.local[a] = scaled - std::floor(scaled);
    const int start = kernel.start[a] = local >= 0.5;
    const double upper = local + 0.5 - start;
    kernel.row[a] = {1.0 - upper, upper};
  }
  return kernel;
}

/// What a face gets of a particle's mass: mass, volume, momentum; the last is not used.
using FaceShare = Eigen::Array<double, 4, 1>;
/// What a cell gets of its volume: itself, and times friction.
using CellShare = Eigen::Array<double, 2, 1>;
using CellShares = Eigen::Array<double, 2, Eigen::Dynamic>;
using FaceShares = Eigen::Array<double, 4, Eigen::Dynamic>;

/// 1 / rho_max of each material, m^3/kg.
std::vector<double> specific_volumes(std::span<const Material> materials) {
  std::vector<double> volumes;
  for (const Material& material : materials) volumes.push_back(1.0 / material.max_density());
  return volumes;
}

/// What the particles of one cell deposit around it, 0 when it is not in use.
template <class CellValue, class FaceValue>
struct Sums {
  std::array<CellValue, 27> cells;
  std::array<std::array<FaceValue, 18>, 3> faces;
};

template <class Value>
void add_to_cells(const Kernel& kernel, const Value& share, std::array<Value, 27>& cells) {
  const int first = kernel.start[0] + 3 * kernel.start[1] + 9 * kernel.start[2];
  for (int corner = 0; corner < 8; ++corner) {
    const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
    const double weight = kernel.row[0][static_cast<std::size_t>(x)] *
                          kernel.row[1][static_cast<std::size_t>(y)] *
                          kernel.row[2][static_cast<std::size_t>(z)];
    cells[static_cast<std::size_t>(first + x + 3 * y + 9 * z)] += weight * share;
  }
}

/// `share(offset)`: what a face gets at that offset from the particle, in cells, along the axis, its next and its last one.
template <class Value, class Share>
void add_to_faces(const Kernel& kernel, std::size_t axis, const Share& share, std::array<Value, 18>& faces) {
  const std::size_t b = (axis + 1) % 3, c = (axis + 2) % 3;
  const std::array<double, 2> across{1.0 - kernel.local[axis], kernel.local[axis]};
  const int first = kernel.start[b] + 3 * kernel.start[c];
  for (int side = 0; side < 2; ++side) {
    for (int at_last = 0; at_last < 2; ++at_last) {
      for (int at_next = 0; at_next < 2; ++at_next) {
        const double weight = across[static_cast<std::size_t>(side)] *
                              kernel.row[b][static_cast<std::size_t>(at_next)] *
                              kernel.row[c][static_cast<std::size_t>(at_last)];
        const Eigen::Vector3d offset(side - kernel.local[axis],
                                     kernel.start[b] + at_next - 0.5 - kernel.local[b],
                                     kernel.start[c] + at_last - 0.5 - kernel.local[c]);
        faces[static_cast<std::size_t>(9 * side + first + 3 * at_last + at_next)] += weight * share(offset);
      }
    }
  }
}

template <class Values, class Value, std::size_t size>
void take(const std::array<int, size>& entries, int lost, std::array<Value, size>& sums, Values& values) {
  for (std::size_t k = 0; k < size; ++k) {
    // Where weights are lost nothing is added: slabs share the null face.
    if (entries[k] != lost) values(entries[k]) += sums[k];
    sums[k] = Value(0.0);
  }
}

/// Columns as entries.
template <class Array>
struct Columns {
  Array& array;
  auto operator()(int k) { return array.col(k); }
};

template <class CellValue, class FaceValue>
void zero(Sums<CellValue, FaceValue>& sums) {
  sums.cells.fill(CellValue(0.0));
  for (auto& faces : sums.faces) faces.fill(FaceValue(0.0));
}

/// f(particle, kernel, sums) for the particles of a cell, and then add(cell, sums), which leaves the sums 0; slab by slab.
template <class Sum, class Function, class Add>
void deposit_by_cell(const ActiveRegion& region, const PointsByCell& points, const Particles& particles,
                     const Function& f, const Add& add) {
  require_inside(region, points, particles.count());
  for_each_slab(make_slabs(region.grid, points), [&](const std::vector<int>& cells) {
    Sum sums;
    zero(sums);
    for (const int c : cells) {
      const auto i = static_cast<std::size_t>(c);
      for (int place = points.first[i]; place < points.first[i + 1]; ++place) {
        const int p = points.point(place);
        f(p, kernel_of(region.grid, particles.positions, p), sums);
      }
      add(region.cell_of_dense[static_cast<std::size_t>(points.cells[i])], sums);
    }
  });
}

/// Where `affine`, particles carry velocity gradients.
template <bool affine>
void deposit_shares(const ActiveRegion& region, const PointsByCell& points, const Particles& particles,
                    std::span<const Material> materials, const Eigen::ArrayXd& friction, CellShares& cells,
                    FaceShares& faces) {
  // Vectors whole in memory: one made of four scalars would have to wait for their stores.
  std::vector<FaceShare> per_mass;
  for (const double volume : specific_volumes(materials)) per_mass.push_back({1.0, volume, 0.0, 0.0});
  const FaceShare unit_momentum(0.0, 0.0, 1.0, 0.0);
  using Sum = Sums<CellShare, FaceShare>;
  const auto particle = [&](int p, const Kernel& kernel, Sum& sums) {
    const auto material = static_cast<std::size_t>(particles.materials[static_cast<std::size_t>(p)]);
    const FaceShare still = particles.masses[p] * per_mass[material];
    const double volume = particles.masses[p] * per_mass[material][1];
    add_to_cells(kernel, CellShare(volume, volume * friction[p]), sums.cells);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      const double momentum = particles.masses[p] * particles.velocities(a, p);
      FaceShare moving = still + momentum * unit_momentum;
      if constexpr (affine) {
        const auto rate = [&](std::size_t along) {  // of momentum, per cell
          return region.grid.spacing * particles.masses[p] *
                 particles.gradients(a + 3 * static_cast<Eigen::Index>(along % 3), p);
        };
        const Eigen::Vector3d rates(rate(axis), rate(axis + 1), rate(axis + 2));
        const auto share = [&](const Eigen::Vector3d& offset) -> FaceShare {
          return moving + rates.dot(offset) * unit_momentum;
        };
        add_to_faces(kernel, axis, share, sums.faces[axis]);
      } else {
        add_to_faces(
            kernel, axis, [&](const Eigen::Vector3d&) { return moving; }, sums.faces[axis]);
      }
    }
  };
  deposit_by_cell<Sum>(region, points, particles, particle, [&](int cell, Sum& sums) {
    CellStencil stencil = region.cell_stencils[static_cast<std::size_t>(cell)];
    for (int& entry : stencil.cells) entry = entry == empty_entry ? cell : entry;
    Columns<CellShares> cell_columns{cells};
    Columns<FaceShares> face_columns{faces};
    take(stencil.cells, empty_entry, sums.cells, cell_columns);
    for (std::size_t axis = 0; axis < 3; ++axis)
      take(stencil.faces[axis], region.null_face(), sums.faces[axis], face_columns);
  });
}

GridState state_of(const ActiveRegion& region, const CellShares& cells, const FaceShares& faces) {
  GridState state;
  for (Field* field : {&state.face_mass, &state.face_volume, &state.velocity}) field->resize(faces.cols());
  for_each_block(faces.cols(), entries_per_block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t f = begin; f < end; ++f) {
      state.face_mass[f] = faces(0, f);
      state.face_volume[f] = faces(1, f);
      // A face can be in use and yet hold no mass when every particle lies exactly on the opposite face. What is not finite
      // must stay so, for the step to stop at it.
      state.velocity[f] = faces(0, f) == 0.0 ? 0.0 : faces(2, f) / faces(0, f);
    }
  });
  state.fill = cells.row(0).transpose() / (region.grid.cell_volume() * region.cell_kernel);
  state.friction = (cells.row(0) > 0.0).select(cells.row(1) / cells.row(0).max(1e-300), 0.0).transpose();
  return state;
}

}  // namespace

GridState deposit(const ActiveRegion& region, const PointsByCell& points, const Particles& particles,
                  std::span<const Material> materials, const Eigen::ArrayXd& friction) {
  CellShares cells = CellShares::Zero(2, region.cell_count() + 1);
  FaceShares faces = FaceShares::Zero(4, region.face_count());
  if (particles.has_gradients())
    deposit_shares<true>(region, points, particles, materials, friction, cells, faces);
  else
    deposit_shares<false>(region, points, particles, materials, friction, cells, faces);
  return state_of(region, cells, faces);
}

DepositedVolume deposit_volume(const ActiveRegion& region, const PointsByCell& points,
                               const Particles& particles, std::span<const Material> materials) {
  const std::vector<double> specific_volume = specific_volumes(materials);
  DepositedVolume volume{Field::Zero(region.cell_count() + 1), Field::Zero(region.face_count())};
  using Sum = Sums<double, double>;
  const auto particle = [&](int p, const Kernel& kernel, Sum& sums) {
    const auto material = static_cast<std::size_t>(particles.materials[static_cast<std::size_t>(p)]);
    const double its = particles.masses[p] * specific_volume[material];
    add_to_cells(kernel, its, sums.cells);
    for (std::size_t axis = 0; axis < 3; ++axis)
      add_to_faces(
          kernel, axis, [&](const Eigen::Vector3d&) { return its; }, sums.faces[axis]);
  };
  deposit_by_cell<Sum>(region, points, particles, particle, [&](int cell, Sum& sums) {
    const CellStencil& stencil = region.cell_stencils[static_cast<std::size_t>(cell)];
    take(stencil.cells, empty_entry, sums.cells, volume.fill);
    for (std::size_t axis = 0; axis < 3; ++axis)
      take(stencil.faces[axis], region.null_face(), sums.faces[axis], volume.faces);
  });
  volume.fill /= region.grid.cell_volume() * region.cell_kernel;
  return volume;
}

GridState deposit(const ActiveRegion& region, const Particles& particles, std::span<const Material> materials,
                  const Eigen::ArrayXd& friction) {
  return deposit(region, points_by_cell(region.grid, particles.positions), particles, materials, friction);
}

Field deposit_fill(const ActiveRegion& region, const Particles& particles,
                   std::span<const Material> materials) {
  return deposit_volume(region, points_by_cell(region.grid, particles.positions), particles, materials).fill;
}

}  // namespace talus
