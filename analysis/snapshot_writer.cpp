#include <array>
#include <utility>

#include "analysis/series_file.h"
#include "analysis/snapshot.h"
#include "analysis/snapshot_format.h"

namespace talus::analysis {

struct SnapshotWriter::File {
  SeriesFile series;
};

SnapshotWriter::SnapshotWriter(std::filesystem::path file, std::string_view made_by)
    : file_(new File{{std::move(file),
                      {format_name,
                       format_version,
                       "snapshots",
                       {{"positions", "", Number::float64, 3},
                        {"velocities", "velocity", Number::float64, 3},
                        {"volumes", "volume", Number::float64, 1}},
                       true},
                      made_by}}) {}

SnapshotWriter::~SnapshotWriter() = default;

void SnapshotWriter::append(const Snapshot& snapshot) {
  SeriesFile& series = file_->series;
  const std::size_t index = series.frames().size();
  check_frame(series.path(), index, snapshot, index > 0 ? series.frames().back().time : 0.0);
  const std::array<const void*, 3> data{snapshot.positions.data(), snapshot.velocities.data(),
                                        snapshot.volumes.data()};
  series.append(snapshot.time, static_cast<std::size_t>(snapshot.volumes.size()), data);
}

void SnapshotWriter::finish() { file_->series.finish(); }
void SnapshotWriter::finish_as(const std::filesystem::path& part) { file_->series.finish_as(part); }
void SnapshotWriter::append_all_of(const std::filesystem::path& part) { file_->series.append_all_of(part); }

void write_snapshots(const std::filesystem::path& file, const SnapshotSeries& series,
                     std::string_view made_by) {
  SnapshotWriter writer(file, made_by);
  for (const Snapshot& snapshot : series) writer.append(snapshot);
  writer.finish();
}

}  // namespace talus::analysis
