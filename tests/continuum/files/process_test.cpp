#include "continuum/files/process.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <signal.h>

#include <cstdlib>
#include <fstream>
#include <thread>

#include "continuum/files/atomic_file.h"
#include "tests/test_folder.h"

namespace talus {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::input_error;
using testing::TestFolder;

ProcessRequest shell(const TestFolder& folder, std::string script,
                     std::chrono::duration<double> limit = 20s) {
  return {.command = {"/bin/sh", "-c", std::move(script)},
          .folder = folder.path(),
          .log = "log",
          .environment = {},
          .time_limit = limit,
          .stop = {}};
}

/// Running, as against ended or waiting to be collected by whoever adopted it.
bool is_running(pid_t process) {
  std::ifstream in(fmt::format("/proc/{}/stat", process));
  std::string text;
  if (!std::getline(in, text)) return false;
  const char state = text[text.rfind(')') + 2];
  return state != 'Z' && state != 'X';
}

TEST(Process, TellsTheExitCodeAndKeepsTheOutput) {
  const TestFolder folder;
  const auto result = run_process(shell(folder, "pwd; echo out; echo err >&2; exit 7"));
  EXPECT_EQ(result.exit_code, 7);
  EXPECT_FALSE(result.timed_out);
  EXPECT_FALSE(result.interrupted);
  EXPECT_EQ(read_file(folder.path() / "log"), folder.path().string() + "\nout\nerr\n");
}

TEST(Process, TellsTheSignalAsTheShellDoes) {
  const TestFolder folder;
  EXPECT_EQ(run_process(shell(folder, "kill -SEGV $$")).exit_code, 128 + SIGSEGV);
}

TEST(Process, TimeLimitEndsTheProcessAndItsChildren) {
  const TestFolder folder;
  const auto result = run_process(shell(folder, "sleep 60 & echo $! > child; sleep 60", 0.3s));
  EXPECT_TRUE(result.timed_out);
  EXPECT_EQ(result.exit_code, 128 + SIGTERM);
  EXPECT_GE(result.wall_seconds, 0.3);
  EXPECT_LT(result.wall_seconds, 2.0);
  const pid_t child = std::stoi(read_file(folder.path() / "child"));
  for (int i = 0; i < 50 && is_running(child); ++i) std::this_thread::sleep_for(20ms);
  EXPECT_FALSE(is_running(child));
}

TEST(Process, TimeLimitEndsAProcessThatDoesNotListen) {
  const TestFolder folder;
  const auto result = run_process(shell(folder, "trap '' TERM; while :; do sleep 0.05; done", 0.2s));
  EXPECT_TRUE(result.timed_out);
  EXPECT_EQ(result.exit_code, 128 + SIGKILL);
  EXPECT_LT(result.wall_seconds, 10.0);
}

TEST(Process, WhatTheLeaderLeavesBehindIsEndedToo) {
  const TestFolder folder;
  const auto result = run_process(shell(folder, "sleep 60 & echo $! > child; exit 0"));
  EXPECT_EQ(result.exit_code, 0);
  const pid_t child = std::stoi(read_file(folder.path() / "child"));
  for (int i = 0; i < 50 && is_running(child); ++i) std::this_thread::sleep_for(20ms);
  EXPECT_FALSE(is_running(child));
}

TEST(Process, StopsWhenAsked) {
  const TestFolder folder;
  auto request = shell(folder, "sleep 60");
  int asked = 0;
  request.stop = [&asked] { return ++asked == 3; };
  const auto result = run_process(request);
  EXPECT_TRUE(result.interrupted);
  EXPECT_FALSE(result.timed_out);
  EXPECT_EQ(asked, 3);
  EXPECT_LT(result.wall_seconds, 5.0);
}

TEST(Process, CountsCpuSecondsOfItsChildrenAndNoneOfSleep) {
  const TestFolder folder;
  const auto busy = run_process(shell(folder, "(i=0; while [ $i -lt 300000 ]; do i=$((i+1)); done); true"));
  EXPECT_GT(busy.cpu_seconds, 0.05);
  EXPECT_LT(busy.cpu_seconds, busy.wall_seconds + 0.2);
  const auto idle = run_process(shell(folder, "sleep 0.5"));
  EXPECT_LT(idle.cpu_seconds, 0.1);
  EXPECT_GE(idle.wall_seconds, 0.5);
}

TEST(Process, EnvironmentIsAddedToAndReplacesOurs) {
  const TestFolder folder;
  auto request = shell(folder, "echo $TALUS_TEST_A $TALUS_TEST_B");
  setenv("TALUS_TEST_A", "ours", 1);
  setenv("TALUS_TEST_B", "ours", 1);
  request.environment = {{"TALUS_TEST_B", "added"}};
  run_process(request);
  EXPECT_EQ(read_file(folder.path() / "log"), "ours added\n");
}

TEST(Process, CannotBeStarted) {
  const TestFolder folder;
  auto request = shell(folder, "");
  request.command = {"no-such-program-of-ours"};
  EXPECT_THAT(input_error([&] { run_process(request); }),
              AllOf(HasSubstr("no-such-program-of-ours"), HasSubstr("installed")));
  request = shell(folder, "true");
  request.folder = "/nowhere";
  EXPECT_THAT(input_error([&] { run_process(request); }), HasSubstr("/nowhere"));
}

TEST(Process, MissingProgramNamesItsPackage) {
  EXPECT_EQ(find_program("sh", "dash").filename(), "sh");
  EXPECT_THAT(input_error([] { find_program("no-such-program-of-ours", "its-package"); }),
              AllOf(HasSubstr("no-such-program-of-ours"), HasSubstr("apt-get install its-package")));
}

}  // namespace
}  // namespace talus
