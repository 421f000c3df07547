#include "analysis/observables/settling.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace talus::analysis {

double settling_time(std::span<const double> time, std::span<const double> curve, double share) {
  const double tolerance = share * std::abs(curve.back() - curve.front());
  const auto distance = [&](std::size_t k) { return std::abs(curve[k] - curve.back()); };
  std::size_t last_outside = curve.size() - 1;
  while (last_outside > 0 && distance(last_outside) <= tolerance) --last_outside;
  if (distance(last_outside) <= tolerance) return time.front();
  const double outside = distance(last_outside);
  const double inside = distance(last_outside + 1);
  const double step = time[last_outside + 1] - time[last_outside];
  return time[last_outside] + step * (outside - tolerance) / (outside - inside);
}

double range_at_end(std::span<const double> time, std::span<const double> curve) {
  constexpr double window = 0.1;  // of the whole time
  const double start = time.back() - window * (time.back() - time.front());
  std::size_t first = time.size() - 1;
  // The window is covered whole: from the last sample that is not after its start.
  while (first > 0 && time[first] > start) --first;
  if (first + 1 == time.size()) return std::numeric_limits<double>::infinity();
  const auto [least, most] = std::ranges::minmax_element(curve.subspan(first));
  return *most - *least;
}

}  // namespace talus::analysis
