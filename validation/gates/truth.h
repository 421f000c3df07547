// The truth gate: does the continuum agree with the discrete codes? (The drift gate, against our own last accepted results, is
// another thing: drift.h.)
//
//   deviation = continuum mean / reference - 1        reference: the mean of the discrete codes' means (analysis/statistics/uncertainty.h)
//   U         = k sqrt(u_ref^2 + u_num^2), k = 2      u_ref: seeds, codes and measuring; u_num: lattice seeds, cells and time step of
//                                                     the continuum itself (numerical_uncertainty.h); standard uncertainties, relative
//
//   FAIL          |deviation| > band + U              outside the practical band, and not by chance
//   PASS          |deviation| <= band and U <= band   inside it, and known well enough to say so
//   INCONCLUSIVE  otherwise, and whenever a run is missing, not finite, not at rest or did not converge, or an uncertainty is unknown
//
// Where one discrete code alone has run a point, the codes' spread is not known there: the largest that other points of the suite have for the
// same observable stands in, and where there is none the row is inconclusive.
//
// The band says what a user would call agreement; it stands in the case file with its reason. U is computed, never chosen.
//
// A law that needs no discrete code to be judged by (backends/balances.h) is a band with its "exact" value, which nothing leaves uncertain.
//
// at_rest is a row of its own: a deposit that rests at the end in the discrete codes and does not in the continuum is a FAIL, whatever it measures.
//
// profile_L1 compares whole final profiles, depth_curve_L1 a sphere's whole depth in time: the deviation is the area between the mean profiles over the reference's, never negative. Its
// uncertainties are the same areas: between seeds and their mean, the codes' means, the coarse run and the standard one.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "validation/gates/verdict.h"

namespace talus::validation {

inline constexpr double coverage_factor = 2.0;

struct TruthJudgement {
  nlohmann::json rows;  // one entry an observable, as results.json has them ("truth")
  Verdict verdict;
};

/// Why the runs of a point cannot be judged, whatever their figures: one is not at rest, or has unconverged solves. Empty when they can.
std::string why_unfit(const nlohmann::json& runs);

/// `point`: of results.json, with "bands" [{observable, unit, band, why, measuring}], where a law's has "exact" too, and "runs". `measuring` is the standard uncertainty
/// that the ruler itself adds, in the observable's unit. A point without the continuum's runs has no judgement: no rows, and
/// inconclusive. `code_spread`: by observable, the relative standard uncertainty u_codes to take where one discrete code alone ran; without it
/// such a row is inconclusive.
TruthJudgement judge_truth(const nlohmann::json& point,
                           const std::map<std::string, double>& code_spread = {});

}  // namespace talus::validation
