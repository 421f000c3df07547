// What the mutation check calls found out.
#include "validation/mutants.h"

#include <gmock/gmock.h>

#include "validation/mutation.h"

namespace talus::validation {
namespace {

using ::testing::HasSubstr;

TEST(Mutants, AreTheOnesThatTheGateMustKnow) {
  EXPECT_THAT(mutant_names(),
              ::testing::IsSupersetOf({"no_friction", "friction_less_20_percent", "friction_more_20_percent",
                                       "no_wall_friction", "pressure_pulls", "no_density_correction",
                                       "gravity_less_5_percent"}));
  EXPECT_EQ(find_mutant("sound"), nullptr);
  EXPECT_EQ(find_mutant("no_friction")->defects.friction_factor, 0.0);
}

TEST(Mutants, TheTableSaysWhoSurvives) {
  const nlohmann::json mutants{
      {{"title", "no friction"},
       {"killed", true},
       {"by", {{{"name", "slot/a"}, {"observable", "discharge_rate"}, {"verdict", "FAIL"}}}},
       {"not_judged", nlohmann::json::array()}},
      {{"title", "gravity 5 % too small"},
       {"killed", false},
       {"by", nlohmann::json::array()},
       {"not_judged", {{{"name", "ledge/a"}, {"why", "it moved"}}}}}};
  const std::string text = mutants_text(mutants);
  EXPECT_THAT(text, HasSubstr("found out by slot/a discharge_rate"));
  EXPECT_THAT(text, HasSubstr("SURVIVES [ledge/a not judged: it moved]"));
  EXPECT_THAT(text, HasSubstr("1 of 2 mutants survive"));
}

}  // namespace
}  // namespace talus::validation
