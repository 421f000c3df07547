// The contacts of grains with each other that a run wrote at its release and at its end, for coarse graining.
#pragma once

#include <filesystem>
#include <vector>

#include "analysis/coarse_graining/coarse_graining.h"
#include "dem_cases/case.h"
#include "dem_cases/packing/packing.h"

namespace talus::dem {

/// Contacts at the two moments that a run writes.
struct ContactMoments {
  std::vector<analysis::GrainContact> release, end;
};

/// Each contact once, with a mobile grain as its `centre` and y wrapped as in the snapshots; where the other is a fixed grain,
/// `other` is the point where they touch. Contacts with planes and shells are not told by both codes and are left
/// out. Throws InputError for a missing, damaged or unfinished file.
ContactMoments read_contacts(const Case& a_case, const Packing& packing, const std::filesystem::path& folder);

}  // namespace talus::dem
