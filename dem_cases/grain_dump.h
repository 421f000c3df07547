// The trajectory file of a discrete code, "grains.dump": the text format of LAMMPS dumps, which OVITO and
// ParaView's readers also take. LIGGGHTS writes it itself and our YADE script writes the same, so one reader
// checks both.
#pragma once

#include <filesystem>
#include <string_view>

#include "analysis/snapshot.h"
#include "dem_cases/case.h"
#include "dem_cases/packing/packing.h"

namespace talus::dem {

inline constexpr std::string_view dump_file = "grains.dump";
/// Contacts of grains with each other at the release and at the end, in the same format.
inline constexpr std::string_view contacts_file = "contacts.dump";
inline constexpr std::string_view progress_file =
    "progress.txt";  // a line after each snapshot interval, from the start on

/// The mobile grains from the release on (time 0), in the order of the packing, y wrapped into [0,
/// thickness). Grain number i of the packing has the id i + 1. Throws InputError that names the file, the
/// snapshot and the grain
/// - when a snapshot is missing, cut off or at a wrong step, or a number cannot be read or is not finite;
/// - when a grain is lost, leaked through the floor, a wall, or before the release the gate, or reached the
/// far wall;
/// - when the column was not at rest at the release.
analysis::SnapshotSeries read_grain_dump(const Case& column, const Packing& packing,
                                         const std::filesystem::path& folder);

/// Fraction in [0, 1] of settling and run that is done, from the progress file.
double progress_of_run(const Case& column, const std::filesystem::path& folder);

}  // namespace talus::dem
