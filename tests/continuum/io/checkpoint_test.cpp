// A state that went through a checkpoint goes on as the state itself, bit for bit; a file that is not whole is never taken for one.
#include "continuum/io/checkpoint.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <random>

#include "continuum/files/atomic_file.h"
#include "continuum/files/provenance.h"
#include "continuum/io/archive.h"
#include "continuum/io/state_archive.h"
#include "tests/continuum/scenes.h"
#include "tests/test_folder.h"

namespace talus {
namespace {

using ::testing::HasSubstr;

const std::string everything = TALUS_SOURCE_DIR "/tests/continuum/data/everything.toml";

Scene scene_of(Scheme scheme, Transfer transfer) {
  Scene scene = read_scene(everything);
  scene.settings.scheme = scheme;
  scene.settings.transfer = transfer;
  return scene;
}

/// Steps of at most 2 ms, as many as are asked for.
void take_steps(const Scene& scene, int count, State& state) {
  for (int i = 0; i < count; ++i) step(state, scene.settings, 0.002);
}

State went_through_a_file(const Scene& scene, const State& state) {
  const testing::TestFolder folder;
  write_checkpoint(folder.path(), make_checkpoint({}, {}, state, Budget(state), {}));
  std::string told;
  const Checkpoint checkpoint = read_checkpoint(folder.path(), told);
  EXPECT_EQ(told, "");
  State read = initial_state(scene);
  restore(checkpoint.state, "checkpoint", read);
  return read;
}

/// By the end the gate has opened, the explosion has been, the source has run dry and all bodies have moved.
void expect_no_difference(const Scene& scene, const std::vector<int>& splits) {
  constexpr int steps = 40;
  State straight = initial_state(scene);
  take_steps(scene, steps, straight);
  ASSERT_GT(straight.time, 0.04);
  for (const int split : splits) {
    State state = initial_state(scene);
    take_steps(scene, split, state);
    State resumed = went_through_a_file(scene, state);
    EXPECT_EQ(digest_of(resumed), digest_of(state)) << split;
    take_steps(scene, steps - split, resumed);
    EXPECT_EQ(digest_of(resumed), digest_of(straight)) << split;
  }
}

TEST(Checkpoint, ASplitRunEqualsTheStraightOneBitForBit) {
  expect_no_difference(scene_of(Scheme::consistent, Transfer::flip), {0, 1, 7, 20, 39});
}
TEST(Checkpoint, SoDoesOneThatCarriesVelocityGradients) {
  expect_no_difference(scene_of(Scheme::consistent, Transfer::apic), {25});
}
TEST(Checkpoint, SoDoesOneByTheSchemeOfTheSource) {
  expect_no_difference(scene_of(Scheme::paper, Transfer::flip), {15});
}

TEST(Checkpoint, TheDigestTellsTheLastBit) {
  const Scene scene = scene_of(Scheme::consistent, Transfer::flip);
  State state = initial_state(scene);
  take_steps(scene, 3, state);
  const std::string before = digest_of(state);
  double& x = state.particles.positions(0, 17);
  x = std::nextafter(x, 1.0);
  EXPECT_NE(digest_of(state), before);
}

class CheckpointFile : public ::testing::Test {
 protected:
  CheckpointFile() : scene_(read_scene(TALUS_SOURCE_DIR "/tests/continuum/data/small_column.toml")) {
    State state = initial_state(scene_);
    for (int steps = 2; steps <= 4; steps += 2) {
      take_steps(scene_, 2, state);
      write_checkpoint(folder_.path(), make_checkpoint({}, {3, steps, 0, 0, 0}, state, Budget(state), {}));
    }
    whole_ = read_file(newest());
  }
  std::filesystem::path newest() const { return folder_.path() / checkpoint_name; }
  std::filesystem::path previous() const { return folder_.path() / previous_checkpoint_name; }
  void spoil(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
  }
  std::string error_of_reading() {
    std::string told;
    return testing::input_error([&] { read_checkpoint(folder_.path(), told); });
  }

  testing::TestFolder folder_;
  Scene scene_;
  std::string whole_;
};

TEST_F(CheckpointFile, TheNewestIsRead) {
  std::string told;
  EXPECT_EQ(read_checkpoint(folder_.path(), told).progress.steps, 4);
}

TEST_F(CheckpointFile, AnyByteThatIsOffOrMissingIsSeenAndTheOneBeforeIsRead) {
  for (std::size_t at = 0; at < whole_.size(); at += 1 + at / 7) {
    std::string off = whole_;
    off[at] = static_cast<char>(off[at] ^ 0x10);
    for (const std::string& text : {off, whole_.substr(0, at)}) {
      std::filesystem::remove(newest());  // the two may be one file with two names
      spoil(newest(), text);
      std::string told;
      EXPECT_EQ(read_checkpoint(folder_.path(), told).progress.steps, 2) << at;
      EXPECT_THAT(told, HasSubstr(checkpoint_name)) << at;
    }
  }
}

TEST_F(CheckpointFile, WithoutAWholeOneTheErrorNamesWhatIsWrongWithEach) {
  std::filesystem::remove(newest());
  spoil(newest(), "not ours");
  spoil(previous(), "talus-checkpoint 99 sha256 0\n");
  EXPECT_THAT(error_of_reading(), HasSubstr("checkpoint.talus: not a file of ours"));
  EXPECT_THAT(error_of_reading(), HasSubstr("checkpoint.previous.talus: of another version"));
  remove_checkpoints(folder_.path());
  EXPECT_THAT(error_of_reading(), HasSubstr("no checkpoint of an unfinished run is here"));
}

/// The SHA-256 is right in what somebody has made up.
TEST_F(CheckpointFile, WhatIsNoStateOfTheSceneIsRefused) {
  std::string told;
  const nlohmann::json right = read_checkpoint(folder_.path(), told).state;
  const auto error_with = [&](const std::string& name, const nlohmann::json& value) {
    nlohmann::json fields = right;
    EXPECT_TRUE(fields.contains(name)) << name;
    if (value.is_null())
      fields.erase(name);
    else
      fields[name] = value;
    State state = initial_state(scene_);
    return testing::input_error([&] { restore(fields, "FILE", state); });
  };
  const auto list = [](auto... values) {
    const std::vector values_there{values...};
    ArchiveWriter writer;
    writer.list("list", values_there);
    return writer.fields().at("list");
  };
  EXPECT_THAT(error_with("time", nullptr), HasSubstr("FILE: field time is missing"));
  EXPECT_THAT(error_with("time", -1.0), HasSubstr("time is no time of a run"));
  EXPECT_THAT(error_with("particles/masses", list(1.0, 2.0)), HasSubstr("differs in length"));
  EXPECT_THAT(error_with("particles/masses", nlohmann::json::binary({1, 2, 3})),
              HasSubstr("no whole number"));
  EXPECT_THAT(error_with("particles/masses", 3), HasSubstr("of the wrong kind"));
  EXPECT_THAT(error_with("render_points/offsets", list(1.0f, 1.0f, 1.0f)), HasSubstr("render points"));
  EXPECT_THAT(error_with("render_points/next_identity", -1), HasSubstr("beyond what this program can hold"));
  EXPECT_THAT(error_with("bodies", list(std::vector<double>(14).size())), HasSubstr("bodies"));
  EXPECT_THAT(error_with("source_layers", list(std::int64_t{1})), HasSubstr("of other sources"));
  EXPECT_THAT(error_with("walls", "another"), HasSubstr("have its meshes changed?"));
  EXPECT_THAT(error_with("lipschitz", 0.0), HasSubstr("is not positive"));
  EXPECT_THAT(error_with("warm_start/cells", list(5, 5)), HasSubstr("warm_start/cells"));
  EXPECT_THAT(error_with("warm_start/cells", list(-1)), HasSubstr("warm_start/cells"));
  EXPECT_THAT(error_with("warm_start/pressure", list(1.0)), HasSubstr("wrong size for its cells"));
  EXPECT_THAT(error_with("warm_start/wall_axes", list(3)), HasSubstr("warm_start/wall_axes"));
  EXPECT_THAT(error_with("warm_start/open_faces", 1'000'000), HasSubstr("warm_start/open_faces"));
}

/// One field of a state, changed in a way that nobody thought of.
void spoil(std::mt19937& random, nlohmann::json& fields) {
  auto at = fields.begin();
  std::advance(at, random() % fields.size());
  if (at->is_number()) {
    constexpr std::array<double, 6> numbers{-1.0,
                                            0.0,
                                            1e300,
                                            -1e300,
                                            std::numeric_limits<double>::infinity(),
                                            std::numeric_limits<double>::quiet_NaN()};
    *at = numbers[random() % numbers.size()];
  } else if (at->is_boolean()) {
    *at = !at->get<bool>();
  } else if (at->is_binary() && !at->get_binary().empty()) {
    auto& bytes = at->get_binary();
    const std::size_t place = random() % bytes.size();
    switch (random() % 4) {
      case 0:
        bytes.resize(place - place % 8);
        break;
      case 1:
        bytes.insert(bytes.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(place));
        break;
      case 2:
        for (std::size_t i = place; i < std::min(place + 8, bytes.size()); ++i)
          bytes[i] = static_cast<std::uint8_t>(random());
        break;
      default:
        std::fill(bytes.begin(), bytes.end(), std::uint8_t{0xff});
    }
  } else {
    *at = 7;
  }
}

/// TALUS_SPOILT_STATES says how many; default 300.
TEST(SpoiltState, IsRefusedOrSteppedOnButNeverACrash) {
  const Scene scene = read_scene(everything);
  State state = initial_state(scene);
  take_steps(scene, 8, state);
  const nlohmann::json right = archive_of(state);
  const State start = initial_state(scene);
  const char* wanted = std::getenv("TALUS_SPOILT_STATES");
  const int count = wanted ? std::atoi(wanted) : 300;
  std::mt19937 random(1);
  int refused = 0, faults = 0;
  for (int i = 0; i < count; ++i) {
    nlohmann::json fields = right;
    spoil(random, fields);
    State spoilt = start;
    try {
      restore(fields, "FILE", spoilt);
      step(spoilt, scene.settings, 0.002);
    } catch (const InputError&) {
      ++refused;
    } catch (const NumericalError&) {
      ++faults;
    }
  }
  std::printf("%d states: %d refused, %d stopped by a fault in their step\n", count, refused, faults);
  EXPECT_GT(refused, count / 4);
}

TEST(Archive, ADeeplyNestedFileIsRefused) {
  const std::string nested(1'000'000, '\x81');  // CBOR: a list that holds a list that holds ...
  nlohmann::json fields;
  const std::string whole = packed_archive("name", 1, fields);
  const std::string error = testing::input_error([&] {
    unpacked_archive("name", 1, fmt::format("name 1 sha256 {}\n{}", sha256(nested), nested), "FILE");
  });
  EXPECT_THAT(error, HasSubstr("no flat object"));
}

TEST(Archive, NumbersAndListsComeBackToTheBit) {
  ArchiveWriter writer;
  const double third = 1.0 / 3.0, infinite = std::numeric_limits<double>::infinity();
  const std::vector<Eigen::Vector3f> vectors{{1.0f, 2.0f, 3.0f}, {-0.0f, 5.0f, 1e-40f}};
  const std::int64_t large = std::int64_t{1} << 62;
  writer.group("group", [&] {
    writer.number("third", third);
    writer.number("infinite", infinite);
    writer.number("large", large);
    writer.list("vectors", vectors);
  });
  const nlohmann::json fields =
      unpacked_archive("name", 1, packed_archive("name", 1, writer.fields()), "FILE");
  ArchiveReader reader(fields, "FILE");
  double third_read = 0.0, infinite_read = 0.0;
  std::vector<Eigen::Vector3f> vectors_read;
  std::int64_t large_read = 0;
  reader.group("group", [&] {
    reader.number("third", third_read);
    reader.number("infinite", infinite_read);
    reader.number("large", large_read);
    reader.list("vectors", vectors_read);
  });
  EXPECT_EQ(third_read, third);
  EXPECT_EQ(infinite_read, infinite);
  EXPECT_EQ(large_read, large);
  ASSERT_EQ(vectors_read.size(), 2u);
  EXPECT_EQ(std::memcmp(vectors_read.data(), vectors.data(), 24), 0);
}

}  // namespace
}  // namespace talus
