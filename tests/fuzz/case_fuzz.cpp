// Case files of the discrete codes, with all that is checked of them before a deck is written.
#include "continuum/files/checked_table.h"
#include "dem_cases/case.h"
#include "dem_cases/shear_cell/shear_cell.h"
#include "dem_cases/time_step.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace talus;
  const auto file = testing::fuzz_file("case.toml", data, size);
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  testing::may_refuse<InputError>([&] {
    if (text.find("shear_cell") != text.npos) {
      dem::read_shear_cell(file);
    } else {
      for (const dem::Case& point : dem::read_case_points(file)) dem::check_time_step(point);
    }
  });
  return 0;
}
