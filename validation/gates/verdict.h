// What a gate says.
#pragma once

#include <algorithm>
#include <string>

namespace talus::validation {

enum class Verdict { pass, inconclusive, fail };

/// "PASS", "INCONCLUSIVE", "FAIL".
inline std::string verdict_text(Verdict verdict) {
  if (verdict == Verdict::pass) return "PASS";
  return verdict == Verdict::fail ? "FAIL" : "INCONCLUSIVE";
}

/// The other way; anything else is inconclusive.
inline Verdict verdict_of(const std::string& text) {
  if (text == "PASS") return Verdict::pass;
  return text == "FAIL" ? Verdict::fail : Verdict::inconclusive;
}

/// The worse of two: FAIL over INCONCLUSIVE over PASS.
inline Verdict worse(Verdict a, Verdict b) { return std::max(a, b); }

}  // namespace talus::validation
