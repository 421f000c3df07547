// The report as a reader's browser shows it.
#include "validation/report/report.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <limits>
#include <string>

#include "continuum/files/atomic_file.h"
#include "continuum/files/checked_table.h"
#include "tests/validation/browser.h"
#include "tests/validation/report/sample_results.h"

namespace talus {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

class Report : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(::testing::TempDir()) / fmt::format("talus-report-{}", ::getpid());
    fs::create_directories(folder);
    file = folder / "report.html";
  }
  void TearDown() override { fs::remove_all(folder); }

  std::string drawn(const json& results, const json& pictures) const {
    write_report(results, pictures, file);
    return testing::drawn_page(file);
  }

  fs::path folder, file;
};

/// The page without its scripts: what the reader sees.
std::string visible(const std::string& page) {
  std::string out;
  std::size_t place = 0;
  while (true) {
    const auto open = page.find("<script", place);
    out += page.substr(place, open - place);
    if (open == std::string::npos) return out;
    place = page.find("</script>", open) + 9;
  }
}

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++count;
  return count;
}

TEST_F(Report, DrawsEverything) {
  const std::string page = visible(drawn(testing::sample_results(), testing::sample_pictures()));
  EXPECT_THAT(page, HasSubstr("data-charts=\"3\""));  // front, profile, deposits
  EXPECT_THAT(page, HasSubstr("data-errors=\"0\""));
  EXPECT_THAT(page, HasSubstr("<h1 id=\"title\">Smoke suite</h1>"));
  EXPECT_THAT(page, HasSubstr("Of 5 comparisons 3 passed, 1 failed and 1 was inconclusive."));
  for (const char* word :
       {"✓ PASS", "✕ FAIL", "? INCONCLUSIVE", "+6.1 %", "±5.0 %", "1.305 ± 0.026",
        "the scatter of the reference is wider than the band", "3.10 × 10⁻¹⁴", ">31.1<", "3.5 × 10⁻⁵",
        "talus-validate run smoke --out /tmp/out", "2023.02a", "with uncommitted changes"}) {
    EXPECT_THAT(page, HasSubstr(word));
  }
  EXPECT_EQ(count_of(page, "role=\"rowheader\""), 5u);  // an observable each
  EXPECT_EQ(count_of(page, "LIGGGHTS, seed&nbsp;"),
            2u * 2);  // two seeds in two tables
  EXPECT_EQ(count_of(page, "<canvas"), 2u + 3u);
  EXPECT_EQ(count_of(page, "<canvas"),
            count_of(page, "aria-label=\"Line chart") + count_of(page, "aria-label=\"Side view"));
  EXPECT_THAT(page, Not(HasSubstr("could not be drawn")));
  EXPECT_THAT(page, ContainsRegex("id=\"notice\"[^>]*hidden"));
  EXPECT_THAT(page, Not(HasSubstr("undefined")));
  EXPECT_THAT(page, Not(HasSubstr("NaN")));
}

TEST_F(Report, AsksTheNetworkForNothing) {
  const std::string page = drawn(testing::sample_results(), testing::sample_pictures());
  // The browser has written all attributes in lower case and with double quotes.
  EXPECT_THAT(visible(page),
              Not(ContainsRegex(" (src|srcset|href|action|data|poster)=\"(https?:|//|file:)")));
  EXPECT_THAT(visible(page), Not(HasSubstr("url(")));
  EXPECT_THAT(visible(page), Not(HasSubstr("@import")));
  EXPECT_EQ(count_of(visible(page), "<link"), 0u);
  EXPECT_THAT(page, Not(ContainsRegex("<script[^>]* src")));
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));              // and the browser would refuse it
  EXPECT_THAT(page, HasSubstr("Released under the MIT License"));  // Chart.js keeps its licence
}

TEST_F(Report, HostileTextDoesNotRun) {
  const std::string attack =
      "</script><script>document.body.dataset.hostile='ran'</script>"
      "<img src=x onerror=\"document.body.dataset.hostile='ran'\"><!-- {{results}}";
  json results = testing::sample_results();
  json pictures = testing::sample_pictures();
  results["suite"] = attack;
  results["verdict"] = attack;
  results["provenance"][attack] = attack;
  results["provenance"]["libraries"][attack] = attack;
  json& column = results["cases"][0];
  column["name"] = column["title"] = column["verdict"] = attack;
  column["parameters"][attack] = {{attack, attack}};
  column["summary"][0]["observable"] = column["summary"][1]["why"] = column["summary"][2]["verdict"] = attack;
  column["summary"][3]["unit"] = attack;
  column["runs"][0]["backend"] = column["runs"][1]["status"] = column["runs"][2]["seed"] = attack;
  column["runs"][3]["observables"][attack] = attack;
  for (json& picture : pictures) picture["case"] = picture["backend"] = attack;
  const std::string page = visible(drawn(results, pictures));
  EXPECT_THAT(page, Not(ContainsRegex("<body[^>]*data-hostile")));
  EXPECT_EQ(count_of(page, "<img"), 0u);
  EXPECT_THAT(page, HasSubstr("&lt;img src=x"));
  EXPECT_THAT(page, HasSubstr("data-charts=\"3\""));
  EXPECT_THAT(page, HasSubstr("data-errors=\"0\""));
}

TEST_F(Report, MissingPartsAreShownAsMissing) {
  json results = testing::sample_results();
  results.erase("provenance");
  results["complete"] = false;
  json& column = results["cases"][0];
  for (const char* part : {"calibration", "parameters", "input_hash"}) column.erase(part);
  column["runs"][0] = {{"backend", "continuum"}, {"seed", 1}, {"status", "failed"}};
  column["runs"][1]["observables"]["x95"] = nullptr;
  column["runs"][2]["observables"]["x90"] = std::numeric_limits<double>::quiet_NaN();
  column["runs"][3]["curves"] = nullptr;
  column["runs"][4]["curves"]["front"][3] = nullptr;
  column["summary"][0] = {{"observable", "x90"}, {"verdict", "INCONCLUSIVE"}, {"continuum", nullptr}};
  column["summary"][1]["yade"]["sd"] = nullptr;
  const std::string page = visible(drawn(results, json::array()));
  EXPECT_THAT(page, HasSubstr("data-charts=\"2\""));
  EXPECT_THAT(page, HasSubstr("data-errors=\"0\""));
  EXPECT_THAT(page, HasSubstr("These results are not complete"));
  EXPECT_THAT(page, Not(ContainsRegex("id=\"notice\"[^>]*hidden")));
  EXPECT_THAT(page, HasSubstr("These results hold no pictures."));
  EXPECT_THAT(page, HasSubstr("<td class=\"number\">–</td>"));
  EXPECT_THAT(page, Not(HasSubstr("undefined")));
  EXPECT_THAT(page, Not(HasSubstr("NaN")));
}

TEST_F(Report, NearlyNothingStillGivesAPage) {
  const std::string page =
      visible(drawn({{"schema", "talus-results"}, {"cases", json::array({json::object()})}}, nullptr));
  EXPECT_THAT(page, HasSubstr("data-charts=\"0\""));
  EXPECT_THAT(page, HasSubstr("data-errors=\"0\""));
  EXPECT_THAT(page, HasSubstr("Nothing was compared."));
}

TEST_F(Report, BadDataIsCountedAsAnError) {
  json results = testing::sample_results();
  results["cases"][0]["runs"][0]["curves"]["front"] = "not a list";
  results["cases"][0]["summary"] = "not a list";
  const std::string page = visible(drawn(results, testing::sample_pictures()));
  EXPECT_THAT(page, HasSubstr("could not be drawn"));
  EXPECT_THAT(page, Not(HasSubstr("data-errors=\"0\"")));
  EXPECT_THAT(page, HasSubstr("What each run took"));  // the rest of the page stands
}

TEST_F(Report, UnwritablePlace) {
  EXPECT_THROW(write_report(testing::sample_results(), json::array(), folder / "absent" / "report.html"),
               InputError);
}

}  // namespace
}  // namespace talus
