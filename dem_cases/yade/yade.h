// Case -> YADE input in a folder -> command -> snapshots.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/snapshot.h"
#include "dem_cases/case.h"
#include "dem_cases/packing/packing.h"

namespace talus::dem::yade {

/// Where the output of command() is to go, in the run's folder; failure_text() reads it there.
inline constexpr std::string_view log_file = "yade.out";

/// The program's own version, e.g. "2023.02a". Throws InputError when it is not installed, with what to
/// install.
std::string version();

/// Writes everything the run needs into `folder`. The deck is self-contained: it can be rerun by hand there.
/// Output of an earlier run there is removed, so that it cannot pass for this one's.
void write_input(const Case& column, const Packing& packing, const std::filesystem::path& folder);

/// The command line to be run in `folder`, on one core. Throws InputError when the program is not installed.
std::vector<std::string> command();

/// Fraction in [0, 1] of the run that is done, from what the run has written so far.
double progress(const Case& column, const std::filesystem::path& folder);

/// What went wrong, from the logs of a run that failed; empty when they do not say.
std::string failure_text(const std::filesystem::path& folder);

/// The mobile grains from the release on (time 0). Throws InputError when a grain leaked or was lost, the
/// column was not at rest before release, or output is missing or damaged.
analysis::SnapshotSeries read_output(const Case& column, const Packing& packing,
                                     const std::filesystem::path& folder);

}  // namespace talus::dem::yade
