// When a curve in time has come to its end value, and whether it has: one measure of rest for every case.
#pragma once

#include <span>

namespace talus::analysis {

/// The first time after which `curve` stays within the share of its total change (last less first value) of its last value,
/// linear between samples; the first time if it never left that band. Both spans have the same size, at least 1, times
/// increase. With a curve that still moves at the end, this is the end of the record and not of the motion: see
/// range_at_end.
double settling_time(std::span<const double> time, std::span<const double> curve, double share);

/// Largest less smallest value over the last tenth of the time, which the samples cover whole. Infinite for a single
/// sample, which shows no rest.
double range_at_end(std::span<const double> time, std::span<const double> curve);

}  // namespace talus::analysis
