// The kernels of a step as benchmarks call them, each with the least it must move and compute.
//
// Traffic model: every input that the result depends on is read once from memory, every output written once; a double is 8
// bytes, an index 4. Neighbours follow from a cell's place in the grid, so connectivity counts as one index a cell, whatever
// tables an implementation reads. Scratch, and what a store reads first, count nothing. So the bound is below what any
// implementation can reach, and the distance to it never flatters. Flops count additions and multiplications of the
// formulas as they stand in the headers, divisions and roots as one.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/continuum/bench/specimen.h"

namespace talus::bench {

struct Work {
  double bytes = 0.0, flops = 0.0;
};

/// What one call took; iterations of a solve, 1 of anything else.
struct Sample {
  double seconds;  // of CPU
  int iterations = 1;
};

/// One thing to time. `prepare`, not timed, comes before each `run`.
struct Kernel {
  Work once, per_iteration;
  std::function<void()> prepare;
  std::function<Sample()> run;
};

/// Warm: the call before left its data in the caches; a solve starts from the stress of the last step.
/// Cold: L2 was flushed; a solve starts from no stress at all, with as many rounds as the first step of a run has.
enum class Start { warm, cold };

struct NamedKernel {
  std::string name;
  bool solve;  // its cold start is that of the stress, not of the caches
  std::function<Kernel(const Specimen&, Start)> make;
};

/// All of them, in the order of a step.
std::vector<NamedKernel> kernels();

}  // namespace talus::bench
