// Where bodies are, how they move and what the sand does to them, as comma-separated values: a row for each body and frame.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "continuum/step.h"

namespace talus {

class BodyLog {
 public:
  /// What the sand gave to bodies in a step, for the means of the next rows.
  void add(const StepReport& report);

  /// time_s, body (its name), position of the centre of mass, orientation as a quaternion that turns the body's axes into
  /// those of space, velocity, angular velocity, and the sand's force and torque about the centre of mass: means over the steps since
  /// the last rows, 0 before the first.
  static std::string header();
  /// Starts the means anew.
  std::string rows(const State& state);

  /// What the means are made of so far, as fields of an archive (archive.h), and back. Throws InputError that names `where`.
  nlohmann::json fields() const;
  void restore(const nlohmann::json& fields, const std::string& where);

 private:
  double duration_ = 0.0;  // s
  std::vector<BodyImpulse> impulses_;
};

}  // namespace talus
