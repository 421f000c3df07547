#include "continuum/parallel.h"

#include <algorithm>

namespace talus {
namespace {

int threads_to_use = 1;

}  // namespace

int thread_count() { return threads_to_use; }

void set_thread_count(int threads) { threads_to_use = std::max(1, threads); }

}  // namespace talus
