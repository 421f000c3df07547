#include "continuum/particles/sort.h"

#include <stdexcept>

#include "continuum/parallel.h"

namespace talus {
namespace {

constexpr std::ptrdiff_t particles_per_block = 4096;

/// values.col(k) <- values.col(order[k])
template <class Columns>
void reorder(const std::vector<int>& order, Columns& values) {
  Columns sorted(values.rows(), values.cols());
  for_each_block(values.cols(), particles_per_block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k)
      sorted.col(k) = values.col(order[static_cast<std::size_t>(k)]);
  });
  values.swap(sorted);
}

template <class Value>
void reorder_entries(const std::vector<int>& order, const Value* values, Value* sorted) {
  for_each_block(static_cast<std::ptrdiff_t>(order.size()), particles_per_block,
                 [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
                   for (std::ptrdiff_t k = begin; k < end; ++k)
                     sorted[k] = values[order[static_cast<std::size_t>(k)]];
                 });
}

}  // namespace

void sort_by_cell(PointsByCell& points, Particles& particles) {
  if (points.point_count() != particles.count())
    throw std::invalid_argument("a particle lies outside of the domain");
  if (points.order.empty()) return;
  const std::vector<int>& order = points.order;
  reorder(order, particles.positions);
  reorder(order, particles.velocities);
  reorder(order, particles.shapes);
  if (particles.has_gradients()) reorder(order, particles.gradients);
  if (particles.has_origins()) reorder(order, particles.origins);
  Eigen::ArrayXd masses(particles.count());
  reorder_entries(order, particles.masses.data(), masses.data());
  particles.masses.swap(masses);
  std::vector<int> materials(order.size());
  reorder_entries(order, particles.materials.data(), materials.data());
  particles.materials.swap(materials);
  points.order.clear();
}

}  // namespace talus
