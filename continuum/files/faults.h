// Several faults of one file, told at once.
#pragma once

#include <string>
#include <vector>

#include "continuum/files/input_error.h"

namespace talus {

/// What is wrong with a file: complete messages, one a fault.
using Faults = std::vector<std::string>;

/// Whether `read` went through; the InputError that it throws instead is kept. Of what one call reads only the first fault
/// is found, so there is a call for each part that can be read without the others.
template <class Read>
bool passes(Faults& faults, Read read) {
  try {
    read();
    return true;
  } catch (const InputError& error) {
    faults.emplace_back(error.what());
    return false;
  }
}

/// Throws one InputError with all faults, a line each, unless there are none.
inline void refuse(const Faults& faults) {
  if (faults.empty()) return;
  std::string text = faults.front();
  for (std::size_t i = 1; i < faults.size(); ++i) text += '\n' + faults[i];
  throw InputError(text);
}

}  // namespace talus
