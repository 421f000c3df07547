// Runs our programs, and others, from tests.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "continuum/files/atomic_file.h"
#include "continuum/files/process.h"
#include "tests/test_folder.h"

namespace talus::testing {

struct ProgramResult {
  int exit_code;
  bool timed_out;
  std::string output;  // stdout and stderr
};

/// A program of ours by its bare name ("talus"), or any other by its path. In `folder`, or where the test
/// runs.
inline ProgramResult run_program(std::vector<std::string> command, double time_limit = 600.0,
                                 std::filesystem::path folder = {}) {
  const auto built = std::filesystem::path(TALUS_BINARY_DIR) / "bin" / command.front();
  if (std::filesystem::exists(built)) command.front() = built.string();
  const TestFolder log_folder;
  const auto log = log_folder.path() / "output";
  ProcessRequest request;
  request.command = command;
  request.folder = folder.empty() ? std::filesystem::current_path() : folder;
  request.log = log.string();
  request.time_limit = std::chrono::duration<double>(time_limit);
  request.stop = [] { return false; };
  const auto result = run_process(request);
  return {result.exit_code, result.timed_out, read_file(log)};
}

}  // namespace talus::testing
