// What one core of this machine can do at best: the bounds that kernels are measured against.
#pragma once

#include <cstddef>

namespace talus::bench {

struct MachineLimits {
  double memory_bandwidth;  // bytes/s: triad a = b + s c over arrays far larger than any cache
  double l2_bandwidth;      // bytes/s: the same over arrays that together fill half of L2
  double peak;              // flops/s: independent fused multiply-adds in registers
};

/// CPU seconds of this thread so far. What others do on a shared machine hardly enters them; a reading costs 0.3 us.
double cpu_seconds();

/// Takes about a second. Traffic of the triad counts 24 bytes an entry, as STREAM does: what a store first reads is not in it.
MachineLimits measure_machine();

/// Bytes of the L2 cache of a core; 2 MiB where the system does not say.
std::size_t l2_bytes();

/// Writes through a buffer of 16 times L2, so that nothing else is left in L1 and L2. A larger L3 may still hold it.
void flush_l2();

}  // namespace talus::bench
