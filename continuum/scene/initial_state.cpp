#include <fmt/format.h>

#include <random>

#include "continuum/files/input_error.h"
#include "continuum/scene/scene.h"
#include "continuum/solids/body_step.h"

namespace talus {
namespace {

struct Lattice {
  std::vector<Eigen::Vector3d> positions;
  double mass;  // kg, of each
};

/// A lattice that fills the shape's bounds exactly, as near to n per cell and axis as whole numbers allow; of it, what
/// lies in the shape and outside walls and bodies.
template <class Random>
Lattice fill(const Scene& scene, const Filling& filling, Random& symmetric) {
  const std::vector<double> swollen = swellings(scene.bodies, scene.grid.spacing);
  const Eigen::AlignedBox3d box = bounds(filling.shape);
  const Eigen::Vector3d size = box.sizes();
  const Eigen::Vector3d count =
      (size.array() * scene.particles_per_cell.cast<double>().array() / scene.grid.spacing).round().max(1.0);
  const Eigen::Vector3d spacing = size.array() / count.array();
  Lattice lattice{{}, spacing.prod() * scene.materials[filling.material].max_density()};
  for (int k = 0; k < count[2]; ++k) {
    for (int j = 0; j < count[1]; ++j) {
      for (int i = 0; i < count[0]; ++i) {
        Eigen::Vector3d at(i + 0.5, j + 0.5, k + 0.5);
        for (int axis = 0; axis < 3; ++axis) at[axis] += 0.5 * scene.jitter * symmetric();
        const Eigen::Vector3d position = box.min() + at.cwiseProduct(spacing);
        if (signed_distance(filling.shape, position) > 0.0 ||
            nearest_wall(scene.walls, 0.0, position).distance < 0.0 ||
            in_a_body(scene.grid, scene.bodies, swollen, position))
          continue;
        for (const Filling* earlier = scene.fillings.data(); earlier != &filling; ++earlier) {
          if (signed_distance(earlier->shape, position) < -1e-9 * scene.grid.spacing)
            throw InputError(fmt::format("{}: two [[sand]] shapes overlap near ({:.4g}, {:.4g}, {:.4g}) m",
                                         scene.file.string(), position[0], position[1], position[2]));
        }
        lattice.positions.push_back(position);
      }
    }
  }
  if (lattice.positions.empty())
    throw InputError(
        fmt::format("{}: a [[sand]] shape holds no particle: it lies inside walls or bodies, or is too small",
                    scene.file.string()));
  return lattice;
}

/// Points follow mass: a particle of mass rho_max h^3 / per_cell has as many as the scene says, one of a lattice whose spacing
/// is not quite h / per_cell_axis, to fill its shape exactly, a share more or fewer.
RenderPoints initial_render_points(const Scene& scene, const State& state) {
  const double per_volume = scene.render_points_per_particle *
                            scene.particles_per_cell.cast<double>().prod() / scene.grid.cell_volume();
  const ActiveRegion region =
      make_active_region(state.grid, state.sides, state.particles.positions, state.openings);
  const Eigen::ArrayXd friction = Eigen::ArrayXd::Zero(state.particles.count());  // fill does not hang on it
  const std::vector<Cover> cover =
      cover_of_cells(region, deposit(region, state.particles, state.materials, friction).fill);
  return sample_render_points({state.grid, state.sides, state.openings, &region, cover}, state.materials,
                              per_volume, scene.seed, state.particles);
}

}  // namespace

State initial_state(const Scene& scene) {
  State state{scene.grid,
              scene.sides,
              scene.walls,
              openings_of(scene.grid, scene.walls, 0.0),
              scene.materials,
              scene.sources,
              scene.gravity,
              {},
              0.0,
              {},
              false,
              {},
              {}};
  std::mt19937_64 random(scene.seed);
  // Portable: the standard fixes the engine's numbers, not the distributions'.
  const auto symmetric = [&] { return static_cast<double>(random() >> 11) * 0x1.0p-52 - 1.0; };  // in [-1, 1)

  Particles& particles = state.particles;
  particles.resize(0);
  for (const Filling& filling : scene.fillings) {
    const Lattice lattice = fill(scene, filling, symmetric);
    const double volume = lattice.mass / scene.materials[filling.material].max_density();
    Eigen::Index p = particles.count();
    particles.resize(p + static_cast<Eigen::Index>(lattice.positions.size()));
    for (const Eigen::Vector3d& position : lattice.positions) {
      particles.positions.col(p) = position;
      particles.velocities.col(p) = filling.velocity;
      particles.masses[p] = lattice.mass;
      particles.materials[static_cast<std::size_t>(p)] = static_cast<int>(filling.material);
      if (particles.has_gradients()) particles.gradients.col(p).setZero();
      set_shape_matrix(sphere_of_volume(volume), particles, p);
      ++p;
    }
  }
  if (!scene.bodies.empty()) add_bodies(state, scene.bodies);
  state.explosions = scene.explosions;
  if (scene.render_points_per_particle > 0) state.render_points = initial_render_points(scene, state);
  return state;
}

}  // namespace talus
