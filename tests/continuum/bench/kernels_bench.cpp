// Times the kernels of a step against what this machine can do: continuum_kernels_bench [--benchmark_...]
//
// One benchmark for each KERNEL/SIZEx/START: SIZE times 4096 cells with 8 particles each; what warm and cold mean is said in
// kernels.h, and what a kernel must move and compute beside each in kernels.cpp. Context lines give the machine's measured
// limits first. Times are CPU seconds. Counters, all by the fastest call, as the
// limits are (another program on the same physical core can double CPU seconds too):
//   GB/s, GFLOP/s              of the model's bytes and flops
//   of_memory, of_L2, of_peak  the same as shares of the measured limits
//   distance, distance_L2      time over (bytes / bandwidth) of memory and of L2; the goal is a distance of at most 3
//   iterations                 of a solve; its bytes and flops are multiplied by them
// Data of the small sizes lives in L2 when warm, and in L3 otherwise: there a distance below 1 is no error.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "tests/continuum/bench/kernels.h"
#include "tests/continuum/bench/machine.h"

namespace talus::bench {
namespace {

constexpr int cold_calls = 10;  // flushing takes longer than most kernels

void set_counters(const Kernel& kernel, const MachineLimits& limits, double seconds, int iterations,
                  benchmark::State& state) {
  const double bytes = kernel.once.bytes + iterations * kernel.per_iteration.bytes,
               flops = kernel.once.flops + iterations * kernel.per_iteration.flops;
  state.counters["bytes"] = bytes;
  state.counters["flops"] = flops;
  state.counters["GB/s"] = 1e-9 * bytes / seconds;
  state.counters["GFLOP/s"] = 1e-9 * flops / seconds;
  state.counters["of_memory"] = bytes / seconds / limits.memory_bandwidth;
  state.counters["of_L2"] = bytes / seconds / limits.l2_bandwidth;
  state.counters["of_peak"] = flops / seconds / limits.peak;
  state.counters["distance"] = seconds * limits.memory_bandwidth / bytes;
  state.counters["distance_L2"] = seconds * limits.l2_bandwidth / bytes;
  state.counters["iterations"] = iterations;
}

void time_kernel(benchmark::State& state, const NamedKernel& named, int size, Start start,
                 const MachineLimits& limits) {
  const Kernel kernel = named.make(specimen(size), start);
  const bool flush = start == Start::cold && !named.solve;
  kernel.prepare();
  kernel.run();  // so that the first call that counts is as warm as the others
  double fastest = std::numeric_limits<double>::infinity();
  int iterations = 1;
  for ([[maybe_unused]] auto _ : state) {
    kernel.prepare();
    if (flush) flush_l2();
    const Sample sample = kernel.run();
    state.SetIterationTime(sample.seconds);
    fastest = std::min(fastest, sample.seconds);
    iterations = sample.iterations;  // the same in every call
  }
  set_counters(kernel, limits, fastest, iterations, state);
}

void register_kernels(const MachineLimits& limits) {
  for (const NamedKernel& kernel : kernels()) {
    for (const int size : {1, 2, 4, 8}) {
      for (const Start start : {Start::warm, Start::cold}) {
        const std::string name =
            fmt::format("{}/{}x/{}", kernel.name, size, start == Start::warm ? "warm" : "cold");
        auto* registered = benchmark::RegisterBenchmark(
            name.c_str(), [=](benchmark::State& state) { time_kernel(state, kernel, size, start, limits); });
        registered->Unit(benchmark::kMicrosecond)->UseManualTime();
        if (start == Start::cold && !kernel.solve) registered->Iterations(cold_calls);
      }
    }
  }
}

void tell_limits(const MachineLimits& limits) {
  const auto tell = [](const char* what, double value, const char* unit) {
    benchmark::AddCustomContext(what, fmt::format("{:.2f} {}", 1e-9 * value, unit));
  };
  tell("memory bandwidth, triad, one core", limits.memory_bandwidth, "GB/s");
  tell("L2 bandwidth, triad, one core", limits.l2_bandwidth, "GB/s");
  tell("peak, fused multiply-adds, one core", limits.peak, "GFLOP/s");
}

}  // namespace
}  // namespace talus::bench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);  // takes its own options out
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  const auto limits = talus::bench::measure_machine();
  talus::bench::tell_limits(limits);
  talus::bench::register_kernels(limits);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
