// What the report's pictures hold, unpacked again.
#include "validation/pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/evp.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <stdexcept>

namespace talus::validation {
namespace {

using analysis::Snapshot;
using analysis::SnapshotSeries;
using nlohmann::json;

constexpr double thickness = 0.01;  // m

/// The packed numbers of `text`, `size` bytes each, over `range`.
std::vector<double> unpacked(const json& text, std::size_t size, const json& range) {
  const auto packed = text.get<std::string>();
  std::vector<unsigned char> bytes(3 * packed.size() / 4);
  EVP_DecodeBlock(bytes.data(), reinterpret_cast<const unsigned char*>(packed.data()),
                  static_cast<int>(packed.size()));
  bytes.resize(bytes.size() - static_cast<std::size_t>(std::count(packed.begin(), packed.end(), '=')));
  const double low = range[0], high = range[1];
  std::vector<double> values;
  for (std::size_t k = 0; k + size <= bytes.size(); k += size) {
    const double level = size == 2 ? (bytes[k] + 256.0 * bytes[k + 1]) / 65535.0 : bytes[k] / 255.0;
    values.push_back(low + (high - low) * level);
  }
  return values;
}

/// A row of `count` items 1 mm apart that all move along x at 0.1 m/s, in `frames` snapshots 10 ms apart.
SnapshotSeries moving_row(Eigen::Index count, int frames) {
  SnapshotSeries series;
  for (int k = 0; k < frames; ++k) {
    Snapshot snapshot{0.01 * k, analysis::Vectors::Zero(3, count), analysis::Vectors::Zero(3, count),
                      Eigen::VectorXd::Constant(count, 1e-9)};
    for (Eigen::Index i = 0; i < count; ++i) {
      snapshot.positions.col(i) << 0.001 * (static_cast<double>(i) + 0.5) + 0.001 * k, 0.009, 0.0025;
      snapshot.velocities(0, i) = 0.1;
    }
    series.push_back(snapshot);
  }
  return series;
}

PictureOptions options() {
  PictureOptions options;
  options.name = "case/point";
  options.code = "yade";
  options.seed = 7;
  options.thickness = thickness;
  options.field_spacing = 0.005;
  return options;
}

TEST(Pictures, HoldWhatTheSeriesHolds) {
  const auto series = moving_row(50, 23);
  const json picture = picture_of_series(series, options());
  EXPECT_EQ(picture["name"], "case/point");
  EXPECT_EQ(picture["code"], "yade");
  EXPECT_EQ(picture["seed"], 7);
  ASSERT_EQ(picture["moments"].size(), 12u);
  const json& ranges = picture["ranges"];
  for (std::size_t k = 0; k < 12; ++k) {
    const json& moment = picture["moments"][k];
    EXPECT_DOUBLE_EQ(moment["time"], 0.02 * static_cast<double>(k));
    EXPECT_EQ(moment["count"], 50);
    const auto x = unpacked(moment["x"], 2, ranges["x"]),
               start = unpacked(moment["start_x"], 1, ranges["start_x"]);
    const auto radius = unpacked(moment["radius"], 1, ranges["radius"]),
               speed = unpacked(moment["speed"], 1, ranges["speed"]);
    ASSERT_EQ(x.size(), 50u);
    for (std::size_t i = 0; i < 50; ++i) {
      const double first = 0.001 * (static_cast<double>(i) + 0.5);
      EXPECT_NEAR(x[i], first + 0.002 * static_cast<double>(k), 0.08 / 65535.0);
      EXPECT_NEAR(start[i], first, 0.05 / 255.0);
      EXPECT_NEAR(radius[i], std::cbrt(0.75e-9 / std::numbers::pi), 1e-12);
      EXPECT_NEAR(speed[i], 0.1, 1e-12);
    }
    for (const double z : unpacked(moment["z"], 2, ranges["z"])) EXPECT_DOUBLE_EQ(z, 0.0025);
  }
}

TEST(Pictures, ThinTheSameItemsAtEveryMoment) {
  auto asked = options();
  asked.items = 100;
  asked.packing = 0.5;
  const json picture = picture_of_series(moving_row(1000, 5), asked);
  std::vector<double> before;
  for (const json& moment : picture["moments"]) {
    EXPECT_EQ(moment["count"], 1000);
    const auto start = unpacked(moment["start_x"], 1, picture["ranges"]["start_x"]);
    EXPECT_EQ(start.size(), 100u);
    if (!before.empty()) {
      EXPECT_EQ(start, before);
    }
    before = start;
    // Evenly over all of them.
    EXPECT_NEAR(std::accumulate(start.begin(), start.end(), 0.0) / 100.0, 0.5, 0.01);
    // The discs of those that are drawn cover what all of them would, and half as much again.
    const double radius = unpacked(moment["radius"], 1, picture["ranges"]["radius"])[0];
    EXPECT_NEAR(100 * std::numbers::pi * radius * radius, 1.5 * 1000 * 1e-9 / 0.5 / thickness, 1e-9);
  }
}

TEST(Pictures, SliceShowsItsOwnItemsOnly) {
  auto series = moving_row(40, 3);
  for (auto& snapshot : series) {
    for (Eigen::Index i = 0; i < 40; ++i) snapshot.positions(1, i) = i % 4 == 0 ? -0.001 : 0.02;
  }
  auto asked = options();
  asked.slice_half_width = 0.0015;
  const json picture = picture_of_series(series, asked);
  EXPECT_EQ(picture["moments"][2]["count"], 10);
  const auto start = unpacked(picture["moments"][2]["start_x"], 1, picture["ranges"]["start_x"]);
  ASSERT_EQ(start.size(), 10u);
  for (std::size_t k = 0; k < 10; ++k)
    EXPECT_NEAR(start[k], 0.004 * static_cast<double>(k) + 0.0005, 0.04 / 255.0);
}

TEST(Pictures, FieldsConserveVolumeAndCarryTheSpeed) {
  const auto series = moving_row(50, 9);
  const json fields = picture_of_series(series, options())["fields"];
  ASSERT_EQ(fields["moments"].size(), 3u);
  EXPECT_EQ(fields["origin"], (json{0.0, 0.0}));
  const double cell = 0.005 * 0.005 * thickness;
  for (const json& moment : fields["moments"]) {
    const auto fraction = unpacked(moment["volume_fraction"], 1, fields["ranges"]["volume_fraction"]);
    ASSERT_EQ(fraction.size(), fields["cells"][0].get<std::size_t>() * fields["cells"][1].get<std::size_t>());
    const double half_level = 0.5 / 255.0;
    EXPECT_NEAR(std::accumulate(fraction.begin(), fraction.end(), 0.0) * cell, 50e-9,
                static_cast<double>(fraction.size()) * half_level * cell);
    const auto speed = unpacked(moment["speed"], 1, fields["ranges"]["speed"]);
    EXPECT_NEAR(*std::max_element(speed.begin(), speed.end()), 0.1, 1e-9);
  }
  EXPECT_DOUBLE_EQ(fields["moments"][0]["time"], 0.01);
  EXPECT_DOUBLE_EQ(fields["moments"][2]["time"], 0.03);
}

TEST(Pictures, StartPositionsFollowItemsThatSplitMergeAndLeave) {
  auto series = moving_row(30, 6);
  auto& last = series[5];
  // Item 3 splits at frame 3; at frame 5 the first five have left.
  for (std::size_t k = 3; k < 6; ++k) {
    const auto old = series[k];
    series[k] = moving_row(31, 6)[k];
    series[k].positions.col(30) = old.positions.col(3) + Eigen::Vector3d(1e-5, 0.0, 0.0);
  }
  last = {last.time, analysis::Vectors(last.positions.rightCols(26)),
          analysis::Vectors(last.velocities.rightCols(26)), Eigen::VectorXd(last.volumes.tail(26))};
  const auto starts = start_positions(series);
  ASSERT_EQ(starts.back().size(), 26);
  for (Eigen::Index i = 0; i < 25; ++i)
    EXPECT_DOUBLE_EQ(starts.back()[i], 0.001 * (static_cast<double>(i) + 5.5));
  EXPECT_DOUBLE_EQ(starts.back()[25], 0.0035);
}

TEST(Pictures, StartPositionsNoticeItemsThatChangedPlaces) {
  auto series = moving_row(30, 4);
  series[2].positions.col(0).swap(series[2].positions.col(20));
  series[3].positions.col(0).swap(series[3].positions.col(20));
  const auto starts = start_positions(series);
  EXPECT_DOUBLE_EQ(starts[3][0], 0.0205);
  EXPECT_DOUBLE_EQ(starts[3][20], 0.0005);
}

TEST(Pictures, AnEmptiedBoxIsDrawnEmpty) {
  auto series = moving_row(10, 5);
  for (std::size_t k = 3; k < 5; ++k)
    series[k] = {series[k].time, analysis::Vectors(3, 0), analysis::Vectors(3, 0), Eigen::VectorXd(0)};
  auto asked = options();
  asked.field_times = {0.0, 1.0};
  const json picture = picture_of_series(series, asked);
  EXPECT_EQ(picture["moments"].back()["count"], 0);
  EXPECT_EQ(picture["moments"].back()["x"], "");
  EXPECT_EQ(picture["fields"]["moments"].size(), 1u);
}

TEST(Pictures, RefuseWhatMakesNoSense) {
  const auto series = moving_row(5, 3);
  EXPECT_THROW(picture_of_series({}, options()), std::invalid_argument);
  for (const auto& spoil : std::vector<void (*)(PictureOptions&)>{
           [](PictureOptions& o) { o.thickness = 0.0; }, [](PictureOptions& o) { o.field_spacing = -1.0; },
           [](PictureOptions& o) { o.moments = 1; }, [](PictureOptions& o) { o.items = 0; },
           [](PictureOptions& o) { o.packing = 1.2; }, [](PictureOptions& o) { o.slice_half_width = 0.0; }}) {
    auto asked = options();
    spoil(asked);
    EXPECT_THROW(picture_of_series(series, asked), std::invalid_argument);
  }
}

}  // namespace
}  // namespace talus::validation
