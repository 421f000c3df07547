// One child process in its own process group, under a time limit, with its CPU time accounted for.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace talus {

struct ProcessResult {
  int exit_code;  // as the shell tells it: 128 + signal when killed
  bool timed_out;
  bool interrupted;  // stopped because `stop` said so
  double wall_seconds;
  double cpu_seconds;  // user + system, the process and those of its children that it waited for
};

struct ProcessRequest {
  std::vector<std::string> command;
  std::filesystem::path folder;  // working directory; stdout and stderr go to `log` there
  std::string log;
  std::vector<std::pair<std::string, std::string>> environment;  // added to ours
  std::chrono::duration<double> time_limit;
  std::function<bool()> stop;  // polled about ten times a second; true ends the run
};

/// Runs to the end, the time limit, or until stop() is true; the whole process group is then killed.
/// Throws InputError when the program cannot be started.
ProcessResult run_process(const ProcessRequest& request);

/// The program's full path on PATH. Throws InputError that names the Debian package to install when it is not
/// there.
std::filesystem::path find_program(const std::string& name, const std::string& debian_package);

/// A folder of the system's for temporary files, gone with everything in it afterwards. Throws InputError when it cannot be made.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// What a short command prints, stdout and stderr together. Throws InputError when it cannot be started.
std::string output_of(const std::vector<std::string>& command);

}  // namespace talus
