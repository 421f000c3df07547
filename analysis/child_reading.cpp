#include "analysis/child_reading.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <limits>
#include <new>
#include <string>
#include <system_error>

namespace talus::analysis {
namespace {

constexpr std::size_t longest_message = 4000;  // fits a pipe that nobody reads yet

/// What was given ended before all was taken.
struct Ended {};

[[noreturn]] void fail(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

class Pipe {
 public:
  Pipe() {
    if (::pipe2(ends_.data(), O_CLOEXEC) != 0) fail("pipe");
  }
  ~Pipe() {
    close_read_end();
    close_write_end();
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  int read_end() const { return ends_[0]; }
  int write_end() const { return ends_[1]; }
  void close_read_end() { close(ends_[0]); }
  void close_write_end() { close(ends_[1]); }

 private:
  static void close(int& descriptor) {
    if (descriptor >= 0) ::close(descriptor);
    descriptor = -1;
  }
  std::array<int, 2> ends_{-1, -1};
};

/// Not left behind, whatever happens here.
class Child {
 public:
  explicit Child(pid_t pid) : pid_(pid) {}
  ~Child() {
    if (pid_ == 0) return;
    ::kill(pid_, SIGKILL);
    wait();
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  int wait() {
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = 0;
    return status;
  }

 private:
  pid_t pid_;
};

/// SIGPROF ends this process then; RLIMIT_CPU knows whole seconds alone.
void limit_processor_time(double seconds) {
  double whole = 0.0;
  const double rest = std::modf(seconds, &whole);
  itimerval timer{};
  timer.it_value.tv_sec = static_cast<time_t>(whole);
  timer.it_value.tv_usec = static_cast<suseconds_t>(1e6 * rest);
  if (::setitimer(ITIMER_PROF, &timer, nullptr) != 0) ::_exit(1);
}

[[noreturn]] void act(const std::function<void(const Sink&)>& give, int data, int message, double seconds) {
  constexpr rlimit core{0, 0};
  ::setrlimit(RLIMIT_CORE, &core);
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGPROF, SIGPIPE})
    std::signal(signal, SIG_DFL);
  limit_processor_time(seconds);
  std::string refusal;
  try {
    give(Sink(data));
    ::_exit(0);
  } catch (const std::exception& error) {
    refusal = error.what();
  } catch (...) {
    refusal = "an unknown error";
  }
  Sink(message).put(refusal.data(), std::min(refusal.size(), longest_message));
  ::_exit(0);
}

std::string all_of(int descriptor) {
  std::string text(longest_message, '\0');
  const ssize_t size = ::read(descriptor, text.data(), text.size());
  text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  return text;
}

}  // namespace

void Sink::put(const void* bytes, std::size_t size) const {
  const char* next = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t written = ::write(descriptor_, next, size);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("write");
    next += written;
    size -= static_cast<std::size_t>(written);
  }
}

void Source::take(void* bytes, std::size_t size) const {
  char* next = static_cast<char*>(bytes);
  while (size > 0) {
    const ssize_t taken = ::read(descriptor_, next, size);
    if (taken < 0 && errno == EINTR) continue;
    if (taken < 0) fail("read");
    if (taken == 0) throw Ended{};
    next += taken;
    size -= static_cast<std::size_t>(taken);
  }
}

std::size_t Source::take_count() const {
  constexpr std::size_t most = std::numeric_limits<std::ptrdiff_t>::max() / 64;
  const auto count = take<std::size_t>();
  if (count > most) throw std::bad_alloc();
  return count;
}

double reading_patience(const std::filesystem::path& file) {
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
  constexpr double least = 0.01;  // many a damaged file hangs
#else
  constexpr double least = 3.0;
#endif
  constexpr double seconds_per_byte = 1e-6;
  return least + seconds_per_byte * static_cast<double>(std::filesystem::file_size(file));
}

void read_in_child(const std::function<void(const Sink&)>& give,
                   const std::function<void(const Source&)>& take, double seconds) {
  Pipe data, message;
  const pid_t pid = ::fork();
  if (pid < 0) fail("fork");
  if (pid == 0) {
    data.close_read_end();
    act(give, data.write_end(), message.write_end(), seconds);
  }
  Child child(pid);
  data.close_write_end();
  message.close_write_end();
  bool ended = false;
  try {
    take(Source(data.read_end()));
  } catch (const Ended&) {
    ended = true;
  }
  data.close_read_end();
  const int status = child.wait();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw ChildDied("crashed, or took too long");
  if (const std::string refusal = all_of(message.read_end()); !refusal.empty()) throw ChildRefused(refusal);
  if (ended) throw ChildDied("ended early");
}

}  // namespace talus::analysis
