// Recorded quadratic programs, by way of HDF5, whose own code is not instrumented.
#include "continuum/files/input_error.h"
#include "continuum/qp/problem_file.h"
#include "tests/fuzz/fuzz_file.h"

// HDF5 1.10 loses some memory of its own with many damaged files; once per file, and not ours to mend.
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5\n"; }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = talus::testing::fuzz_file("problem.h5", data, size);
  talus::testing::may_refuse<talus::InputError>([&] { talus::read_problem(file); });
  return 0;
}
