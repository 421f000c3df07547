// Checkpoints: files from which a run goes on as if it had never stopped, bit for bit.
//
//   OUTPUT/checkpoint.talus            the newest; written beside its place, flushed to the disk, renamed
//   OUTPUT/checkpoint.previous.talus   the one before, should the disk have spoilt the newest
//
// A first line in plain text has the version of the format and the SHA-256 of the rest (archive.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "continuum/io/body_log.h"
#include "continuum/io/budget.h"
#include "continuum/step.h"

namespace talus {

/// How far a run has got, and how much of its files belongs to that.
struct RunProgress {
  int frames = 0;                 // that are written, the one at the start too
  int steps = 0;                  // taken
  int parts = 0;                  // files that the frames so far are in (run_files.h)
  std::int64_t budget_bytes = 0;  // of budget.csv
  std::int64_t bodies_bytes = 0;  // of bodies.csv; 0: there is none
};

/// What a run is, beside its state and its books.
struct RunIdentity {
  std::string scene_file;    // where it was, an absolute path
  std::string input_hash;    // SHA-256 of the scene's text
  std::string solver;        // solver_line() of the program
  std::string command_line;  // that started it
};

struct Checkpoint {
  RunIdentity identity;
  RunProgress progress;
  nlohmann::json state, budget, body_log;  // fields (archive.h)
};

Checkpoint make_checkpoint(const RunIdentity& identity, const RunProgress& progress, const State& state,
                           const Budget& budget, const BodyLog& body_log);

inline constexpr const char* checkpoint_name = "checkpoint.talus";
inline constexpr const char* previous_checkpoint_name = "checkpoint.previous.talus";

/// Writes the newest checkpoint of a folder; the one that was is then the previous one. Throws InputError when that fails; what
/// was there is there still.
void write_checkpoint(const std::filesystem::path& folder, const Checkpoint& checkpoint);

/// The newest whole one of a folder. `told` becomes what was wrong with a newer one. Throws InputError when there is none.
Checkpoint read_checkpoint(const std::filesystem::path& folder, std::string& told);
bool has_checkpoint(const std::filesystem::path& folder);
/// With what a killed run left of ones that it had begun to write. Nothing happens where there are none.
void remove_checkpoints(const std::filesystem::path& folder);

}  // namespace talus
