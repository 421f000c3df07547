// What a point was asked, as results.json tells it to people.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "validation/suites/suite.h"

namespace talus::validation {

/// "column collapse", "hourglass", "pile angle".
std::string family_of(const dem::Case& a_case);

/// What an observable is given in: "L0" and "R0" are the column's length and the cylinder's radius; "1" has none.
std::string unit_of(const dem::Case& a_case, const std::string& observable);

/// {"symbol", "metres"} of the length that lengths are over; null where there is none.
nlohmann::json length_unit_of(const dem::Case& a_case);

/// {group: {key: value}}: geometry, grains, contact, protocol, ruler, continuum; keys as in the files.
nlohmann::json parameters_of(const SuitePoint& point);

/// The continuum's constants and where they come from.
nlohmann::json calibration_of(const Suite& suite, const SuitePoint& point);

}  // namespace talus::validation
