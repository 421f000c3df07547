#include "continuum/io/checkpoint.h"

#include <fmt/format.h>

#include "continuum/files/atomic_file.h"
#include "continuum/files/input_error.h"
#include "continuum/files/put_in_place.h"
#include "continuum/io/archive.h"
#include "continuum/io/state_archive.h"

namespace talus {
namespace {

using Path = std::filesystem::path;

constexpr const char* format_name = "talus-checkpoint";
constexpr int format_version = 1;
constexpr const char* next_checkpoint_name = "checkpoint.next.talus";  // until it is the newest

template <class Archive, class Of>
void describe(Archive& archive, Of& checkpoint) {
  archive.number("scene_file", checkpoint.identity.scene_file);
  archive.number("input_hash", checkpoint.identity.input_hash);
  archive.number("solver", checkpoint.identity.solver);
  archive.number("command_line", checkpoint.identity.command_line);
  archive.number("frames", checkpoint.progress.frames);
  archive.number("steps", checkpoint.progress.steps);
  archive.number("parts", checkpoint.progress.parts);
  archive.number("budget_bytes", checkpoint.progress.budget_bytes);
  archive.number("bodies_bytes", checkpoint.progress.bodies_bytes);
}

/// The objects of a checkpoint in one flat one, each field behind its object's name.
void put(const nlohmann::json& fields, const std::string& name, nlohmann::json& all) {
  for (const auto& [key, value] : fields.items()) all[name + "/" + key] = value;
}
nlohmann::json take(nlohmann::json& all, const std::string& name) {
  nlohmann::json fields = nlohmann::json::object();
  for (auto& [key, value] : all.items()) {
    if (key.starts_with(name + "/")) fields[key.substr(name.size() + 1)] = std::move(value);
  }
  return fields;
}

Checkpoint read_file_of(const Path& file) {
  nlohmann::json all = unpacked_archive(format_name, format_version, read_file(file), file.string());
  Checkpoint checkpoint;
  ArchiveReader reader(all, file.string());
  describe(reader, checkpoint);
  const RunProgress& progress = checkpoint.progress;
  if (progress.frames < 0 || progress.steps < 0 || progress.parts < 0 || progress.budget_bytes < 0 ||
      progress.bodies_bytes < 0)
    reader.fail("frames", "or what is beside it is negative");
  checkpoint.state = take(all, "state");
  checkpoint.budget = take(all, "budget");
  checkpoint.body_log = take(all, "body_log");
  return checkpoint;
}

}  // namespace

Checkpoint make_checkpoint(const RunIdentity& identity, const RunProgress& progress, const State& state,
                           const Budget& budget, const BodyLog& body_log) {
  return {identity, progress, archive_of(state), budget.fields(), body_log.fields()};
}

void write_checkpoint(const Path& folder, const Checkpoint& checkpoint) {
  ArchiveWriter writer;
  describe(writer, checkpoint);
  nlohmann::json all = writer.fields();
  put(checkpoint.state, "state", all);
  put(checkpoint.budget, "budget", all);
  put(checkpoint.body_log, "body_log", all);
  const std::string text = packed_archive(format_name, format_version, all);
  // The new one is whole before the one that was takes its second name: two stand at every moment once there are two.
  const Path newest = folder / checkpoint_name, next = folder / next_checkpoint_name;
  write_file_atomically(next, text);
  std::error_code why;
  if (std::filesystem::exists(newest)) why = put_in_place(newest, folder / previous_checkpoint_name);
  if (!why) why = put_in_place(next, newest);
  if (why) throw InputError(fmt::format("{}: cannot be put in place: {}", newest.string(), why.message()));
}

Checkpoint read_checkpoint(const Path& folder, std::string& told) {
  told.clear();
  for (const char* name : {checkpoint_name, previous_checkpoint_name}) {
    if (!std::filesystem::exists(folder / name)) continue;
    try {
      return read_file_of(folder / name);
    } catch (const InputError& error) {
      told += (told.empty() ? "" : "; ") + std::string(error.what());
    }
  }
  throw InputError(told.empty() ? fmt::format("{}: no checkpoint of an unfinished run is here ({})",
                                              folder.string(), checkpoint_name)
                                : told);
}

bool has_checkpoint(const Path& folder) {
  return std::filesystem::exists(folder / checkpoint_name) ||
         std::filesystem::exists(folder / previous_checkpoint_name);
}

void remove_checkpoints(const Path& folder) {
  if (!std::filesystem::is_directory(folder)) return;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    const bool begun = name.starts_with("checkpoint.") && name.find(".partial") != std::string::npos;
    if (begun || name == checkpoint_name || name == previous_checkpoint_name || name == next_checkpoint_name)
      std::filesystem::remove(entry.path());
  }
}

}  // namespace talus
