#include "tests/continuum/bench/machine.h"

#include <benchmark/benchmark.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <limits>
#include <vector>

namespace talus::bench {
namespace {

constexpr std::size_t far_larger_than_caches = std::size_t{160} << 20;  // bytes, each of three arrays

/// CPU seconds of the fastest of several calls: the machine may be shared.
template <class Function>
double fastest(int calls, const Function& f) {
  double seconds = std::numeric_limits<double>::infinity();
  for (int i = 0; i < calls; ++i) {
    const double start = cpu_seconds();
    f();
    seconds = std::min(seconds, cpu_seconds() - start);
  }
  return seconds;
}

double triad_bandwidth(std::size_t bytes_each, int sweeps) {
  const std::size_t n = bytes_each / sizeof(double);
  std::vector<double> a(n, 0.0), b(n, 1.0), c(n, 2.0);
  const double seconds = fastest(5, [&] {
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      double* __restrict to = a.data();
      const double *from = b.data(), *scaled = c.data();
      for (std::size_t i = 0; i < n; ++i) to[i] = from[i] + 3.0 * scaled[i];
      benchmark::ClobberMemory();
    }
  });
  return static_cast<double>(3 * sizeof(double) * n) * sweeps / seconds;
}

double fused_multiply_add_peak() {
  using Vector [[gnu::vector_size(32)]] = double;
  constexpr int chains = 12, rounds = 1'000'000;  // enough chains to hide the latency
  std::array<Vector, chains> x{};
  Vector factor{0.5, 0.5, 0.5, 0.5}, term{1.0, 1.0, 1.0, 1.0};
  benchmark::DoNotOptimize(factor);
  benchmark::DoNotOptimize(term);
  const double seconds = fastest(5, [&] {
    std::array<Vector, chains> y = x;
    for (int round = 0; round < rounds; ++round) {
      for (Vector& chain : y) chain = chain * factor + term;
    }
    x = y;
    benchmark::DoNotOptimize(x);
  });
  constexpr double flops = 2.0 * 4.0 * chains * rounds;
  return flops / seconds;
}

}  // namespace

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::size_t l2_bytes() {
  const long size = sysconf(_SC_LEVEL2_CACHE_SIZE);
  return size > 0 ? static_cast<std::size_t>(size) : std::size_t{2} << 20;
}

void flush_l2() {
  static std::vector<char> buffer(16 * l2_bytes());
  for (std::size_t i = 0; i < buffer.size(); i += 64) ++buffer[i];
  benchmark::ClobberMemory();
}

MachineLimits measure_machine() {
  return {triad_bandwidth(far_larger_than_caches, 1), triad_bandwidth(l2_bytes() / 6, 500),
          fused_multiply_add_peak()};
}

}  // namespace talus::bench
