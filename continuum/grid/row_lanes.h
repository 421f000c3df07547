// Values side by side, as many as the processor takes at once (std::experimental::simd), for loops along rows that the
// compiler does not vectorise by itself. Rows are padded to whole numbers of lanes (row_layout.h).
#pragma once

#include <experimental/simd>

namespace talus {

template <class Real>
using RowLanes = std::experimental::native_simd<Real>;

template <class Real>
[[gnu::always_inline]] inline RowLanes<Real> load(const Real* from) {
  return RowLanes<Real>(from, std::experimental::element_aligned);
}
template <class Real>
[[gnu::always_inline]] inline void store(const RowLanes<Real>& values, Real* to) {
  values.copy_to(to, std::experimental::element_aligned);
}
/// `yes` where `which` holds, else `no`.
template <class Mask, class Real>
[[gnu::always_inline]] inline RowLanes<Real> either(const Mask& which, const RowLanes<Real>& yes,
                                                    const RowLanes<Real>& no) {
  RowLanes<Real> chosen = no;
  where(which, chosen) = yes;
  return chosen;
}

}  // namespace talus
