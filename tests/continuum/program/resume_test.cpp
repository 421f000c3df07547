// Runs that are stopped, killed or run out of disk, and what comes of them when they go on: what a run without a stop comes to.
//
// TALUS_KILLS says how many kills, at random moments, must all be survived; default 6.
#include <gmock/gmock.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "analysis/snapshot.h"
#include "continuum/files/provenance.h"
#include "continuum/io/archive.h"
#include "continuum/io/checkpoint.h"
#include "continuum/render/render_file.h"
#include "tests/program.h"

namespace talus {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::ProgramResult;
using testing::run_program;
using testing::TestFolder;
using Path = std::filesystem::path;

const std::string everything = TALUS_SOURCE_DIR "/tests/continuum/data/everything.toml";
const std::string talus_program = TALUS_BINARY_DIR "/bin/talus";

/// Ends with `signal` after so many seconds, unless the program was done.
ProgramResult run_for(double seconds, const std::string& signal, const std::vector<std::string>& arguments) {
  std::vector<std::string> command{"timeout", "--preserve-status",     "-s",
                                   signal,    std::to_string(seconds), talus_program};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return run_program(command);
}

std::string digest_of(const Path& folder) { return run_program({"talus", "digest", folder.string()}).output; }

/// The frames of two files of render points, to the bit.
bool same_pictures(const Path& a, const Path& b) {
  const RenderReader one(a), other(b);
  if (one.frame_count() != other.frame_count()) return false;
  for (std::size_t i = 0; i < one.frame_count(); ++i) {
    const RenderFrame x = one.read(i), y = other.read(i);
    if (x.time != y.time || x.positions != y.positions || x.normals != y.normals ||
        x.identities != y.identities || x.materials != y.materials || x.speeds != y.speeds)
      return false;
  }
  return true;
}

bool same_snapshots(const Path& a, const Path& b) {
  const auto one = analysis::read_snapshots(a), other = analysis::read_snapshots(b);
  return std::equal(one.begin(), one.end(), other.begin(), other.end(), [](const auto& x, const auto& y) {
    return x.time == y.time && x.positions == y.positions && x.velocities == y.velocities &&
           x.volumes == y.volumes;
  });
}

class Resume : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared_ = new TestFolder;
    const auto start = std::chrono::steady_clock::now();
    const auto result = run_program({"talus", "run", everything, "-o", straight().string()});
    ASSERT_EQ(result.exit_code, 0) << result.output;
    duration_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  static void TearDownTestSuite() { delete shared_; }
  static Path straight() { return shared_->path() / "straight"; }

  Path out() const { return folder_.path() / "out"; }

  void expect_what_a_straight_run_gives() const {
    EXPECT_EQ(digest_of(out()), digest_of(straight()));
    for (const char* text :
         {"budget.csv", "bodies.csv", "run.toml", "snapshots.xdmf", "render.xdmf", "bodies/pusher.stl"})
      EXPECT_EQ(read_file(out() / text), read_file(straight() / text)) << text;
    EXPECT_TRUE(same_snapshots(out() / "snapshots.h5", straight() / "snapshots.h5"));
    EXPECT_TRUE(same_pictures(out() / "render.h5", straight() / "render.h5"));
    const auto summary = [](const Path& folder) {
      return nlohmann::json::parse(read_file(folder / "run.json"));
    };
    EXPECT_EQ(summary(out())["budget"], summary(straight())["budget"]);
    for (const auto& entry : std::filesystem::directory_iterator(out())) {
      const std::string name = entry.path().filename();
      EXPECT_TRUE(std::filesystem::exists(straight() / name)) << name << " is left over";
    }
  }

  /// Runs to the end; `kills` times at most it is stopped at a random moment, and goes on from its checkpoint, if there is one yet.
  void run_with_stops(const std::string& signal, int code, int& kills) {
    while (true) {
      std::vector<std::string> arguments{"run", everything, "-o", out().string()};
      if (has_checkpoint(out())) {
        arguments = {"resume", out().string()};
        ++resumes_;
      }
      arguments.insert(arguments.end(), {"--checkpoint-every", "0"});
      const double longest = kills > 0 ? 0.8 * duration_ : 1e4;
      const auto result =
          run_for(0.02 + longest * static_cast<double>(random_()) / 4294967296.0, signal, arguments);
      if (result.exit_code == 0) return;
      ASSERT_EQ(result.exit_code, code) << result.output;
      --kills;
      if (!std::filesystem::exists(out() / "run.json")) continue;
      EXPECT_EQ(digest_of(out()), digest_of(straight()));  // whole, but for the clearing up
      std::filesystem::remove_all(out());
    }
  }
  void stop_often(const std::string& signal, int code) {
    const char* wanted = std::getenv("TALUS_KILLS");
    int kills = wanted ? std::atoi(wanted) : 6, runs = 0;
    while (kills > 0 || resumes_ == 0) {
      kills = std::max(kills, 1);
      run_with_stops(signal, code, kills);
      if (HasFatalFailure()) return;
      expect_what_a_straight_run_gives();
      ++runs;
    }
    std::printf("%d runs, %d times from a checkpoint\n", runs, resumes_);
  }
  /// A run with two checkpoints, not at its end. It is held to look at them: while one takes the other's place there is but one.
  void stop_half_way() const {
    const std::string script =
        "\"$1\" run \"$2\" -o \"$3\" --checkpoint-every 0 & pid=$!\n"
        "while kill -STOP $pid; do\n"
        "  if [ -e \"$3/$4\" ] && [ -e \"$3/$5\" ]; then kill -KILL $pid; break; fi\n"
        "  kill -CONT $pid; sleep 0.01\n"
        "done; wait $pid";
    const auto result = run_program({"sh", "-c", script, "sh", talus_program, everything, out().string(),
                                     checkpoint_name, previous_checkpoint_name});
    ASSERT_EQ(result.exit_code, 137) << result.output;
  }
  ProgramResult resume(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"talus", "resume", out().string()});
    return run_program(more);
  }

  TestFolder folder_;

 private:
  static TestFolder* shared_;
  static double duration_;  // s, of a run without a stop
  std::mt19937 random_{1};
  int resumes_ = 0;
};
TestFolder* Resume::shared_ = nullptr;
double Resume::duration_ = 0.0;

TEST_F(Resume, AfterKillsWhereverTheyComeNothingIsLost) { stop_often("KILL", 137); }

TEST_F(Resume, AfterSignalsThatAskForAStop) { stop_often("TERM", 143); }

TEST_F(Resume, ASignalIsAnsweredWithACheckpointWithoutBeingAskedForOne) {
  for (double seconds = 0.2; !has_checkpoint(out()); seconds *= 1.5) {
    const auto result = run_for(seconds, "INT", {"run", everything, "-o", out().string()});
    ASSERT_EQ(result.exit_code, 130) << result.output;
    EXPECT_EQ(has_checkpoint(out()),
              result.output.find("to go on: talus resume " + out().string()) != std::string::npos);
  }
  EXPECT_EQ(resume().exit_code, 0);
  expect_what_a_straight_run_gives();
}

TEST_F(Resume, ACheckpointThatTheDiskSpoiltIsToldAndTheOneBeforeTaken) {
  stop_half_way();
  ASSERT_TRUE(std::filesystem::exists(out() / previous_checkpoint_name));
  std::filesystem::resize_file(out() / checkpoint_name, 1000);
  const auto result = resume();
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.output, HasSubstr("going on from the checkpoint before"));
  expect_what_a_straight_run_gives();
}

/// Files may not grow, as on a full disk, beyond what the checkpoints of the first steps take.
TEST_F(Resume, OnAFullDiskItStopsAndTheNewestCheckpointIsWhole) {
  stop_half_way();
  const std::string before = digest_of(out());
  const auto full = run_program({"sh", "-c", "trap '' XFSZ; ulimit -f 200; exec \"$@\"", "sh", talus_program,
                                 "resume", out().string(), "--checkpoint-every", "0"});
  EXPECT_EQ(full.exit_code, 2);
  EXPECT_THAT(full.output, AllOf(HasSubstr(out().string()), HasSubstr("File too large")));
  EXPECT_EQ(digest_of(out()), before);
  EXPECT_FALSE(std::filesystem::exists(out() / "run.json"));
  EXPECT_EQ(resume().exit_code, 0);
  expect_what_a_straight_run_gives();
}

/// Root may write everywhere, unless it gives that up.
TEST_F(Resume, InAFolderThatBecomesReadOnlyItStopsAndTheNewestCheckpointIsWhole) {
  const std::string humble = ::geteuid() == 0 ? "setpriv --bounding-set=-dac_override " : "";
  const std::string script = humble + "\"$1\" run \"$2\" -o \"$3\" --checkpoint-every 0 & pid=$!\n" +
                             "until [ -e \"$3/checkpoint.previous.talus\" ]; do sleep 0.01; done\n" +
                             "chmod -R u-w \"$3\"; wait $pid; code=$?; chmod -R u+w \"$3\"; exit $code";
  const auto stopped = run_program({"sh", "-c", script, "sh", talus_program, everything, out().string()});
  EXPECT_EQ(stopped.exit_code, 2);
  EXPECT_THAT(stopped.output, AllOf(HasSubstr(out().string()), HasSubstr("Permission denied")));
  EXPECT_FALSE(std::filesystem::exists(out() / "run.json"));
  EXPECT_EQ(resume().exit_code, 0);
  expect_what_a_straight_run_gives();
}

TEST_F(Resume, AnotherRunDoesNotOverwriteAnUnfinishedOneUnasked) {
  stop_half_way();
  const std::vector<std::string> run{"talus", "run", everything, "-o", out().string()};
  const auto refused = run_program(run);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, AllOf(HasSubstr("talus resume"), HasSubstr("--discard")));
  auto discarding = run;
  discarding.push_back("--discard");
  EXPECT_EQ(run_program(discarding).exit_code, 0);
  expect_what_a_straight_run_gives();
}

TEST_F(Resume, TwoRunsAtOnceInOneFolderAreRefused) {
  const std::string script =
      "\"$1\" run \"$2\" -o \"$3\" & pid=$!\n"
      "until [ -e \"$3/run.toml\" ]; do sleep 0.01; done\n"
      "\"$1\" run \"$2\" -o \"$3\" --discard; echo second $?; wait $pid; echo first $?";
  const auto both = run_program({"sh", "-c", script, "sh", talus_program, everything, out().string()});
  EXPECT_THAT(both.output, AllOf(HasSubstr("another program is making runs there"), HasSubstr("second 2"),
                                 HasSubstr("first 0")));
  expect_what_a_straight_run_gives();
}

TEST_F(Resume, WhatThereIsNothingToGoOnFromIsTold) {
  std::filesystem::create_directories(out());
  const auto empty = resume();
  EXPECT_EQ(empty.exit_code, 2);
  EXPECT_THAT(empty.output, HasSubstr("no checkpoint of an unfinished run is here"));
  const auto done = run_program({"talus", "resume", straight().string()});
  EXPECT_EQ(done.exit_code, 2);
  EXPECT_THAT(done.output, HasSubstr("the run is finished"));
}

TEST_F(Resume, PartsAndRowsThatAreGoneAreMissed) {
  stop_half_way();
  ASSERT_TRUE(std::filesystem::exists(out() / "parts" / "snapshots_0000.h5"));
  std::filesystem::rename(out() / "parts", folder_.path() / "elsewhere");
  EXPECT_THAT(resume().output, HasSubstr("snapshots_0000.h5: frames of the unfinished run should be here"));
  std::filesystem::rename(folder_.path() / "elsewhere", out() / "parts");
  std::filesystem::resize_file(out() / "budget.csv.partial", 10);
  const auto result = resume();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("budget.csv.partial"));
}

/// Writes the checkpoint anew, with one field changed.
void change(const Path& folder, const std::string& name, const nlohmann::json& value) {
  const Path file = folder / checkpoint_name;
  nlohmann::json fields = unpacked_archive("talus-checkpoint", 1, read_file(file), file.string());
  ASSERT_TRUE(fields.contains(name));
  fields[name] = value;
  write_file_atomically(file, packed_archive("talus-checkpoint", 1, fields));
}

TEST_F(Resume, AnotherSolverGoesOnOnlyWhenAsked) {
  stop_half_way();
  change(out(), "solver", "talus 0.0.1");
  const auto refused = resume();
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, AllOf(HasSubstr("\"talus 0.0.1\""), HasSubstr("--other-solver")));
  EXPECT_EQ(resume({"--other-solver"}).exit_code, 0);
}

TEST_F(Resume, AnotherSceneIsRefused) {
  stop_half_way();
  change(out(), "input_hash", sha256("another scene"));
  const auto result = resume();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("run.toml: not the scene that the unfinished run is of"));
}

TEST_F(Resume, ANumericalFaultLeavesAStateFromWhichItComesAgain) {
  stop_half_way();
  const Path file = out() / checkpoint_name;
  nlohmann::json fields = unpacked_archive("talus-checkpoint", 1, read_file(file), file.string());
  auto& pressure = fields["state/warm_start/pressure"].get_binary();
  const double nan = std::nan("");
  std::memcpy(pressure.data(), &nan, sizeof nan);
  write_file_atomically(file, packed_archive("talus-checkpoint", 1, fields));

  const auto fault = resume();
  EXPECT_EQ(fault.exit_code, 1);
  EXPECT_THAT(fault.output, AllOf(HasSubstr("the pressure that the last step left is not finite"),
                                  HasSubstr("talus resume " + (out() / "fault").string())));
  const auto at = fault.output.find("talus: step ");
  ASSERT_NE(at, std::string::npos);
  const std::string step = fault.output.substr(at + 12, fault.output.find(':', at + 12) - at - 12);
  const auto again = run_program({"talus", "resume", (out() / "fault").string(), "--dump-qp", step});
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.output, HasSubstr("talus: step " + step + ": the pressure that the last step left"));
}

}  // namespace
}  // namespace talus
