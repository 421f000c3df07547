// How far apart two depth profiles are: the area between them.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

namespace talus::validation {

/// Depth (m) at the places x (m), which increase.
struct Profile {
  std::vector<double> x, depth;
};

/// Of a run in results.json; empty when it has none.
Profile profile_of(const nlohmann::json& run);

/// Depth at x, linear between places; 0 beyond its ends.
double depth_at(const Profile& profile, double x);

/// The mean of several, at the places of all of them. Empty ones do not count.
Profile mean_profile(const std::vector<Profile>& profiles);

/// Area below, and area between two, m^2 (along the profile's own coordinate), by trapezia over the places of both.
double area(const Profile& profile);
double area_between(const Profile& a, const Profile& b);

}  // namespace talus::validation
