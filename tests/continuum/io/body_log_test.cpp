// Rows of bodies: one each, with means of what the sand did since the last ones.
#include "continuum/io/body_log.h"

#include <gmock/gmock.h>

#include <sstream>

#include "continuum/scene/scene.h"

namespace talus {
namespace {

using Row = std::vector<std::string>;

std::vector<Row> cells_of(const std::string& text) {
  std::vector<Row> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

TEST(BodyLog, HasARowForEachWithMeansSinceTheLast) {
  State state = initial_state(read_scene(TALUS_SOURCE_DIR "/tests/continuum/data/small_column.toml"));
  state.bodies = {make_body("ball", {Sphere{{0.1, 0.2, 0.3}, 0.05}}, 1000.0, Free{}, {{1, 2, 3}, {4, 5, 6}}),
                  make_body("box", {Box{{0.5, 0, 0}, {0.1, 0.1, 0.1}}}, 1000.0)};
  state.time = 0.25;
  BodyLog log;
  const auto first = cells_of(log.rows(state));
  const Row columns = cells_of(BodyLog::header()).at(0);
  ASSERT_EQ(first.size(), 2U);
  for (const Row& row : first) EXPECT_EQ(row.size(), columns.size());
  EXPECT_THAT(first[0], ::testing::ElementsAre("0.25", "ball", "0.1", "0.2", "0.3", "1", "0", "0", "0", "1",
                                               "2", "3", "4", "5", "6", "0", "0", "0", "0", "0", "0"));
  EXPECT_EQ(first[1][1], "box");
  StepReport report;
  report.dt = 0.5;
  report.on_bodies.resize(2);
  report.on_bodies[1].linear = {1, 0, -2};
  report.on_bodies[1].angular = {0, 3, 0};
  log.add(report);
  report.dt = 1.5;
  report.on_bodies[1].linear = {0, 0, -6};
  log.add(report);
  const auto second = cells_of(log.rows(state));
  const Row forces(second[1].end() - 6, second[1].end());
  EXPECT_THAT(forces, ::testing::ElementsAre("0.5", "0", "-4", "0", "3", "0"));
  const auto third = cells_of(log.rows(state));
  EXPECT_EQ(third[1].back(), "0");
  EXPECT_EQ(third[1][17], "0");  // the means start anew
}

}  // namespace
}  // namespace talus
