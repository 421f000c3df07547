// What a step leaves to the next, as an archive: all of a state that its scene does not say.
//
// Of the last step's region there is only what carrying over a stress from it reads (take_tables).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "continuum/step.h"

namespace talus {

/// The state's fields. Two states of a scene that agree in them go on alike, bit for bit.
nlohmann::json archive_of(const State& state);

/// SHA-256 of those fields: a name for the state, to the last bit.
std::string digest_of(const State& state);
std::string digest_of_fields(const nlohmann::json& fields);

/// Puts the fields in the place of what `state`, its scene's state at time zero, has. Throws InputError that names `where` when
/// they are not those of a state of that scene.
void restore(const nlohmann::json& fields, const std::string& where, State& state);

}  // namespace talus
