#include "analysis/survives.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <csignal>
#include <system_error>

namespace talus::analysis {
namespace {

[[noreturn]] void act(const std::function<void()>& action, double seconds) {
  const auto most = static_cast<rlim_t>(std::ceil(seconds));
  const rlimit processor{most, most + 1}, core{0, 0};
  ::setrlimit(RLIMIT_CPU, &processor);
  ::setrlimit(RLIMIT_CORE, &core);
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGXCPU}) std::signal(signal, SIG_DFL);
  try {
    action();
  } catch (...) {  // an error is an answer
  }
  ::_exit(0);
}

}  // namespace

bool survives(const std::function<void()>& action, double seconds) {
  const pid_t child = ::fork();
  if (child < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (child == 0) act(action, seconds);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) throw std::system_error(errno, std::generic_category(), "waitpid");
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace talus::analysis
