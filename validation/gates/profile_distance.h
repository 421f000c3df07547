// How far apart two curves are, depth profiles or depths in time: the area between them.
#pragma once

#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

namespace talus::validation {

/// Whether an observable is such an area, "profile_L1" or "depth_curve_L1", and so has a deviation and no value.
inline bool is_distance(std::string_view observable) { return observable.ends_with("_L1"); }

/// Depth (m) at the places x (m; s of a curve in time), which increase.
struct Profile {
  std::vector<double> x, depth;
};

/// What an observable that is a distance compares, of a run in results.json: its final profile, or its curve of depth in time. Empty
/// when it has none.
Profile profile_of(const nlohmann::json& run, std::string_view observable);

/// Depth at x, linear between places; 0 beyond its ends.
double depth_at(const Profile& profile, double x);

/// The mean of several, at the places of all of them. Empty ones do not count.
Profile mean_profile(const std::vector<Profile>& profiles);

/// Area below, and area between two, m^2 (along the profile's own coordinate), by trapezia over the places of both.
double area(const Profile& profile);
double area_between(const Profile& a, const Profile& b);

}  // namespace talus::validation
