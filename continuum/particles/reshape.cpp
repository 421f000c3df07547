#include "continuum/particles/reshape.h"

namespace talus {

ReshapeReport split_and_merge(const Grid& grid, std::span<const Material> materials, const Allowed& allowed,
                              const ReshapeRules& rules, double dt, Particles& particles) {
  ReshapeReport report;
  report.split = split(grid, materials, allowed, rules, particles);
  report.merge = merge(grid, materials, allowed, rules, dt, particles);
  return report;
}

}  // namespace talus
