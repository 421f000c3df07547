// What a run writes as it goes: snapshots.h5 and render.h5 frame by frame, budget.csv step by step, bodies.csv and the bodies'
// surfaces.
//
// Each has its name once it is whole. HDF5 files that are being written do not survive a kill, so what stands when a checkpoint is
// taken goes to files of its own, OUTPUT/parts/snapshots_NNNN.h5, which are joined at the end.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "analysis/snapshot.h"
#include "continuum/files/atomic_file.h"
#include "continuum/io/checkpoint.h"
#include "continuum/render/render_file.h"
#include "continuum/step.h"

namespace talus {

class RunFiles {
 public:
  /// Starts anew, or goes on after `progress`. Throws InputError when what has been written until then is not all there.
  RunFiles(std::filesystem::path output, const State& state, std::string made_by,
           const RunProgress& progress = {});

  void add_step(const std::string& budget_row) { budget_.append(budget_row); }
  void add_frame(const State& state, const std::string& body_rows);
  /// Puts all so far on the disk, for a checkpoint; returns what that has to know, but for `steps`.
  RunProgress save();
  /// All files get their names. Parts stay, for a resume should the run be killed before it says that it is done (remove_traces).
  void finish();

 private:
  void open_part();
  void close_part();
  template <class Writer>
  void join(const char* name, std::unique_ptr<Writer>& writer);

  std::filesystem::path output_;
  std::string made_by_;
  double points_per_volume_;
  std::unique_ptr<analysis::SnapshotWriter> snapshots_;
  std::unique_ptr<RenderWriter> pictures_;  // null: none are asked for
  GrowingFile budget_;
  std::optional<GrowingFile> bodies_;
  RunProgress progress_;
  int frames_in_part_ = 0;
};

/// Takes away all that only an unfinished run needs, and what kills left half-written.
void remove_traces(const std::filesystem::path& output);

/// Takes away what an earlier run left in the folder, so that it cannot stand for the next one's.
void clear_old_results(const std::filesystem::path& output);

}  // namespace talus
