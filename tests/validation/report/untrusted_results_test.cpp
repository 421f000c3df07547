// The page of results that are hostile, incomplete or broken.
#include <gmock/gmock.h>

#include <limits>

#include "tests/validation/report/report_page.h"
#include "tests/validation/report/sample_results.h"

namespace talus {
namespace {

using nlohmann::json;
using testing::all_charts;
using testing::BrowserView;
using testing::charts;
using ::testing::ContainsRegex;
using testing::count_of;
using ::testing::HasSubstr;
using testing::no_errors;
using ::testing::Not;
using testing::visible;

class UntrustedResults : public testing::ReportPage {};

TEST_F(UntrustedResults, HostileTextDoesNotRun) {
  const std::string attack =
      "</script><script>document.body.dataset.hostile='ran'</script>"
      "<img src=x onerror=\"document.body.dataset.hostile='ran'\"><!-- {{results}}";
  json results = testing::sample_results();
  json pictures = testing::sample_pictures();
  results["suite"] = results["title"] = results["verdict"] = attack;
  results["provenance"][attack] = attack;
  results["provenance"]["programs"][attack] = attack;
  results["drift"]["why"] = results["drift"]["baseline"]["who"] = attack;
  results["metrics"][0]["observable"] = results["beverloo"][0]["code"] = results["beverloo"][1]["material"] =
      attack;
  results["history"][0]["why"] = results["history"][0]["changes"][0]["name"] = attack;
  results["mutants"][0]["title"] = results["mutants"][0]["by"][0]["name"] = attack;
  json& column = results["points"][0];
  column["name"] = column["title"] = column["verdict"] = column["drift_verdict"] = attack;
  column["parameters"][attack] = {{attack, attack}};
  column["length_unit"]["symbol"] = attack;
  column["truth"][0]["observable"] = column["truth"][1]["why"] = column["truth"][2]["verdict"] = attack;
  column["truth"][3]["unit"] = column["truth"][3]["band_why"] = column["drift"][0]["observable"] = attack;
  column["runs"][0]["code"] = column["runs"][1]["status"] = column["runs"][2]["seed"] = attack;
  column["runs"][3]["observables"][attack] = attack;
  for (json& picture : pictures) picture["name"] = attack;
  pictures[1]["code"] = pictures[2]["seed"] = attack;
  const std::string page = visible(viewed(results, pictures).document);
  EXPECT_THAT(page, Not(ContainsRegex("<body[^>]*data-hostile")));
  EXPECT_EQ(count_of(page, "<img"), 0u);
  EXPECT_THAT(page, HasSubstr("&lt;img src=x"));
  EXPECT_THAT(page, HasSubstr(charts(all_charts)));
  EXPECT_THAT(page, HasSubstr(no_errors));
}

TEST_F(UntrustedResults, WordsOfTheLanguageAreNames) {
  json results = testing::sample_results();
  json& column = results["points"][0];
  column["name"] = "__proto__";
  column["runs"][0]["code"] = "constructor";
  column["truth"][0]["observable"] = column["truth"][0]["verdict"] = column["truth"][0]["unit"] = "toString";
  const BrowserView view = viewed(results, testing::sample_pictures());
  EXPECT_EQ(view.console, "");
  EXPECT_THAT(visible(view.document), HasSubstr(no_errors));
  EXPECT_THAT(visible(view.document), Not(HasSubstr("native code")));
}

TEST_F(UntrustedResults, MissingPartsAreShownAsMissing) {
  json results = testing::sample_results();
  for (const char* part : {"provenance", "mutants", "beverloo", "history", "drift"}) results.erase(part);
  results["metrics"] = nullptr;
  results["complete"] = false;
  json& column = results["points"][0];
  for (const char* part :
       {"calibration", "parameters", "input_hash", "length_unit", "drift", "drift_verdict"})
    column.erase(part);
  column["runs"][0] = {{"code", "continuum"}, {"seed", 1}, {"status", "failed"}};
  column["runs"][1]["observables"]["x95"] = nullptr;
  column["runs"][4]["observables"]["x90"] = std::numeric_limits<double>::quiet_NaN();
  column["runs"][5]["curves"] = nullptr;
  column["runs"][6]["curves"]["front"][3] = nullptr;
  column["runs"][7]["cpu_s"] = nullptr;
  column["truth"][0] = {{"observable", "x90"}, {"verdict", "INCONCLUSIVE"}, {"continuum", nullptr}};
  column["truth"][1]["yade"]["sd"] = column["truth"][1]["u_reference"] = column["truth"][1]["uncertainty"] =
      nullptr;
  results["points"][1] = {{"name", "slot/opening_8d"}, {"verdict", "INCONCLUSIVE"}};
  results["points"][2]["truth"] = results["points"][2]["drift"] = results["points"][2]["runs"] = nullptr;
  const BrowserView view = viewed(results, json::array());
  const std::string page = visible(view.document);
  EXPECT_EQ(view.console, "");
  EXPECT_THAT(page, HasSubstr(charts(2 + 5)));
  EXPECT_THAT(page, HasSubstr(no_errors));
  EXPECT_THAT(page, HasSubstr("These results are not complete"));
  EXPECT_THAT(page, Not(ContainsRegex("id=\"notice\"[^>]*hidden")));
  for (const char* words :
       {"These results hold no pictures.", "These results hold no fields.", "These results hold no curves.",
        "Nothing was compared.", "There were no runs.", "No comparison with a baseline.",
        "There is no baseline to compare with.", "no verdict"}) {
    EXPECT_THAT(page, HasSubstr(words));
  }
  EXPECT_THAT(page, Not(HasSubstr("undefined")));
  EXPECT_THAT(page, Not(HasSubstr("NaN")));
}

TEST_F(UntrustedResults, NearlyNothingStillGivesAPage) {
  for (const json& results :
       {json{{"schema", "talus-results"}, {"points", json::array({json::object()})}}, json::object()}) {
    const std::string page = visible(viewed(results, nullptr).document);
    EXPECT_THAT(page, HasSubstr(charts(0)));
    EXPECT_THAT(page, HasSubstr(no_errors));
    EXPECT_THAT(page, HasSubstr("Nothing was compared."));
  }
}

TEST_F(UntrustedResults, BadDataIsCountedAsAnError) {
  json results = testing::sample_results();
  results["points"][0]["runs"][0]["curves"]["front"] = "not a list";
  json pictures = testing::sample_pictures();
  pictures[0]["moments"][11]["x"] = "%%% not base64";
  const std::string page = visible(viewed(results, pictures).document);
  EXPECT_EQ(count_of(page, "could not be drawn"), 2u);
  EXPECT_THAT(page, HasSubstr("data-errors=\"2\""));
  EXPECT_THAT(page, HasSubstr("What each run took"));  // the rest of the page stands
}

}  // namespace
}  // namespace talus
