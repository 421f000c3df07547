// The report as a reader's browser shows it.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "continuum/files/input_error.h"
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

using testing::all_matches;
using testing::every_point;
using testing::summary_charts;

class Report : public testing::ReportPage {};

TEST_F(Report, DrawsEverything) {
  const BrowserView view = viewed(testing::sample_results(), testing::sample_pictures());
  const std::string page = visible(view.document);
  EXPECT_EQ(view.console, "");
  EXPECT_THAT(page, HasSubstr(charts(all_charts)));
  EXPECT_THAT(page, HasSubstr(no_errors));
  EXPECT_THAT(page, HasSubstr("<h1 id=\"title\">Smoke suite: the quick one</h1>"));
  for (const char* words : {"Of 7 comparisons: 4 passed, 1 failed, 2 inconclusive.",
                            "Of 4 comparisons: 2 passed, 1 failed, 1 inconclusive.",
                            "✓ PASS",
                            "✕ FAIL",
                            "? INCONCLUSIVE",
                            "+14.5 %",
                            "±5.0 %",
                            "1.305 ± 0.026",
                            "the uncertainty is wider than the band",
                            "0.040 %",
                            "practical: what an engineer would notice",
                            "−0.006 %",
                            "1.001 to 1.041",
                            "2.1 % to 6.2 %",
                            "✓ shown",
                            "not shown",
                            "✓ CAUGHT",
                            "✕ SURVIVED",
                            "1 survived, which is a finding",
                            "1.480 ± 0.0500",
                            "21 ×",
                            "– → 1.733",
                            "3.10 × 10⁻¹⁴",
                            ">31.1<",
                            "3.5 × 10⁻⁵",
                            "talus-validate run smoke -o /tmp/out",
                            "2023.02a",
                            "with uncommitted changes",
                            "Lengths are over L₀ = 48 mm."}) {
    EXPECT_THAT(page, HasSubstr(words));
  }
  EXPECT_EQ(count_of(page, "<canvas"),
            count_of(page, "aria-label=\"Line chart") + count_of(page, "aria-label=\"Scatter chart") +
                count_of(page, "aria-label=\"Side view") + count_of(page, "aria-label=\"Fields of"));
  EXPECT_THAT(page, HasSubstr("through the baselines, over the first. At last: column_collapse/a_1: 1.0"));
  EXPECT_EQ(count_of(page, "aria-label=\"Side view"), 3u);  // a code each
  EXPECT_EQ(count_of(page, "aria-label=\"Fields of"), 9u);  // at three moments each
  EXPECT_THAT(page, Not(HasSubstr("could not be drawn")));
  EXPECT_THAT(page, ContainsRegex("id=\"notice\"[^>]*hidden"));
  EXPECT_THAT(page, Not(HasSubstr("undefined")));
  EXPECT_THAT(page, Not(HasSubstr("NaN")));
}

TEST_F(Report, SaysWhyStaleResultsDoNotPassAndFoldsLongChangesAway) {
  auto results = testing::sample_results();
  results["stale"] = "the program talus has changed";
  results["drift"]["why"] = "nothing moved";
  auto& changes = results["history"][0]["changes"];
  while (changes.size() < 12) changes.push_back(changes[0]);
  const std::string page = visible(viewed(results, testing::sample_pictures(), "").document);
  EXPECT_THAT(
      page,
      HasSubstr(
          "role=\"alert\">These results are stale, so neither gate passes: the program talus has changed."));
  EXPECT_THAT(page, HasSubstr("inconclusive. Nothing moved. Baseline accepted"));
  EXPECT_THAT(page, HasSubstr("<summary>12 values</summary>"));
  EXPECT_EQ(count_of(page, " values</summary>"), 1u) << "few changes stand open";
}

TEST_F(Report, PointsAreDrawnWhenOpened) {
  const auto results = testing::sample_results();
  const auto pictures = testing::sample_pictures();
  const std::string closed = visible(viewed(results, pictures, "").document);
  EXPECT_THAT(closed, HasSubstr(charts(summary_charts)));
  EXPECT_THAT(closed, Not(HasSubstr("Uncertainty budget")));
  const std::string by_link = visible(viewed(results, pictures, "#point-slot-opening_8d").document);
  EXPECT_THAT(by_link, HasSubstr(charts(summary_charts + 1)));
  const std::string by_hand =
      visible(viewed(results, pictures, "", "document.querySelector('#point-heap-radius_8d summary').click()")
                  .document);
  EXPECT_THAT(by_hand, HasSubstr(charts(summary_charts + 1)));
  const std::string for_paper =
      visible(viewed(results, pictures, "", "dispatchEvent(new Event('beforeprint'))").document);
  EXPECT_THAT(for_paper, HasSubstr(charts(all_charts)));
}

TEST_F(Report, LinksLeadSomewhere) {
  const std::string page = visible(viewed(testing::sample_results(), testing::sample_pictures()).document);
  const auto ids = all_matches(page, " id=\"([^\"]*)\"");
  const auto targets = all_matches(page, "href=\"#([^\"]*)\"");
  EXPECT_EQ(std::set(ids.begin(), ids.end()).size(), ids.size());  // no two alike
  EXPECT_GE(targets.size(), 8u + 3 * 4u);                          // contents; points in four tables
  for (const auto& target : targets) EXPECT_EQ(ids.count(target), 1u) << target;
  EXPECT_EQ(count_of(page, " href="), targets.size());  // and none leaves the page
}

TEST_F(Report, AsksTheNetworkForNothing) {
  const BrowserView view = viewed(testing::sample_results(), testing::sample_pictures());
  const std::string page = visible(view.document);
  // The browser has written all attributes in lower case and with double quotes.
  EXPECT_THAT(page, Not(ContainsRegex(" (src|srcset|href|action|data|poster)=\"(https?:|//|file:)")));
  EXPECT_THAT(page, Not(HasSubstr("url(")));
  EXPECT_THAT(page, Not(HasSubstr("@import")));
  EXPECT_EQ(count_of(page, "<link"), 0u);
  EXPECT_THAT(view.document, Not(ContainsRegex("<script[^>]* src")));
  EXPECT_THAT(view.document, HasSubstr("default-src 'none'"));              // and the browser would refuse it
  EXPECT_THAT(view.document, HasSubstr("Released under the MIT License"));  // Chart.js keeps its licence
}

TEST_F(Report, ControlsWork) {
  const std::string script = R"(
    const seen = [];
    const flow = document.querySelector('.flow');
    const slider = flow.querySelector('input[type=range]');
    const caption = () => flow.querySelector('figcaption').textContent;
    const picture = (k) => flow.querySelectorAll('canvas')[k].toDataURL();
    seen.push('last:' + caption());
    const before = picture(0);
    slider.value = 0;
    slider.dispatchEvent(new Event('input'));
    seen.push('first:' + caption() + ':' + slider.getAttribute('aria-valuetext') + ':' + (picture(0) !== before));
    const placed = picture(1);
    flow.querySelector('input[value=speed]').click();
    seen.push('speed:' + flow.querySelector('.key').textContent + ':' + (picture(1) !== placed));
    const field = document.querySelector('.fields canvas');
    const fast = field.toDataURL();
    document.querySelector('.fields input[value=volume_fraction]').click();
    seen.push('fraction:' + (field.toDataURL() !== fast));
    const chooser = document.querySelector('select');
    chooser.value = 'repose_angle';
    chooser.dispatchEvent(new Event('change'));
    seen.push('chosen:' + document.querySelectorAll('#scatter figcaption')[1].textContent);
    const line = document.querySelector('#discharge canvas');
    const three = line.toDataURL();
    document.querySelector('#discharge .legend button').click();
    seen.push('legend:' + document.querySelector('#discharge .legend button').getAttribute('aria-pressed') + ':' + (line.toDataURL() !== three));
    document.body.dataset.seen = seen.join(' | ');
    document.body.dataset.errors = window.reportErrors;
  )";
  const BrowserView view = viewed(testing::sample_results(), testing::sample_pictures(), every_point, script);
  const std::string page = visible(view.document);
  for (const char* outcome : {"last:Continuumseed 1, t = 0.700 s, 800 of 2", "first:Continuumseed 1, t = 0 s",
                              ":t = 0 s:true", "speed:speed 0", "m/s:true", "fraction:true",
                              "chosen:Continuum against DEM reference: repose angle.", "legend:false:true"}) {
    EXPECT_THAT(page, HasSubstr(outcome));
  }
  EXPECT_THAT(page, HasSubstr(no_errors));
}

/// As an attribute's value.
std::string quoted(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string(1, c);
  return out;
}

// Chromium's window is no narrower than 500 pixels, a frame is; 15 of its 375 go to the scroll bar.
TEST_F(Report, FitsAPhone) {
  const auto file = folder.path() / "report.html", outer = folder.path() / "phone.html";
  write_report(testing::sample_results(), testing::sample_pictures(), file);
  write_file_atomically(
      outer, fmt::format(R"(<body><iframe width=375 height=800 style="border:0" srcdoc="{}"></iframe><script>
      addEventListener('load', () => {{
        const page = document.querySelector('iframe').contentDocument;
        page.querySelector('#open-all').click();
        document.body.dataset.widths = page.documentElement.scrollWidth + ' in ' + page.documentElement.clientWidth + ' with ' + page.body.dataset.charts;
      }});</script></body>)",
                         quoted(read_file(file))));
  EXPECT_THAT(visible(testing::view_page(outer.string()).document),
              HasSubstr(fmt::format("data-widths=\"360 in 360 with {}\"", all_charts)));
}

TEST_F(Report, ManyPointsStayBelowTheLimit) {
  constexpr int count = 25;
  constexpr std::uintmax_t limit = 12'000'000;  // bytes
  const BrowserView view = viewed(testing::many_points(count), testing::many_pictures(count));
  EXPECT_LT(std::filesystem::file_size(folder.path() / "report.html"), limit);
  EXPECT_THAT(visible(view.document), HasSubstr(charts(all_charts + (count - 3) * 7)));
  EXPECT_THAT(visible(view.document), HasSubstr(no_errors));
}

TEST_F(Report, UnwritablePlace) {
  EXPECT_THROW(
      write_report(testing::sample_results(), json::array(), folder.path() / "absent" / "report.html"),
      InputError);
}

}  // namespace
}  // namespace talus
