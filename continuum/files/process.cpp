#include "continuum/files/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "continuum/files/atomic_file.h"
#include "continuum/files/input_error.h"

namespace talus {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds poll_interval{20};
constexpr int polls_per_stop_call = 5;    // stop() may look at files; ten times a second is often enough
constexpr std::chrono::seconds grace{2};  // between asking a group to end and making it

/// argv or envp, as C wants them; the strings stay owned by `texts`.
std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  for (auto& text : texts) result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

std::vector<std::string> merged_environment(const std::vector<std::pair<std::string, std::string>>& added) {
  std::vector<std::string> merged;
  for (char** entry = environ; *entry; ++entry) {
    const std::string_view text(*entry);
    const std::string_view name = text.substr(0, text.find('='));
    const bool replaced =
        std::any_of(added.begin(), added.end(), [&](const auto& pair) { return pair.first == name; });
    if (!replaced) merged.emplace_back(text);
  }
  for (const auto& [name, value] : added) merged.push_back(name + "=" + value);
  return merged;
}

/// Starts the command as the leader of a new process group, so that its children can be ended with it.
pid_t spawn(const ProcessRequest& request) {
  std::vector<std::string> command = request.command;
  std::vector<std::string> environment = merged_environment(request.environment);
  const std::string folder = request.folder.string();

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, request.log.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0644);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);

  pid_t child = 0;
  const int failure = posix_spawnp(&child, command.front().c_str(), &actions, &attributes,
                                   pointers(command).data(), pointers(environment).data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) {
    throw InputError(fmt::format(
        "cannot start '{}' in {}, with its output in {}: {}; check that the program is installed and "
        "that the folder can be written to",
        request.command.front(), folder, request.log, std::strerror(failure)));
  }
  return child;
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

ProcessResult run_process(const ProcessRequest& request) {
  if (request.command.empty()) throw InputError("run_process: the command is empty");
  const auto start = Clock::now();
  const pid_t child = spawn(request);

  ProcessResult result{};
  Clock::time_point kill_at = Clock::time_point::max();
  int status = 0;
  rusage usage{};
  for (int poll = 0;; ++poll) {
    const pid_t ended = wait4(child, &status, WNOHANG, &usage);
    if (ended == child) break;
    // Someone else has collected it: its exit code is gone, and must not pass for 0.
    if (ended < 0 && errno != EINTR) {
      throw std::runtime_error(
          fmt::format("cannot wait for '{}': {}", request.command.front(), std::strerror(errno)));
    }
    const auto now = Clock::now();
    const bool ending = kill_at != Clock::time_point::max();
    if (!ending) {
      result.timed_out = now - start > request.time_limit;
      result.interrupted =
          !result.timed_out && request.stop && poll % polls_per_stop_call == 0 && request.stop();
      if (result.timed_out || result.interrupted) {
        kill(-child, SIGTERM);
        kill_at = now + grace;
      }
    } else if (now > kill_at) {
      kill(-child, SIGKILL);
    }
    std::this_thread::sleep_for(poll_interval);
  }
  kill(-child, SIGKILL);  // whatever the leader left behind; fails harmlessly when that is nothing

  result.exit_code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  result.wall_seconds = std::chrono::duration<double>(Clock::now() - start).count();
  result.cpu_seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  return result;
}

ScratchFolder::ScratchFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "talus-XXXXXX").string();
  if (!mkdtemp(name.data())) {
    throw InputError(fmt::format("cannot make a folder like {}: {}; free some space or set TMPDIR", name,
                                 std::strerror(errno)));
  }
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string output_of(const std::vector<std::string>& command) {
  const ScratchFolder folder;
  constexpr std::chrono::seconds enough{30};
  run_process({.command = command,
               .folder = folder.path(),
               .log = "out",
               .environment = {},
               .time_limit = enough,
               .stop = {}});
  return read_file(folder.path() / "out");
}

std::filesystem::path find_program(const std::string& name, const std::string& debian_package) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    auto candidate = std::filesystem::path(folder) / name;
    if (::access(candidate.c_str(), X_OK) == 0 && std::filesystem::is_regular_file(candidate))
      return candidate;
  }
  throw InputError(fmt::format("program '{}' is not on PATH ({}); install it with: apt-get install {}", name,
                               path ? path : "empty", debian_package));
}

}  // namespace talus
