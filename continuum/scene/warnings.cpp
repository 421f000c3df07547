#include "continuum/scene/warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "continuum/files/memory.h"
#include "continuum/scene/narrow_openings.h"
#include "continuum/solids/mass_properties.h"

namespace talus {
namespace {

constexpr double most_cells_searched = 5e6;
constexpr double round_off = 0.02;  // relative: how well an inradius is known

/// How thick a shape is where it is thickest, m. An exact mesh does not tell: then the shortest side of its box.
double thickness(const Shape& shape) {
  if (std::holds_alternative<Mesh>(shape.geometry) || body_fault(shape))
    return bounds(shape).sizes().minCoeff();
  return 2.0 * inradius(shape);
}

bool plane_strain(const Scene& scene) {
  for (int axis = 0; axis < 3; ++axis) {
    if (scene.grid.periodic[static_cast<std::size_t>(axis)] && scene.grid.cells[axis] == 1) return true;
  }
  return false;
}

class Warnings {
 public:
  explicit Warnings(const Scene& scene) : scene_(scene) {}
  std::vector<std::string> texts;

  void openings() {
    if (scene_.grid.cells.cast<double>().prod() > most_cells_searched) return;
    const double h = scene_.grid.spacing;
    for (const NarrowOpening& opening :
         narrow_openings(scene_.grid, scene_.sides, scene_.walls, least_opening * h)) {
      tell("wall",
           fmt::format(
               "leaves an opening of {:.3g} m near ({:.4g}, {:.4g}, {:.4g}) m, {:.2g} cells; below {:.0f} "
               "cells it lets too little sand through; use cell_size_m = {:.3g} or less",
               opening.width, opening.place[0], opening.place[1], opening.place[2], opening.width / h,
               least_opening, opening.width / least_opening));
    }
  }

  void thin_sand() {
    for (std::size_t i = 0; i < scene_.fillings.size(); ++i)
      thin(fmt::format("sand[{}].shape", i), thickness(scene_.fillings[i].shape), least_layer);
  }

  void small_bodies() {
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i)
      thin(fmt::format("body[{}].shape", i), thickness(scene_.bodies[i].shape), least_body);
  }

  void particles_per_cell() {
    const bool flat = plane_strain(scene_);
    const int there = scene_.particles_per_cell.prod(),
              least = flat ? least_particles_in_2d : least_particles_in_3d;
    if (there >= least) return;
    tell("particles.per_cell",
         fmt::format("gives {} particles a cell; in {} fewer than {} leave holes in sand that "
                     "shears; use two along each axis",
                     there, flat ? "plane strain" : "3-D", least));
  }

  void frames(const SceneCost& cost) {
    const double interval = scene_.frame_interval;
    if (interval > scene_.end_time)
      tell("time.frame_interval_s",
           fmt::format("= {} is longer than the run, end_s = {}: only its start and its end are kept",
                       interval, scene_.end_time));
    else if (scene_.end_time / interval > 0.999 * cost.fewest_steps && cost.fewest_steps > 1.0)
      tell("time.frame_interval_s",
           fmt::format(
               "= {} is shorter than a time step, and makes {:.3g} steps of what would be some {:.3g}; "
               "use a longer one",
               interval, cost.fewest_steps, scene_.end_time / natural_step()));
  }

  void size(const SceneCost& cost, double memory) {
    if (cost.fewest_steps > most_steps_expected)
      tell("time.end_s",
           fmt::format("= {} takes at least {:.3g} time steps; use larger cells or a shorter run",
                       scene_.end_time, cost.fewest_steps));
    if (cost.bytes > memory)
      tell("domain.cell_size_m",
           fmt::format(
               "= {} makes {:.3g} cells and up to {:.3g} particles, which need about {}; {} are free; use "
               "larger cells or fewer particles in each",
               scene_.grid.spacing, scene_.grid.cells.cast<double>().prod(), cost.particles,
               memory_text(cost.bytes), memory_text(memory)));
  }

 private:
  /// The longest step at rest; without gravity there is none.
  double natural_step() const {
    const double g = scene_.gravity.norm();
    return g > 0.0 ? scene_.settings.gravity_courant * std::sqrt(scene_.grid.spacing / g) : scene_.end_time;
  }

  void thin(const std::string& key, double thick, double least) {
    const double h = scene_.grid.spacing;
    if (thick >= least * h * (1.0 - round_off)) return;
    tell(key, fmt::format(
                  "is {:.3g} m thick, {:.2g} cells; the grid resolves {} cells and more; use cell_size_m = "
                  "{:.3g} or less",
                  thick, thick / h, least, thick / least));
  }

  void tell(std::string_view key, std::string_view what) {
    texts.push_back(fmt::format("{}: key '{}' {}", scene_.file.string(), key, what));
  }

  const Scene& scene_;
};

}  // namespace

std::vector<std::string> scene_warnings(const Scene& scene, const SceneCost& cost, double memory) {
  Warnings warnings(scene);
  warnings.openings();
  warnings.thin_sand();
  warnings.small_bodies();
  warnings.particles_per_cell();
  warnings.frames(cost);
  warnings.size(cost, memory);
  return warnings.texts;
}

}  // namespace talus
