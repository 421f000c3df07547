// Render points on disk: what a run writes, what comes back, and that points stay who they are.
#include "continuum/render/render_file.h"

#include <H5Cpp.h>
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <set>

#include "analysis/snapshot.h"
#include "continuum/files/atomic_file.h"
#include "tests/continuum/render/heap.h"

namespace talus {
namespace {

using ::testing::HasSubstr;
using testing::input_error;
using testing::run_scene;
using testing::TestFolder;
namespace fs = std::filesystem;

RenderFrame small_frame(double time, Eigen::Index count) {
  RenderFrame frame{time, Eigen::Matrix3Xf::Random(3, count), Eigen::Matrix3Xf::Random(3, count), {}, {}, {}};
  for (Eigen::Index k = 0; k < count; ++k) {
    frame.identities.push_back(4294967295u - static_cast<std::uint32_t>(k));
    frame.materials.push_back(static_cast<std::uint8_t>(255 - k));
    frame.speeds.push_back(0.25f * static_cast<float>(k));
  }
  return frame;
}

void expect_equal(const RenderFrame& a, const RenderFrame& b) {
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.identities, b.identities);
  EXPECT_EQ(a.materials, b.materials);
  EXPECT_EQ(a.speeds, b.speeds);
}

TEST(RenderFile, WhatGoesInComesOut) {
  const TestFolder folder;
  const auto file = folder.path() / "render.h5";
  const std::vector<RenderFrame> frames{small_frame(0.0, 7), small_frame(1.0 / 24.0, 0), small_frame(0.1, 3)};
  RenderWriter writer(file, 12.5, "a test");
  for (const auto& frame : frames) writer.append(frame);
  EXPECT_FALSE(fs::exists(file));
  EXPECT_THAT(input_error([&] { RenderReader{file}; }), HasSubstr("no such file"));
  writer.finish();
  const RenderReader reader(file);
  EXPECT_EQ(reader.points_per_volume(), 12.5);
  ASSERT_EQ(reader.frame_count(), frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(reader.time(i), frames[i].time);
    expect_equal(reader.read(i), frames[i]);
  }
}

TEST(RenderFile, OtherFilesAreRefused) {
  const TestFolder folder;
  const auto file = folder.path() / "render.h5";
  write_file_atomically(file, "not HDF5");
  EXPECT_THAT(input_error([&] { RenderReader{file}; }), HasSubstr("not a file of render points"));
  analysis::write_snapshots(file, {}, "a test");
  EXPECT_THAT(input_error([&] { RenderReader{file}; }), HasSubstr("no format = \"talus-render-points\""));
}

TEST(RenderFile, ClaimsAreNotBelieved) {
  const TestFolder folder;
  const auto file = folder.path() / "render.h5";
  const auto spoil = [&](auto&& change) {
    RenderWriter writer(file, 1.0, "a test");
    writer.append({0.5, Eigen::Matrix3Xf::Zero(3, 1), Eigen::Matrix3Xf::Zero(3, 1), {7}, {0}, {1.0f}});
    writer.finish();
    H5::H5File hdf5(file.string(), H5F_ACC_RDWR);
    change(hdf5);
  };
  spoil([](H5::H5File& hdf5) {  // 4 TB, none of which was ever written
    constexpr hsize_t rows = 1'000'000'000'000, chunk = 1000;
    H5::DSetCreatPropList layout;
    layout.setChunk(1, &chunk);
    hdf5.unlink("frame_000000/speeds");
    hdf5.createDataSet("frame_000000/speeds", H5::PredType::IEEE_F32LE, H5::DataSpace(1, &rows), layout);
  });
  EXPECT_THAT(input_error([&] { RenderReader(file).read(0); }), HasSubstr("more than the file can hold"));
  spoil([](H5::H5File& hdf5) {
    constexpr hsize_t many = 4000;
    hdf5.removeAttr("frames");
    hdf5.createAttribute("frames", H5::PredType::NATIVE_INT, H5::DataSpace(1, &many))
        .write(H5::PredType::NATIVE_INT, std::vector<int>(many).data());
  });
  EXPECT_THAT(input_error([&] { RenderReader{file}; }), HasSubstr("attribute frames is not one value"));
  std::filesystem::copy_file(TALUS_SOURCE_DIR "/tests/analysis/data/hdf5_hangs.h5", file,
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(input_error([&] { RenderReader{file}; }), HasSubstr("HDF5 crashes or hangs over it"));
}

/// The column of each identity; the test fails where one is there twice.
std::map<std::uint32_t, Eigen::Index> by_identity(const RenderFrame& frame) {
  std::map<std::uint32_t, Eigen::Index> columns;
  for (std::size_t k = 0; k < frame.count(); ++k)
    EXPECT_TRUE(columns.emplace(frame.identities[k], static_cast<Eigen::Index>(k)).second);
  return columns;
}

TEST(RenderFile, ARunWritesAFrameWithEachSnapshot) {
  const TestFolder folder;
  const auto run = run_scene(folder.path(), testing::with_points);
  const auto snapshots = analysis::read_snapshots(run / "snapshots.h5");
  const RenderReader reader(run / "render.h5");
  ASSERT_EQ(reader.frame_count(), snapshots.size());
  ASSERT_EQ(reader.frame_count(), 4u);  // 0, 0.02, 0.04 and the end, 0.05 s
  const std::string xdmf = read_file(run / "render.xdmf");
  for (std::size_t i = 0; i < snapshots.size(); ++i) {
    const RenderFrame frame = reader.read(i);
    EXPECT_EQ(frame.time, snapshots[i].time);
    EXPECT_THAT(xdmf, HasSubstr(fmt::format("<Time Value=\"{}\"/>", frame.time)));
    EXPECT_THAT(
        xdmf, HasSubstr(fmt::format("Dimensions=\"{} 3\">render.h5:/frame_{:06}/normals", frame.count(), i)));
    EXPECT_GT(frame.count(), 10000u);
    EXPECT_LT((frame.normals.colwise().norm().array() - 1.0f).abs().maxCoeff(), 1e-5f);
    EXPECT_GT(frame.positions.row(2).minCoeff(), -1e-6f);  // none below the floor
    const float fastest = *std::max_element(frame.speeds.begin(), frame.speeds.end());
    EXPECT_LE(fastest, snapshots[i].velocities.colwise().norm().maxCoeff() * (1.0 + 1e-6));
    EXPECT_EQ(std::count(frame.materials.begin(), frame.materials.end(), 0), frame.count());
  }
  // Out of the sand: up on top of it, at the start.
  const RenderFrame start = reader.read(0);
  Eigen::Vector3f mean_normal = Eigen::Vector3f::Zero();
  for (Eigen::Index k = 0; k < start.positions.cols(); ++k) {
    if (start.positions(2, k) > 0.037f) mean_normal += start.normals.col(k);
  }
  EXPECT_GT(mean_normal.normalized()[2], 0.99f);
}

TEST(RenderFile, PointsKeepTheirIdentityAndMoveNoFartherThanSandDoes) {
  const TestFolder folder;
  const auto run = run_scene(folder.path(), testing::with_points);
  const RenderReader reader(run / "render.h5");
  for (std::size_t i = 1; i < reader.frame_count(); ++i) {
    const RenderFrame before = reader.read(i - 1), now = reader.read(i);
    const auto columns = by_identity(now);
    const double fastest = std::max(*std::max_element(before.speeds.begin(), before.speeds.end()),
                                    *std::max_element(now.speeds.begin(), now.speeds.end()));
    const double farthest =
        2.0 * fastest * (now.time - before.time);  // between frames it may have been faster
    std::size_t kept = 0, far = 0;
    for (const auto& [identity, column] : by_identity(before)) {
      const auto found = columns.find(identity);
      if (found == columns.end()) continue;
      ++kept;
      far += (now.positions.col(found->second) - before.positions.col(column)).norm() > farthest ? 1 : 0;
    }
    EXPECT_GT(kept, 0.97 * static_cast<double>(before.count()));  // the others became buried, or left
    EXPECT_LT(far, 0.02 * static_cast<double>(kept));             // sampled anew in their particle
  }
}

TEST(RenderFile, ThreadsChangeNothing) {
  const TestFolder one, two;
  const RenderReader a(run_scene(one.path(), testing::with_points) / "render.h5"),
      b(run_scene(two.path(), testing::with_points, {"--threads", "2"}) / "render.h5");
  ASSERT_EQ(a.frame_count(), b.frame_count());
  for (std::size_t i = 0; i < a.frame_count(); ++i) expect_equal(a.read(i), b.read(i));
}

TEST(RenderFile, ARunThatAsksForNoneLeavesNone) {
  const TestFolder folder;
  const auto run = run_scene(folder.path(), testing::with_points);
  EXPECT_TRUE(fs::exists(run / "render.h5"));
  run_scene(folder.path(), testing::block_scene);
  EXPECT_FALSE(fs::exists(run / "render.h5"));
  EXPECT_FALSE(fs::exists(run / "render.xdmf"));
  EXPECT_EQ(read_file(run / "run.toml"), testing::block_scene);
}

}  // namespace
}  // namespace talus
