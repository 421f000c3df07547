// The reference ensemble as a table for people.
#pragma once

#include <filesystem>
#include <string>

namespace talus::dem {

/// Markdown: for each case and point its observables, for each code the mean over seeds, their standard deviation and number,
/// the difference of the codes' means, and the reference value with its combined standard uncertainty
/// (analysis/statistics/uncertainty.h). Ends with the CPU time of all runs. Throws InputError for damaged records.
std::string reference_table(const std::filesystem::path& reference);

/// Markdown: the law of Beverloo fitted to the LIGGGHTS means of the slots, for each material. Says so where fewer than three openings
/// are stored with two seeds. Throws InputError.
std::string beverloo_table(const std::filesystem::path& reference, const std::filesystem::path& slot_case);

}  // namespace talus::dem
