// What colour sand has: one per material, and a grain's own shade and size about it, which stay with its identity.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "continuum/materials/material.h"

namespace talus {

/// Red, green, blue as screens show them (sRGB), each in [0, 1].
using Colour = Eigen::Vector3d;

inline constexpr int shades = 32;  // of a material; renderers keep one texture for each

/// Which shade a point has, in [0, shades).
int shade_of(std::uint32_t identity);
/// What its radius is to the mean one, in [0.8, 1.2).
double size_of(std::uint32_t identity);
/// A shade of a material's colour: lighter or darker, and a little off its hue.
Colour shaded(const Colour& material, int shade);

/// A colour for each material: those of the list, taken in turn, but for `wishes`, each "NAME=#RRGGBB". Throws InputError when
/// a wish names no material or is no colour.
std::vector<Colour> colours_of(const std::vector<Material>& materials,
                               const std::vector<std::string>& wishes);

}  // namespace talus
