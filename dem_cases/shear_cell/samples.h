// The table of samples that a code writes while it shears, read strictly.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace talus::dem {

struct SampleExpectation {
  std::string_view columns;  // names, with one space between
  std::int64_t steps_per_sample;
  std::int64_t step_count;    // of the last sample
  Eigen::Index sphere_count;  // in the column "grains" of every sample
};

/// Columns by name, one number a sample. Throws InputError naming file and line when samples are missing, cut off or
/// at a wrong step, a number cannot be read or is not finite, or a grain was lost.
std::map<std::string, std::vector<double>> read_samples(const std::filesystem::path& file,
                                                        const SampleExpectation& expected);

}  // namespace talus::dem
