// Discharges corrected for the width of grains.
#include "validation/corrected.h"

#include <gtest/gtest.h>

#include <cmath>

namespace talus::validation {
namespace {

const std::filesystem::path cases = std::filesystem::path(TALUS_SOURCE_DIR) / "dem_cases/hourglass";

nlohmann::json run(const std::string& code, double rate) {
  return {{"code", code}, {"observables", {{"discharge_rate", rate}}}};
}

TEST(BeverlooC, TakesTheEdgeFromGrainsAndNothingFromAContinuum) {
  const auto slot =
      dem::read_case(cases / "case.toml");  // D = 24 mm, d = 3 mm, w = 12 mm, 0.56 * 2500 kg/m^3
  auto grains = run("liggghts", 0.1473), continuum = run("continuum", 0.214);
  add_beverloo_C(slot, grains);
  add_beverloo_C(slot, continuum);
  const double scale = 1400.0 * std::sqrt(9.81) * 0.012;
  EXPECT_NEAR(grains["observables"]["beverloo_C"].get<double>(),
              0.1473 / (scale * std::pow(0.024 - 0.0042, 1.5)), 1e-9);
  EXPECT_NEAR(continuum["observables"]["beverloo_C"].get<double>(), 0.214 / (scale * std::pow(0.024, 1.5)),
              1e-9);
  const auto hole = dem::read_case(cases / "cone.toml");
  auto round = run("continuum_coarse", 0.2);
  add_beverloo_C(hole, round);
  EXPECT_NEAR(round["observables"]["beverloo_C"].get<double>(),
              0.2 / (1400.0 * std::sqrt(9.81) * std::pow(0.024, 2.5)), 1e-9);
}

TEST(BeverlooC, TheUncertaintyOfKIsThatOfALawWithAnotherK) {
  const auto slot = dem::read_case(cases / "case.toml");
  const auto C = [&](double k) { return std::pow(0.024 - k * 0.003, -1.5); };
  const double half_range =
      0.5 * (C(edge_width + edge_width_uncertainty) - C(edge_width - edge_width_uncertainty));
  EXPECT_NEAR(edge_width_effect(slot), half_range / C(edge_width) / std::sqrt(3.0), 0.001);
}

TEST(BeverlooC, OtherCasesHaveNone) {
  const auto column = dem::read_case(cases.parent_path() / "column_collapse/case.toml");
  auto other = run("continuum", 0.2);
  add_beverloo_C(column, other);
  EXPECT_FALSE(other["observables"].contains("beverloo_C"));
  EXPECT_EQ(edge_width_effect(column), 0.0);
  auto lacking = run("continuum", 0.2);
  lacking["observables"].erase("discharge_rate");
  add_beverloo_C(dem::read_case(cases / "case.toml"), lacking);
  EXPECT_FALSE(lacking["observables"].contains("beverloo_C"));
}

}  // namespace
}  // namespace talus::validation
