#include "validation/gates/profile_distance.h"

#include <algorithm>
#include <cmath>

namespace talus::validation {
namespace {

std::vector<double> places_of(const std::vector<Profile>& profiles) {
  std::vector<double> places;
  for (const auto& profile : profiles) places.insert(places.end(), profile.x.begin(), profile.x.end());
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  return places;
}

}  // namespace

Profile profile_of(const nlohmann::json& run, std::string_view observable) {
  const bool in_time = observable == "depth_curve_L1";
  const auto found = run.find(in_time ? "curves" : "final_profile");
  if (found == run.end() || !found->is_object()) return {};
  return {found->at(in_time ? "time" : "x").get<std::vector<double>>(),
          found->at("depth").get<std::vector<double>>()};
}

double depth_at(const Profile& profile, double x) {
  const auto& xs = profile.x;
  if (xs.empty() || x < xs.front() || x > xs.back()) return 0.0;
  const auto after = std::upper_bound(xs.begin(), xs.end(), x);
  if (after == xs.end()) return profile.depth.back();
  const auto i = static_cast<std::size_t>(after - xs.begin());
  const double share = (x - xs[i - 1]) / (xs[i] - xs[i - 1]);
  return (1.0 - share) * profile.depth[i - 1] + share * profile.depth[i];
}

Profile mean_profile(const std::vector<Profile>& profiles) {
  Profile mean{places_of(profiles), {}};
  const auto count = std::ranges::count_if(profiles, [](const Profile& p) { return !p.x.empty(); });
  for (const double x : mean.x) {
    double sum = 0.0;
    for (const auto& profile : profiles) sum += depth_at(profile, x);
    mean.depth.push_back(sum / static_cast<double>(count));
  }
  return mean;
}

double area(const Profile& profile) { return area_between(profile, {}); }

double area_between(const Profile& a, const Profile& b) {
  const auto places = places_of({a, b});
  const auto gap = [&](double x) { return std::abs(depth_at(a, x) - depth_at(b, x)); };
  double sum = 0.0;
  for (std::size_t i = 1; i < places.size(); ++i)
    sum += 0.5 * (places[i] - places[i - 1]) * (gap(places[i - 1]) + gap(places[i]));
  return sum;
}

}  // namespace talus::validation
