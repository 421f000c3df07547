// The one error for what a user can mend.
#pragma once

#include <stdexcept>

namespace talus {

/// Something the user wrote, or a place the user named, cannot be used. The message is complete: it is shown as it stands,
/// and the program ends with exit code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace talus
