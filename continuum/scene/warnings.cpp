#include "continuum/scene/warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "continuum/files/memory.h"
#include "continuum/scene/narrow_openings.h"
#include "continuum/solids/mass_properties.h"

namespace talus {
namespace {

constexpr double most_cells_searched = 5e6;
constexpr double round_off = 0.02;  // relative: how well an inradius is known

/// How thick a shape is, m, a body's mesh where it is thinnest. Others do not tell: then the shortest side of its box.
double thickness(const Shape& shape) {
  if (std::holds_alternative<Mesh>(shape.geometry) || body_fault(shape))
    return bounds(shape).sizes().minCoeff();
  return thinnest(shape);
}

bool plane_strain(const Scene& scene) {
  for (int axis = 0; axis < 3; ++axis) {
    if (scene.grid.periodic[static_cast<std::size_t>(axis)] && scene.grid.cells[axis] == 1) return true;
  }
  return false;
}

using Texts = std::vector<std::string>;

std::string about(const Scene& scene, std::string_view key, std::string_view what) {
  return fmt::format("{}: key '{}' {}", scene.file.string(), key, what);
}

void warn_of_openings(const Scene& scene, Texts& texts) {
  if (scene.grid.cells.cast<double>().prod() > most_cells_searched) return;
  const double h = scene.grid.spacing;
  for (const NarrowOpening& opening :
       narrow_openings(scene.grid, scene.sides, scene.walls, least_opening * h)) {
    texts.push_back(
        about(scene, "wall",
              fmt::format(
                  "leaves an opening of {:.3g} m near ({:.4g}, {:.4g}, {:.4g}) m, {:.2g} cells; below {:.0f} "
                  "cells it lets too little sand through; use cell_size_m = {:.3g} or less",
                  opening.width, opening.place[0], opening.place[1], opening.place[2], opening.width / h,
                  least_opening, opening.width / least_opening)));
  }
}

void warn_of_thin(const Scene& scene, const std::string& key, const Shape& shape, double least,
                  Texts& texts) {
  const double h = scene.grid.spacing, thick = thickness(shape);
  if (thick >= least * h * (1.0 - round_off)) return;
  texts.push_back(
      about(scene, key,
            fmt::format("is {:.3g} m thick, {:.2g} cells; the grid resolves {} cells and more; use "
                        "cell_size_m = {:.3g} or less",
                        thick, thick / h, least, thick / least)));
}

void warn_of_particles_per_cell(const Scene& scene, Texts& texts) {
  const bool flat = plane_strain(scene);
  const int there = scene.particles_per_cell.prod(),
            least = flat ? least_particles_in_2d : least_particles_in_3d;
  if (there >= least) return;
  texts.push_back(about(scene, "particles.per_cell",
                        fmt::format("gives {} particles a cell; in {} fewer than {} leave holes in sand that "
                                    "shears; use two along each axis",
                                    there, flat ? "plane strain" : "3-D", least)));
}

/// Steps of a run in which the sand rests; without gravity nothing but its speed asks for any.
double steps_at_rest(const Scene& scene) {
  const double g = scene.gravity.norm();
  if (g <= 0.0) return std::numeric_limits<double>::infinity();
  return scene.end_time / (scene.settings.gravity_courant * std::sqrt(scene.grid.spacing / g));
}

void warn_of_frames(const Scene& scene, const SceneCost& cost, Texts& texts) {
  const double interval = scene.frame_interval, steps = steps_at_rest(scene);
  if (interval > scene.end_time) {
    texts.push_back(
        about(scene, "time.frame_interval_s",
              fmt::format("= {} is longer than the run, end_s = {}: only its start and its end are kept",
                          interval, scene.end_time)));
  } else if (scene.end_time / interval > std::max(1.0, steps)) {
    texts.push_back(
        about(scene, "time.frame_interval_s",
              fmt::format("= {} is shorter than a time step, and makes {:.3g} steps of what would be "
                          "some {:.3g}; use a longer one",
                          interval, cost.fewest_steps, steps)));
  }
}

void warn_of_size(const Scene& scene, const SceneCost& cost, double memory, Texts& texts) {
  if (cost.fewest_steps > most_steps_expected) {
    texts.push_back(
        about(scene, "time.end_s",
              fmt::format("= {} takes at least {:.3g} time steps; use larger cells or a shorter run",
                          scene.end_time, cost.fewest_steps)));
  }
  if (cost.bytes > memory) {
    texts.push_back(
        about(scene, "domain.cell_size_m",
              fmt::format("= {} makes {:.3g} cells and up to {:.3g} particles, which need about {}; {} "
                          "are free; use larger cells or fewer particles in each",
                          scene.grid.spacing, scene.grid.cells.cast<double>().prod(), cost.particles,
                          memory_text(cost.bytes), memory_text(memory))));
  }
}

}  // namespace

std::vector<std::string> scene_warnings(const Scene& scene, const SceneCost& cost, double memory) {
  Texts texts;
  warn_of_openings(scene, texts);
  for (std::size_t i = 0; i < scene.fillings.size(); ++i)
    warn_of_thin(scene, fmt::format("sand[{}].shape", i), scene.fillings[i].shape, least_layer, texts);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    warn_of_thin(scene, fmt::format("body[{}].shape", i), scene.bodies[i].shape, least_body, texts);
  warn_of_particles_per_cell(scene, texts);
  warn_of_frames(scene, cost, texts);
  warn_of_size(scene, cost, memory, texts);
  return texts;
}

}  // namespace talus
