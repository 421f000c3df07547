#include "continuum/program/bench.h"

#include <fmt/format.h>
#include <malloc.h>
#include <sys/resource.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "continuum/files/atomic_file.h"
#include "continuum/files/input_error.h"
#include "continuum/files/provenance.h"
#include "continuum/parallel.h"
#include "continuum/program/frames.h"

namespace talus {
namespace {

constexpr double nanoseconds = 1e9;

/// User and system seconds of the process so far, of all its threads.
double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// What the scenes before needed, no longer counts: see proc(5), clear_refs and VmHWM.
void start_peak_memory() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << 5;
}

/// Memory that the process held at most since start_peak_memory(), in 10^6 bytes.
double peak_memory_mb() {
  std::ifstream status("/proc/self/status");
  for (std::string key; status >> key;) {
    double kib = 0.0;
    if (key == "VmHWM:" && status >> kib) return kib * 1024.0 / 1e6;
  }
  throw std::runtime_error("/proc/self/status: has no VmHWM");
}

/// What a run of a scene cost. Iterations and caps are sums over the steps.
struct Tally {
  int frames = 0;
  long steps = 0;
  long friction_iterations = 0, pressure_iterations = 0, packing_iterations = 0;
  long cap_hits = 0;
  long retries = 0;
  Eigen::Index particles_start = 0, particles_end = 0;
  std::int64_t render_points = 0;  // at the end
  double particle_steps = 0.0;     // particles, summed over the steps
  double simulated_s = 0.0, wall_s = 0.0, cpu_s = 0.0;
  double peak_mb = 0.0;
  PhaseSeconds phases;

  void add(const StepReport& report, Eigen::Index particles) {
    ++steps;
    friction_iterations += report.projection.friction_iterations;
    pressure_iterations += report.projection.pressure_iterations;
    packing_iterations += report.packing.solve.iterations;
    cap_hits += report.cap_hits();
    retries += report.retries;
    particle_steps += static_cast<double>(particles);
    phases += report.seconds;
  }
  double per_step(double total) const { return total / static_cast<double>(steps); }
  /// 0 where there never was a particle.
  double ns_per_particle_step(double seconds) const {
    return particle_steps > 0.0 ? nanoseconds * seconds / particle_steps : 0.0;
  }
};

int frames_to_run(const Scene& scene, const BenchOptions& options) {
  const int all = frame_count(scene);
  const int frames = options.frames.value_or(all);
  if (frames > all) {
    throw InputError(
        fmt::format("{}: --frames {}: the scene has {}; ask for no more, or give it a later end_s",
                    scene.file.string(), frames, all));
  }
  return frames;
}

/// A long run must not end in a place that cannot be written to.
void check_place(const std::filesystem::path& json) {
  if (std::filesystem::is_directory(json))
    throw InputError(fmt::format("{}: is a folder; --json takes the name of a file", json.string()));
  make_writable_folder(std::filesystem::absolute(json).parent_path());
}

Tally time_scene(const Scene& scene, int frames) {
  start_peak_memory();
  State state = initial_state(scene);
  Tally tally;
  tally.frames = frames;
  tally.particles_start = state.particles.count();
  const double cpu_before = cpu_seconds();
  Stopwatch watch;
  for (int frame = 1; frame <= frames; ++frame) {
    run_to_frame(scene, frame, state, [&](double dt_limit) {
      const Eigen::Index particles = state.particles.count();
      tally.add(step(state, scene.settings, dt_limit), particles);
      return true;
    });
  }
  tally.wall_s = watch.lap();
  tally.cpu_s = cpu_seconds() - cpu_before;
  tally.peak_mb = peak_memory_mb();
  tally.simulated_s = state.time;
  tally.particles_end = state.particles.count();
  tally.render_points = state.render_points.count();
  return tally;
}

nlohmann::json json_of(const Tally& t, const Scene& scene, const std::string& command_line) {
  nlohmann::json made_by = provenance();
  if (!scene.broken.empty()) made_by["broken"] = scene.broken;
  made_by["command_line"] = command_line;
  const auto iterations = [&](long total) {
    return nlohmann::json{{"total", total}, {"per_step", t.per_step(static_cast<double>(total))}};
  };
  nlohmann::json phases;
  for (std::size_t i = 0; i < phase_names.size(); ++i) phases[std::string(phase_names[i])] = t.phases.of[i];
  nlohmann::json figures{
      {"schema", "talus-bench"},
      {"schema_version", 1},
      {"provenance", made_by},
      {"scene", utf8(scene.file.filename().string())},
      {"input_hash", scene.input_hash},
      {"threads", thread_count()},
      {"frames", t.frames},
      {"steps", t.steps},
      {"simulated_s", t.simulated_s},
      {"particles",
       {{"start", t.particles_start}, {"end", t.particles_end}, {"mean", t.per_step(t.particle_steps)}}},
      {"cpu_s", t.cpu_s},
      {"wall_s", t.wall_s},
      {"cpu_s_per_simulated_s", t.cpu_s / t.simulated_s},
      {"cpu_s_per_frame", t.cpu_s / t.frames},
      {"cpu_s_per_step", t.per_step(t.cpu_s)},
      {"ns_per_particle_step", t.ns_per_particle_step(t.cpu_s)},
      {"iterations",
       {{"friction", iterations(t.friction_iterations)},
        {"pressure", iterations(t.pressure_iterations)},
        {"packing", iterations(t.packing_iterations)}}},
      {"cap_hits", t.cap_hits},
      {"retries", t.retries},
      {"peak_mb", t.peak_mb},
      {"render_points", t.render_points},
      {"wall_s_per_frame", t.wall_s / t.frames},
      {"phases_s", phases},
  };
  if (const auto& source = scene.table_5_1) {
    figures["table_5_1"] = {{"particles", source->particles},
                            {"render_points", source->render_points},
                            {"seconds_per_frame", source->seconds_per_frame}};
  }
  return figures;
}

/// A row for each scene: what it holds, what a frame costs, and how that compares with the source's.
std::string comparison_of(const std::vector<Scene>& scenes, const std::vector<Tally>& tallies) {
  std::string table =
      fmt::format("{:<24}{:>10}{:>14}{:>10}{:>8}{:>10}{:>10}{:>9}{:>7}\n", "scene", "particles",
                  "render points", "s/frame", "frames", "source", "source/us", "MB", "caps");
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const Tally& t = tallies[i];
    const auto& source = scenes[i].table_5_1;
    const double per_frame = t.wall_s / t.frames;
    table += fmt::format("{:<24}{:>10}{:>14}{:>10.3g}{:>8}{:>10}{:>10}{:>9.0f}{:>7}\n",
                         scenes[i].file.filename().string(), t.particles_end, t.render_points, per_frame,
                         t.frames, source ? fmt::format("{:.1f}", source->seconds_per_frame) : "",
                         source ? fmt::format("{:.2f}", source->seconds_per_frame / per_frame) : "",
                         t.peak_mb, t.cap_hits);
  }
  return table;
}

std::string table_of(const Tally& t, const Scene& scene) {
  std::string table = fmt::format(
      "{}: {} frames, {} steps, {:.4g} s simulated, {} to {} particles, {} threads\n"
      "  {:.4g} CPU-s, {:.4g} s by the wall clock; {:.4g} CPU-s per simulated second\n"
      "  per frame {:.4g} CPU-s, per step {:.4g}, per particle and step {:.4g} ns\n"
      "  iterations a step: friction {:.1f}, pressure {:.1f}, packing {:.1f}; solves at their cap: {}\n"
      "  peak memory {:.1f} MB\n\n",
      scene.file.filename().string(), t.frames, t.steps, t.simulated_s, t.particles_start, t.particles_end,
      thread_count(), t.cpu_s, t.wall_s, t.cpu_s / t.simulated_s, t.cpu_s / t.frames, t.per_step(t.cpu_s),
      t.ns_per_particle_step(t.cpu_s), t.per_step(static_cast<double>(t.friction_iterations)),
      t.per_step(static_cast<double>(t.pressure_iterations)),
      t.per_step(static_cast<double>(t.packing_iterations)), t.cap_hits, t.peak_mb);
  table += fmt::format("  {:<14}{:>10}{:>10}{:>14}{:>18}\n", "phase", "wall s", "share", "wall ms/step",
                       "wall ns/part/step");
  const auto add_row = [&](std::string_view name, double seconds) {
    table +=
        fmt::format("  {:<14}{:>10.3f}{:>9.1f}%{:>14.3f}{:>18.1f}\n", name, seconds,
                    100.0 * seconds / t.wall_s, 1e3 * t.per_step(seconds), t.ns_per_particle_step(seconds));
  };
  for (std::size_t i = 0; i < phase_names.size(); ++i) add_row(phase_names[i], t.phases.of[i]);
  add_row("between steps", t.wall_s - t.phases.total());
  return table;
}

}  // namespace

void bench(const BenchOptions& options) {
  std::vector<Scene> scenes;
  std::vector<Tally> tallies;
  nlohmann::json all = nlohmann::json::array();
  for (const auto& file : options.scenes) {
    scenes.push_back(read_scene(file));
    frames_to_run(scenes.back(), options);
  }
  if (options.json) check_place(*options.json);
  for (const Scene& scene : scenes) {
    warn_if_broken(scene);
    tallies.push_back(time_scene(scene, frames_to_run(scene, options)));
    fmt::print("{}\n", table_of(tallies.back(), scene));
    std::fflush(stdout);
    all.push_back(json_of(tallies.back(), scene, options.command_line));
  }
  if (scenes.size() > 1) fmt::print("{}", comparison_of(scenes, tallies));
  if (options.json) write_file_atomically(*options.json, (scenes.size() > 1 ? all : all[0]).dump(2) + "\n");
}

}  // namespace talus
