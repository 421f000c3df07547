// The results as JUnit XML, markdown, annotations and PDF, read back.
#include "validation/report/other_formats.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <pugixml.hpp>
#include <sstream>

#include "continuum/files/atomic_file.h"
#include "continuum/files/input_error.h"
#include "continuum/files/process.h"
#include "tests/test_folder.h"
#include "tests/validation/report/sample_results.h"
#include "validation/report/report.h"

namespace talus {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* attack = "]]><b a=\"1\">&\n::error::x %0A | `@you` \x01 \xff [x](http://x)";

pugi::xml_document junit_of(const json& results) {
  const testing::TestFolder folder;
  write_junit(results, folder.path() / "junit.xml");
  pugi::xml_document document;
  const auto outcome = document.load_file((folder.path() / "junit.xml").c_str());
  EXPECT_TRUE(outcome) << outcome.description();
  return document;
}

pugi::xml_node suite_of(const pugi::xml_document& document, const char* name) {
  return document.child("testsuites").find_child_by_attribute("testsuite", "name", name);
}

TEST(JUnit, OneSuiteForEachPointAndGate) {
  const auto document = junit_of(testing::sample_results());
  const auto root = document.child("testsuites");
  EXPECT_STREQ(root.attribute("name").value(), "talus smoke");
  EXPECT_EQ(root.attribute("tests").as_int(), 7 + 4);
  EXPECT_EQ(root.attribute("failures").as_int(), 2);
  EXPECT_EQ(root.attribute("errors").as_int(), 2 + 1);
  EXPECT_EQ(std::distance(root.begin(), root.end()), 6);
  const auto truth = suite_of(document, "column_collapse/a_1 truth");
  EXPECT_EQ(truth.attribute("tests").as_int(), 5);
  EXPECT_EQ(truth.attribute("failures").as_int(), 1);
  EXPECT_EQ(truth.attribute("errors").as_int(), 1);
  EXPECT_STREQ(truth.attribute("timestamp").value(), "2000-01-01T00:00:00Z");
  const auto runout = truth.find_child_by_attribute("testcase", "name", "runout");
  EXPECT_STREQ(runout.attribute("classname").value(), "column_collapse/a_1.truth");
  EXPECT_STREQ(runout.child("failure").attribute("message").value(), "+14.5 % is outside the band of 10 %");
  EXPECT_STREQ(runout.child("failure").text().get(),
               "deviation +14.5 %, band 10.0 %, expanded uncertainty 3.0 %");
  EXPECT_STREQ(truth.find_child_by_attribute("testcase", "name", "final_height")
                   .child("error")
                   .attribute("type")
                   .value(),
               "INCONCLUSIVE");
  EXPECT_FALSE(truth.find_child_by_attribute("testcase", "name", "x95").first_child());
  EXPECT_EQ(suite_of(document, "slot/opening_8d drift").attribute("failures").as_int(), 1);
}

TEST(JUnit, NothingMissingPasses) {
  json results = testing::sample_results();
  results.erase("drift");
  results["points"][0]["truth"] = nullptr;
  results["points"][1]["truth"][0]["verdict"] = nullptr;
  results["points"][2] = {{"name", "heap/radius_8d"}};
  const auto document = junit_of(results);
  EXPECT_EQ(document.child("testsuites").attribute("tests").as_int(), 3);
  EXPECT_EQ(document.child("testsuites").attribute("errors").as_int(), 3);
  EXPECT_EQ(junit_of(json::object()).child("testsuites").attribute("errors").as_int(), 1);
  EXPECT_EQ(junit_of(nullptr).child("testsuites").attribute("errors").as_int(), 1);
}

TEST(JUnit, AnyTextIsText) {
  json results = testing::sample_results();
  json& point = results["points"][0];
  point["name"] = attack;
  point["truth"][2]["observable"] = point["truth"][2]["why"] = attack;
  const auto document = junit_of(results);
  const auto truth = document.child("testsuites").first_child();
  EXPECT_THAT(truth.attribute("name").value(), HasSubstr("]]><b a=\"1\">&"));
  EXPECT_THAT(
      truth.child("testcase").next_sibling().next_sibling().child("failure").attribute("message").value(),
      HasSubstr("]]><b a=\"1\">&\n::error::x"));
}

TEST(Markdown, VerdictsThenTableThenChanges) {
  const std::string text = markdown_summary(testing::sample_results());
  const auto place = [&](const char* words) {
    EXPECT_THAT(text, HasSubstr(words));
    return text.find(words);
  };
  const std::vector<std::size_t> places{
      place("## Talus validation: smoke"),
      place("**Truth** (continuum against DEM): ❌ FAIL"),
      place("**Drift** (since the baseline): ❌ FAIL · One observable moved."),
      place("| column\\_collapse/a\\_1 | ❌ FAIL | 3 of 5 | ✅ PASS |"),
      place("| column\\_collapse/a\\_1 | runout | ❌ FAIL | +14.5 % | ±10.0 % | ±3.0 % |"),
      place("### What changed since the baseline"),
      place("| slot/opening\\_8d | discharge\\_rate | ❌ FAIL | 0.1385 → 0.1415 | +2.2 % | ±0.5 % |"),
      place("git 7e57da7a7e57<")};
  EXPECT_TRUE(std::is_sorted(places.begin(), places.end()));
  EXPECT_THAT(text, Not(HasSubstr("not complete")));
}

TEST(Markdown, TablesStayWholeWhateverTheText) {
  json results = testing::sample_results();
  for (json& row : results["points"][0]["truth"]) row["why"] = row["observable"] = attack;
  results["points"][0]["name"] = results["suite"] = results["drift"]["why"] = attack;
  const std::string text = markdown_summary(results);
  std::istringstream lines(text);
  int columns = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] != '|') {
      columns = 0;
      continue;
    }
    int bars = 0;
    for (std::size_t k = 0; k < line.size(); ++k)
      bars += line[k] == '|' && (k == 0 || line[k - 1] != '\\') ? 1 : 0;
    if (columns == 0) columns = bars;
    EXPECT_EQ(bars, columns) << line;
  }
  EXPECT_THAT(text, Not(HasSubstr("<b")));
  EXPECT_THAT(text, Not(HasSubstr("@you")));
  EXPECT_THAT(text, Not(HasSubstr("[x](")));
}

TEST(Markdown, NothingMissingPasses) {
  const std::string text = markdown_summary(json::object());
  EXPECT_THAT(text, HasSubstr("**Truth** (continuum against DEM): ❔ INCONCLUSIVE"));
  EXPECT_THAT(text, HasSubstr("no drift gate"));
  EXPECT_THAT(text, HasSubstr("**not complete**"));
  EXPECT_THAT(text, Not(HasSubstr("PASS")));
  EXPECT_THAT(markdown_summary(nullptr), HasSubstr("INCONCLUSIVE"));
}

TEST(Annotations, OneLineForEachThatDidNotPass) {
  json results = testing::sample_results();
  const std::string text = annotations(results);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3 + 2);
  EXPECT_THAT(
      text,
      HasSubstr(
          "::error title=column_collapse/a_1 truth%3A runout::FAIL, +14.5 %25: +14.5 %25 is outside the band "
          "of 10 %25\n"));
  EXPECT_THAT(
      text,
      HasSubstr("::warning title=heap/radius_8d drift%3A repose_angle::INCONCLUSIVE, +0.0 %25: a solve did"));
  results["points"][0]["truth"][2]["why"] = results["points"][0]["name"] = attack;
  std::istringstream lines(annotations(results));
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count)
    EXPECT_THAT(line, ContainsRegex("^::(error|warning) title="));
  EXPECT_EQ(count, 5);
  EXPECT_EQ(annotations(json::object()), "");
}

TEST(Pdf, HoldsEveryPoint) {
  const testing::TestFolder folder;
  const auto page = folder.path() / "a report #1 %.html", pdf = folder.path() / "report.pdf";
  write_report(testing::sample_results(), testing::sample_pictures(), page);
  write_pdf(page, pdf);
  const std::string facts = output_of({"pdfinfo", pdf.string()});
  EXPECT_THAT(facts, HasSubstr("A4"));
  int pages = 0;
  const auto at = facts.find("Pages:");
  ASSERT_NE(at, std::string::npos) << facts;
  std::istringstream(facts.substr(at + 6)) >> pages;
  EXPECT_GE(pages, 8);
  EXPECT_LE(pages, 20);
  const std::string text = output_of({"pdftotext", "-layout", pdf.string(), "-"});
  for (const char* words :
       {"Smoke suite: the quick one", "✕ FAIL", "+14.5 %", "Column collapse, a = 1 (TEST DATA, not measured)",
        "Slot, opening 8 d (TEST DATA)", "Heap on a disc (TEST DATA)", "Uncertainty budget", "2023.02a"}) {
    EXPECT_THAT(text, HasSubstr(words));
  }
  // Chromium prints what was drawn on a canvas as text and lines, so that the charts can be read as well.
  for (const char* axis : {"continuum / reference", "time since release t (s)", "opening D (mm)", "x / L"}) {
    EXPECT_THAT(text, HasSubstr(axis));
  }
}

TEST(Pdf, SaysWhatIsMissing) {
  const testing::TestFolder folder;
  const auto page = folder.path() / "report.html", pdf = folder.path() / "report.pdf";
  EXPECT_THROW(write_pdf(page, pdf), InputError);
  write_file_atomically(page, "<p>page</p>");
  const auto message = [&] {
    try {
      write_pdf(page, pdf);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  ::setenv("TALUS_CHROMIUM", "/no/such/browser", 1);
  EXPECT_THAT(message(), HasSubstr("TALUS_CHROMIUM names '/no/such/browser'"));
  ::setenv("TALUS_CHROMIUM", "/bin/false", 1);
  EXPECT_THAT(message(), HasSubstr("exit code 1"));
  ::unsetenv("TALUS_CHROMIUM");
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", folder.path().c_str(), 1);
  EXPECT_THAT(message(), HasSubstr("apt-get install chromium"));
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_FALSE(fs::exists(pdf));
}

}  // namespace
}  // namespace talus
