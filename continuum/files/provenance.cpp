#include "continuum/files/provenance.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gsl/gsl_version.h>
#include <openssl/evp.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "continuum/files/atomic_file.h"
#include "talus_git_version.h"

namespace talus {
namespace {

#ifdef __clang__
constexpr std::string_view compiler = "clang++ " __clang_version__;
#else
constexpr std::string_view compiler = "g++ " __VERSION__;
#endif

std::string cpu_name() {
  std::ifstream cpus("/proc/cpuinfo");
  for (std::string line; std::getline(cpus, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

std::string host_name() {
  utsname host{};
  uname(&host);
  return fmt::format("{} {} {}", host.sysname, host.release, host.machine);
}

}  // namespace

nlohmann::json provenance() {
  return {
      {"version", TALUS_VERSION},
      {"git_hash", TALUS_GIT_HASH},
      {"git_dirty", TALUS_GIT_DIRTY},
      {"compiler", compiler},
      {"compiler_flags", TALUS_CXX_FLAGS},
      {"build_type", TALUS_BUILD_TYPE},
      {"libraries",
       {{"eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
        {"gsl", GSL_VERSION},
        {"fmt", fmt::format("{}.{}.{}", FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100)},
        {"nlohmann_json", fmt::format("{}.{}.{}", NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR,
                                      NLOHMANN_JSON_VERSION_PATCH)},
        {"hdf5", TALUS_HDF5_VERSION},
        {"ode", TALUS_ODE_VERSION},
        {"cgal", TALUS_CGAL_VERSION},
        {"tomlplusplus", TALUS_TOMLPLUSPLUS_VERSION},
        {"openssl", TALUS_OPENSSL_VERSION}}},
      {"host", host_name()},
      {"cpu", cpu_name()},
      {"cores", sysconf(_SC_NPROCESSORS_ONLN)},
      {"time_utc", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)))},
  };
}

std::string version_line(std::string_view program) {
  return fmt::format("{} {} (git {}{}) {} {}", program, TALUS_VERSION, TALUS_GIT_HASH,
                     TALUS_GIT_DIRTY ? ", dirty" : "", compiler, TALUS_BUILD_TYPE);
}

std::string version_text(std::string_view program) {
  const nlohmann::json made_by = provenance();
  std::string libraries;
  for (const auto& [name, version] : made_by.at("libraries").items())
    libraries += fmt::format(" {} {}", name, version.get<std::string>());
  return fmt::format("{}\nflags: {}\nlibraries:{}\nmachine: {}, {} cores, {}", version_line(program),
                     made_by.at("compiler_flags").get<std::string>(), libraries,
                     made_by.at("cpu").get<std::string>(), made_by.at("cores").get<int>(),
                     made_by.at("host").get<std::string>());
}

std::string solver_line() {
  const std::string hash =
      sha256(fmt::format("{}\n{}\n", TALUS_SOLVER_SOURCES, TALUS_CXX_FLAGS)).substr(0, 16);
  return fmt::format("talus {} solver {} {} {}", TALUS_VERSION, hash, compiler, TALUS_BUILD_TYPE);
}

std::string command_line_of(int argc, char** argv) {
  return utf8(fmt::format("{}", fmt::join(argv, argv + argc, " ")));
}

std::string utf8(std::string_view text) {
  using nlohmann::json;
  return json::parse(json(text).dump(-1, ' ', false, json::error_handler_t::replace)).get<std::string>();
}

std::string sha256(std::string_view content) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  EVP_Digest(content.data(), content.size(), digest.data(), &size, EVP_sha256(), nullptr);
  std::string hex;
  for (unsigned int i = 0; i < size; ++i) hex += fmt::format("{:02x}", digest[i]);
  return hex;
}

std::string sha256_of_folder(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::string all;
  for (const auto& file : files)
    all += fmt::format("{}\n{}\n", file.lexically_relative(folder).generic_string(), sha256(read_file(file)));
  return sha256(all);
}

}  // namespace talus
