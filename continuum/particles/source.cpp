#include "continuum/particles/source.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace talus {
namespace {

/// The lattice of one layer, as its middle passes the inlet.
std::vector<Eigen::Vector3d> layer_of(const Source& source) {
  const int b = next_axis(source.normal()), c = last_axis(source.normal());
  const Eigen::Vector3d size = source.upper - source.lower;
  const auto count = [&](int axis) {
    return std::max(1, static_cast<int>(std::lround(size[axis] / source.spacing)));
  };
  std::vector<Eigen::Vector3d> layer;
  for (int j = 0; j < count(c); ++j) {
    for (int i = 0; i < count(b); ++i) {
      const Eigen::Vector2d place((i + 0.5) / count(b), (j + 0.5) / count(c));
      if (source.round && (place.array() - 0.5).matrix().norm() > 0.5) continue;
      Eigen::Vector3d at = source.lower;
      at[b] += place[0] * size[b];
      at[c] += place[1] * size[c];
      layer.push_back(at);
    }
  }
  return layer;
}

double layer_interval(const Source& source) {
  return source.spacing / std::abs(source.velocity[source.normal()]);
}

double outline_area(const Source& source) {
  const Eigen::Vector3d size = source.upper - source.lower;
  return size[next_axis(source.normal())] * size[last_axis(source.normal())] *
         (source.round ? std::numbers::pi / 4.0 : 1.0);
}

}  // namespace

int Source::normal() const {
  int axis = 0;
  (upper - lower).minCoeff(&axis);
  return axis;
}

double Source::next_layer_time() const {
  const double interval = layer_interval(*this), before = static_cast<double>(layers);
  return start + (before + 0.5) * interval < end ? start + (before + 1.0) * interval
                                                 : std::numeric_limits<double>::infinity();
}

EmissionReport emit(std::span<const Material> materials, double time, std::vector<Source>& sources,
                    Particles& particles) {
  EmissionReport report;
  for (Source& source : sources) {
    const std::vector<Eigen::Vector3d> layer = layer_of(source);
    // The layer's mass is that of its outline, however the lattice meets it.
    const double volume =
        source.fill * outline_area(source) * source.spacing / static_cast<double>(layer.size());
    const double mass = materials[static_cast<std::size_t>(source.material)].max_density() * volume;
    while (source.next_layer_time() <= time) {
      const double since =
          time - source.next_layer_time() + 0.5 * layer_interval(source);  // its middle passed the inlet
      Eigen::Index p = particles.count();
      particles.resize(p + static_cast<Eigen::Index>(layer.size()));
      for (const Eigen::Vector3d& at : layer) {
        particles.positions.col(p) = at + since * source.velocity;
        particles.velocities.col(p) = source.velocity;
        particles.masses[p] = mass;
        particles.materials[static_cast<std::size_t>(p)] = source.material;
        if (particles.has_gradients()) particles.gradients.col(p).setZero();
        if (particles.has_origins()) particles.origins.col(p).setConstant(-1);
        set_shape_matrix(sphere_of_volume(volume), particles, p);
        ++p;
      }
      ++source.layers;
      report.count += static_cast<Eigen::Index>(layer.size());
      report.mass += mass * static_cast<double>(layer.size());
    }
  }
  return report;
}

}  // namespace talus
