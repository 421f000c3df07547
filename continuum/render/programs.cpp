#include "continuum/render/programs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <stdexcept>

#include "continuum/files/atomic_file.h"
#include "continuum/files/process.h"

namespace talus {
namespace {

constexpr std::size_t last_words = 1500;  // characters of a program's output that an error repeats
constexpr std::chrono::hours time_limit{24};

volatile std::sig_atomic_t interrupted = 0;

/// Programs run in process groups of their own, which the terminal's interrupt does not reach.
class CatchingInterrupts {
 public:
  CatchingInterrupts() {
    for (std::size_t i = 0; i < signals.size(); ++i) {
      before_[i] = std::signal(signals[i], [](int) { interrupted = 1; });
      if (before_[i] == SIG_IGN) std::signal(signals[i], SIG_IGN);  // nohup
    }
  }
  ~CatchingInterrupts() {
    for (std::size_t i = 0; i < signals.size(); ++i) std::signal(signals[i], before_[i]);
  }
  CatchingInterrupts(const CatchingInterrupts&) = delete;
  CatchingInterrupts& operator=(const CatchingInterrupts&) = delete;

 private:
  static constexpr std::array<int, 3> signals{SIGINT, SIGTERM, SIGHUP};
  std::array<void (*)(int), 3> before_;
};

/// `unfinished`: what it writes, taken away when it fails.
void run_to_end(const std::vector<std::string>& command, const std::filesystem::path& folder,
                const std::string& log, const std::string& unfinished) {
  const CatchingInterrupts catching;
  const ProcessResult result = run_process({.command = command,
                                            .folder = folder,
                                            .log = log,
                                            .environment = {},
                                            .time_limit = time_limit,
                                            .stop = [] { return interrupted != 0; }});
  const auto file = folder / log;
  if (result.exit_code != 0) {
    auto state = folder / unfinished;
    std::filesystem::remove(state);
    std::filesystem::remove(state.replace_extension(".pov-state"));  // what POV-Ray would go on from
  }
  if (result.interrupted) {
    std::filesystem::remove(file);
    throw std::runtime_error("interrupted");
  }
  if (result.exit_code != 0) {
    std::string said = read_file(file);
    if (said.size() > last_words) said.erase(0, said.size() - last_words);
    throw std::runtime_error(fmt::format("'{}' failed with exit code {}; it said, in {}:\n{}",
                                         fmt::join(command, " "), result.exit_code, file.string(), said));
  }
  std::filesystem::remove(file);
}

std::string partial(const std::string& name) { return "partial-" + name; }

}  // namespace

void draw_with_povray(const std::filesystem::path& povray, const std::filesystem::path& folder,
                      const std::string& scene, const std::string& picture, PictureSize size, int samples,
                      int threads) {
  // Pixels that differ from their neighbours by this much are looked at again.
  const std::string antialias = samples > 1 ? "+A0.1" : "-A";
  run_to_end({povray.string(), "+I" + scene, "+O" + partial(picture), "+FN8", fmt::format("+W{}", size.width),
              fmt::format("+H{}", size.height), antialias, "+AM1", fmt::format("+R{}", std::max(samples, 1)),
              "-D", "-P", "-GA", "+GF", "+THFS", fmt::format("+WT{}", threads)},
             folder, picture + ".log", partial(picture));
  std::filesystem::rename(folder / partial(picture), folder / picture);
}

void film_with_ffmpeg(const std::filesystem::path& ffmpeg, const std::filesystem::path& folder,
                      const std::vector<std::string>& pictures, double pictures_per_second,
                      const std::string& film) {
  std::string list;
  for (const std::string& picture : pictures)
    list += fmt::format("file '{}'\nduration {:.9g}\n", picture, 1.0 / pictures_per_second);
  const std::string list_file = film + ".txt";
  write_file_atomically(folder / list_file, list);
  std::vector<std::string> command{ffmpeg.string(), "-y", "-loglevel", "error", "-f", "concat", "-i",
                                   list_file, "-r", fmt::format("{:.9g}", pictures_per_second),
                                   // Players want even sizes.
                                   "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"};
  if (film.ends_with(".webm"))
    command.insert(command.end(), {"-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0"});
  else
    command.insert(command.end(), {"-c:v", "libx264", "-crf", "18", "-movflags", "+faststart"});
  command.push_back(partial(film));
  run_to_end(command, folder, film + ".log", partial(film));
  std::filesystem::remove(folder / list_file);
  std::filesystem::rename(folder / partial(film), folder / film);
}

}  // namespace talus
