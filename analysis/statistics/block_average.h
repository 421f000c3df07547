// Mean of a steady but correlated time series and its standard error, by block averages (Flyvbjerg & Petersen 1989).
//
// The n samples are averaged in blocks of B = 1, 2, 4, ... . The error that the block means show as if they were independent,
//   e_B = s_B / sqrt(n / B),
// grows with B until the blocks are longer than the memory of the series, and is flat from there on, only noisier. With
// m = (e_B / e_1)^2, the samples that count as one, e_B^2 is still short by a share of about m / B, and uncertain by a share
// of about sqrt(2 B / n). The blocks are long enough where the square of the first is the less: B^3 > m^2 n / 2. Taken is the
// first B with twice as much again, B^3 > 2 m^2 n (as Lee, Needs & Towler 2011 have it).
#pragma once

#include <cstddef>
#include <span>

namespace talus::analysis {

struct BlockAverage {
  double mean;               // of all samples
  double standard_error;     // of the mean
  std::size_t block_length;  // B, samples
  double
      effective_number;  // variance of the samples over standard_error^2: as many independent ones would tell as much
  bool
      flat;  // false: the series is too short for blocks that are long enough, and the standard error is only a lower bound
};

/// Blocks are tried up to an eighth of the series; what does not fill a block is left out at the end, of the error only. A
/// series that does not change has a zero error and n effective samples. Throws FitError for fewer than two samples or a
/// value that is not finite.
BlockAverage block_average(std::span<const double> samples);

}  // namespace talus::analysis
