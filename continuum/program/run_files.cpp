#include "continuum/program/run_files.h"

#include <fmt/format.h>

#include "continuum/files/input_error.h"
#include "continuum/io/stl.h"
#include "continuum/render/render_frame.h"
#include "continuum/solids/surface_mesh.h"

namespace talus {
namespace {

using Path = std::filesystem::path;

analysis::Snapshot snapshot_of(const State& state) {
  analysis::Snapshot snapshot{state.time, state.particles.positions, state.particles.velocities, {}};
  snapshot.volumes.resize(state.particles.count());
  for (Eigen::Index p = 0; p < state.particles.count(); ++p) {
    const auto material = static_cast<std::size_t>(state.particles.materials[static_cast<std::size_t>(p)]);
    snapshot.volumes[p] = state.particles.masses[p] / state.materials[material].grain_density;
  }
  return snapshot;
}

Path part_file(const Path& output, const char* name, int part) {
  return output / "parts" / fmt::format("{}_{:04}.h5", name, part);
}

GrowingFile budget_file(const Path& output, const RunProgress& progress) {
  const Path file = output / "budget.csv";
  return progress.budget_bytes > 0 ? GrowingFile(file, progress.budget_bytes)
                                   : GrowingFile(file, Budget::header());
}

void write_surfaces(const Path& output, const State& state) {
  std::filesystem::create_directories(output / "bodies");
  for (const Body& body : state.bodies)
    write_file_atomically(output / "bodies" / (body.name + ".stl"), binary_stl(surface_mesh(body.shape)));
}

}  // namespace

RunFiles::RunFiles(Path output, const State& state, std::string made_by, const RunProgress& progress)
    : output_(std::move(output)),
      made_by_(std::move(made_by)),
      points_per_volume_(state.render_points.per_volume),
      budget_(budget_file(output_, progress)),
      progress_(progress) {
  for (int part = 0; part < progress_.parts; ++part) {
    for (const char* name : {"snapshots", "render"}) {
      const bool wanted = name == std::string("snapshots") || points_per_volume_ > 0.0;
      if (const Path file = part_file(output_, name, part); wanted && !std::filesystem::exists(file))
        throw InputError(
            fmt::format("{}: frames of the unfinished run should be here, and are not", file.string()));
    }
  }
  open_part();
  if (state.bodies.empty()) return;
  const Path file = output_ / "bodies.csv";
  if (progress_.bodies_bytes > 0) {
    bodies_.emplace(file, progress_.bodies_bytes);
  } else {
    write_surfaces(output_, state);
    bodies_.emplace(file, BodyLog::header());
  }
}

void RunFiles::open_part() {
  snapshots_ = std::make_unique<analysis::SnapshotWriter>(output_ / "snapshots.h5", made_by_);
  if (points_per_volume_ > 0.0)
    pictures_ = std::make_unique<RenderWriter>(output_ / "render.h5", points_per_volume_, made_by_);
  frames_in_part_ = 0;
}

void RunFiles::close_part() {
  std::filesystem::create_directories(output_ / "parts");
  snapshots_->finish_as(part_file(output_, "snapshots", progress_.parts));
  if (pictures_) pictures_->finish_as(part_file(output_, "render", progress_.parts));
  ++progress_.parts;
  snapshots_.reset();  // before the next one: a writer takes its unfinished file with it
  pictures_.reset();
}

void RunFiles::add_frame(const State& state, const std::string& body_rows) {
  snapshots_->append(snapshot_of(state));
  if (pictures_) pictures_->append(render_frame_of(state));
  if (bodies_) bodies_->append(body_rows);
  ++frames_in_part_;
  ++progress_.frames;
}

RunProgress RunFiles::save() {
  if (frames_in_part_ > 0) {
    close_part();
    open_part();
  }
  progress_.budget_bytes = budget_.save();
  if (bodies_) progress_.bodies_bytes = bodies_->save();
  return progress_;
}

template <class Writer>
void RunFiles::join(const char* name, std::unique_ptr<Writer>& writer) {
  if (!writer) return;
  for (int part = 0; part < progress_.parts; ++part) writer->append_all_of(part_file(output_, name, part));
  writer->finish();
}

void RunFiles::finish() {
  if (progress_.parts > 0) {
    if (frames_in_part_ > 0) {
      close_part();
      open_part();
    }
    join("snapshots", snapshots_);
    join("render", pictures_);
  } else {
    snapshots_->finish();
    if (pictures_) pictures_->finish();
  }
  budget_.finish();
  if (bodies_) bodies_->finish();
}

void remove_traces(const Path& output) {
  remove_checkpoints(output);
  std::filesystem::remove_all(output / "parts");
  for (const auto& entry : std::filesystem::directory_iterator(output)) {
    const std::string name = entry.path().filename();
    for (const char* ours : {"run.", "budget.", "bodies.", "snapshots.", "render."}) {
      const bool unfinished = name.find(".partial") != std::string::npos;
      if (name.starts_with(ours) && unfinished) std::filesystem::remove(entry.path());
    }
  }
}

void clear_old_results(const Path& output) {
  remove_traces(output);
  for (const char* old :
       {"snapshots.h5", "snapshots.xdmf", "render.h5", "render.xdmf", "run.json", "budget.csv", "bodies.csv"})
    std::filesystem::remove(output / old);
  const auto remove_from = [](const Path& folder, const auto& ours) {
    if (!std::filesystem::is_directory(folder)) return;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (ours(entry.path())) std::filesystem::remove_all(entry.path());
    }
  };
  remove_from(output / "bodies", [](const Path& file) { return file.extension() == ".stl"; });
  remove_from(output / "fault",
              [](const Path& file) { return file.extension() == ".talus" || file.filename() == "run.toml"; });
  remove_from(output / "qp",
              [](const Path& folder) { return folder.filename().string().starts_with("step_"); });
}

}  // namespace talus
