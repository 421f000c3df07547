// GSL's own answer to an error is to abort the program. Here it returns a status, which becomes an exception.
#pragma once

#include <gsl/gsl_errno.h>

#include <string>

#include "analysis/statistics/fit_error.h"

namespace talus::analysis {

/// While one of these lives, GSL returns error statuses instead of aborting. GSL's handler is one for the whole program, so
/// fits are not made from several threads at once.
class GslErrorsReturned {
 public:
  GslErrorsReturned() : before_(gsl_set_error_handler_off()) {}
  ~GslErrorsReturned() { gsl_set_error_handler(before_); }
  GslErrorsReturned(const GslErrorsReturned&) = delete;
  GslErrorsReturned& operator=(const GslErrorsReturned&) = delete;

 private:
  gsl_error_handler_t* before_;
};

/// Throws FitError that says what was tried and what GSL answered.
inline void require_gsl(int status, const std::string& what) {
  if (status != GSL_SUCCESS) throw FitError(what + ": " + gsl_strerror(status));
}

}  // namespace talus::analysis
