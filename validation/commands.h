// What each command of talus-validate does. All return the program's exit code and throw InputError or RunError.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "validation/gates/drift.h"
#include "validation/results.h"

namespace talus::validation {

struct Arguments {
  std::function<int(const Arguments&)> command;
  std::string suite, tag, gate = "both", reason, command_line;
  std::filesystem::path output, other, json;
  std::filesystem::path baseline = baseline_folder();
  std::filesystem::path reference_runs = "build/reference";
  std::vector<std::string> only;
  int workers = 1;
  bool force = false, no_report = false, annotate = false;
  bool pdf = false, junit = false, markdown = false;
  std::function<bool()> stop;
};

int list(const Arguments& arguments);
int run(const Arguments& arguments);
int check(const Arguments& arguments);
int report(const Arguments& arguments);
int compare(const Arguments& arguments);
int accept_baseline(const Arguments& arguments);
int mutate(const Arguments& arguments);

}  // namespace talus::validation
