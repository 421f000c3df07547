// Loops over more than one thread, with results that do not depend on how many there are.
//
// Work is cut into blocks of a fixed size, so that what is added up, and in which order, is the same for any number of
// threads: a sum is that of the blocks' sums, in their order. Threads are OpenMP's; a loop of one block stays on the caller's.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace talus {

/// Threads that loops may use, at least 1. Set once by a program; results do not depend on it.
int thread_count();
void set_thread_count(int threads);

/// One block, by the same machine code whoever calls it: code inlined twice may be vectorised, and so rounded, in two ways.
template <class Function>
[[gnu::noipa]] auto run_block(const Function& f, std::ptrdiff_t begin, std::ptrdiff_t end) {
  return f(begin, end);
}

/// f(begin, end) for each block of [0, count); different blocks may run at the same time.
template <class Function>
void for_each_block(std::ptrdiff_t count, std::ptrdiff_t block, const Function& f) {
  const std::ptrdiff_t blocks = (count + block - 1) / block;
  if (blocks <= 1 || thread_count() == 1) {  // a parallel region of one thread is not free
    for (std::ptrdiff_t b = 0; b < blocks; ++b) run_block(f, b * block, std::min(count, (b + 1) * block));
    return;
  }
#pragma omp parallel for schedule(static) num_threads(thread_count())
  for (std::ptrdiff_t b = 0; b < blocks; ++b) run_block(f, b * block, std::min(count, (b + 1) * block));
}

/// The sum of f(begin, end) over the blocks of [0, count), added in their order. `Value` has += and a zero by {}.
template <class Value = double, class Function>
Value sum_over_blocks(std::ptrdiff_t count, std::ptrdiff_t block, const Function& f) {
  const std::ptrdiff_t blocks = (count + block - 1) / block;
  Value total{};
  if (blocks <= 1 || thread_count() == 1) {
    for (std::ptrdiff_t b = 0; b < blocks; ++b)
      total += run_block(f, b * block, std::min(count, (b + 1) * block));
    return total;
  }
  static thread_local std::vector<Value> sums;
  sums.assign(static_cast<std::size_t>(blocks), Value{});
  Value* const sum_of_block = sums.data();  // the caller's, seen by all threads
#pragma omp parallel for schedule(static) num_threads(thread_count())
  for (std::ptrdiff_t b = 0; b < blocks; ++b)
    sum_of_block[b] = run_block(f, b * block, std::min(count, (b + 1) * block));
  for (std::ptrdiff_t b = 0; b < blocks; ++b) total += sum_of_block[b];
  return total;
}

}  // namespace talus
