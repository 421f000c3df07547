// Suite files. The case and the calibration they may name lie beside them.
#include "continuum/files/checked_table.h"
#include "tests/fuzz/fuzz_file.h"
#include "validation/suites/suite.h"

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const std::filesystem::path source = TALUS_SOURCE_DIR, folder = talus::testing::fuzz_folder();
  std::filesystem::copy_file(source / "tests/dem_cases/data/tiny_column.toml", folder / "case.toml");
  std::filesystem::copy_file(source / "dem_cases/shear_cell/calibration.toml", folder / "calibration.toml");
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = talus::testing::fuzz_file("suite.toml", data, size);
  talus::testing::may_refuse<talus::InputError>([&] { talus::validation::read_suite(file.string()); });
  return 0;
}
