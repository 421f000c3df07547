#include "continuum/render/colours.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "continuum/files/input_error.h"
#include "continuum/particles/sample_ellipsoid.h"

namespace talus {
namespace {

// Quartz sand, then basalt, terracotta, white, slate and olive: far from each other in hue or in lightness.
constexpr std::array<std::array<double, 3>, 6> palette{{{0.86, 0.69, 0.47},
                                                        {0.24, 0.23, 0.24},
                                                        {0.70, 0.33, 0.22},
                                                        {0.92, 0.90, 0.86},
                                                        {0.36, 0.47, 0.58},
                                                        {0.50, 0.52, 0.30}}};
constexpr double lightness_spread = 0.22, hue_spread = 0.06, size_spread = 0.2;

// Keys of random numbers, one for each use.
constexpr std::uint64_t seed = 0, shade_key = 1, size_key = 2, colour_key = 3;

double symmetric(Draws& draws) { return 2.0 * draws.unit() - 1.0; }

Colour parsed(const std::string& wish, const std::string& text) {
  unsigned value = 0;
  const char* const end = text.data() + text.size();
  if (text.size() != 7 || text[0] != '#' || std::from_chars(text.data() + 1, end, value, 16).ptr != end)
    throw InputError(fmt::format("--colour {}: '{}' is no colour; write it like #d9b077", wish, text));
  return Colour(value >> 16 & 0xff, value >> 8 & 0xff, value & 0xff) / 255.0;
}

}  // namespace

int shade_of(std::uint32_t identity) {
  return static_cast<int>(Draws(seed, shade_key, identity).unit() * shades);
}

double size_of(std::uint32_t identity) {
  Draws draws(seed, size_key, identity);
  return 1.0 + size_spread * symmetric(draws);
}

Colour shaded(const Colour& material, int shade) {
  Draws draws(seed, colour_key, static_cast<std::uint64_t>(shade));
  const double lightness = 1.0 + lightness_spread * symmetric(draws);
  Colour colour;
  for (double& channel : colour) channel = lightness * (1.0 + hue_spread * symmetric(draws));
  return colour.cwiseProduct(material).cwiseMin(1.0);
}

std::vector<Colour> colours_of(const std::vector<Material>& materials,
                               const std::vector<std::string>& wishes) {
  std::vector<Colour> colours;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    const auto& [red, green, blue] = palette[i % palette.size()];
    colours.emplace_back(red, green, blue);
  }
  for (const std::string& wish : wishes) {
    const auto equals = std::min(wish.find('='), wish.size());
    const std::string name = wish.substr(0, equals);
    const auto found =
        std::find_if(materials.begin(), materials.end(), [&](const Material& m) { return m.name == name; });
    if (found == materials.end())
      throw InputError(
          fmt::format("--colour {}: the scene has no material '{}'; write MATERIAL=#RRGGBB", wish, name));
    colours[static_cast<std::size_t>(found - materials.begin())] =
        parsed(wish, equals < wish.size() ? wish.substr(equals + 1) : "");
  }
  return colours;
}

}  // namespace talus
