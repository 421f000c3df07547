// The one error for points that a law cannot be fitted to.
#pragma once

#include <stdexcept>

namespace talus::analysis {

/// Too few points, points that do not determine the parameters, or a fit that does not settle. The message says which.
class FitError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace talus::analysis
