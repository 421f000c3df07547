// The real LIGGGHTS and YADE, as tests run them.
#pragma once

#include <functional>
#include <ostream>

#include "continuum/files/process.h"
#include "dem_cases/liggghts/liggghts.h"
#include "dem_cases/yade/yade.h"

namespace talus::dem {

/// The two codes behind one set of functions, as the harness will hold them.
struct Code {
  const char* name;
  std::string version;
  decltype(&liggghts::version) read_version;
  decltype(&liggghts::write_input) write_input;
  decltype(&liggghts::command) command;
  decltype(&liggghts::progress) progress;
  decltype(&liggghts::failure_text) failure_text;
  decltype(&liggghts::read_output) read_output;
  std::string log;
};

inline void PrintTo(const Code& code, std::ostream* out) { *out << code.name; }

inline const Code liggghts_code{"liggghts",
                                "3.8.0",
                                &liggghts::version,
                                &liggghts::write_input,
                                &liggghts::command,
                                &liggghts::progress,
                                &liggghts::failure_text,
                                &liggghts::read_output,
                                std::string(liggghts::log_file)};
inline const Code yade_code{
    "yade",          "2023.02a",          &yade::version,     &yade::write_input,         &yade::command,
    &yade::progress, &yade::failure_text, &yade::read_output, std::string(yade::log_file)};

inline ProcessResult run(const Code& code, const std::filesystem::path& folder,
                         std::function<bool()> stop = {}) {
  return run_process({.command = code.command(),
                      .folder = folder,
                      .log = code.log,
                      .environment = {},
                      .time_limit = std::chrono::seconds(120),
                      .stop = std::move(stop)});
}

}  // namespace talus::dem
