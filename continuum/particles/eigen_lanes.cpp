#include "continuum/particles/eigen_lanes.h"

namespace talus {
namespace {

constexpr int most_sweeps = 8;       // convergence is quadratic: 3 or 4 are the rule
constexpr double round_off = 1e-14;  // of entries off the diagonal; what is left of them acts squared

/// Where the entry off the diagonal of two rows is stored.
constexpr std::size_t entry_of(std::size_t p, std::size_t q) { return 6 - p - q; }

/// Makes the entry of rows p and q zero. Without comparisons, which Eigen does one lane at a time.
template <std::size_t p, std::size_t q>
void rotate(SymmetricLanes& a, EigenLanes& eigen) {
  constexpr std::size_t r = 3 - p - q;
  constexpr double tiny = 1e-290, huge = 1e300;
  const Lanes off = a[entry_of(p, q)], half_gap = 0.5 * (a[q] - a[p]);
  const Lanes sign = ((half_gap + tiny) * huge).max(-1.0).min(1.0);
  // The tangent of the smaller of the two angles that do it.
  const Lanes tangent = sign * off / (half_gap.abs() + (half_gap.square() + off.square()).sqrt() + tiny);
  const Lanes cosine = 1.0 / (1.0 + tangent.square()).sqrt(), sine = tangent * cosine;
  a[p] -= tangent * off;
  a[q] += tangent * off;
  a[entry_of(p, q)] = Lanes::Zero();
  const Lanes rp = a[entry_of(r, p)], rq = a[entry_of(r, q)];
  a[entry_of(r, p)] = cosine * rp - sine * rq;
  a[entry_of(r, q)] = sine * rp + cosine * rq;
  for (std::size_t k = 0; k < 3; ++k) {
    const Lanes vp = eigen.vectors[p][k], vq = eigen.vectors[q][k];
    eigen.vectors[p][k] = cosine * vp - sine * vq;
    eigen.vectors[q][k] = sine * vp + cosine * vq;
  }
}

}  // namespace

EigenLanes eigen_of(const SymmetricLanes& matrix) {
  SymmetricLanes a = matrix;
  EigenLanes eigen;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < 3; ++i) eigen.vectors[k][i] = Lanes::Constant(k == i ? 1.0 : 0.0);
  }
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    if (!((a[3].abs() + a[4].abs() + a[5].abs()).maxCoeff() > round_off)) break;
    rotate<0, 1>(a, eigen);
    rotate<0, 2>(a, eigen);
    rotate<1, 2>(a, eigen);
  }
  eigen.values = {a[0], a[1], a[2]};
  return eigen;
}

SymmetricLanes matrix_of(const EigenLanes& eigen) {
  const auto entry = [&](std::size_t i, std::size_t j) -> Lanes {
    Lanes sum = Lanes::Zero();
    for (std::size_t k = 0; k < 3; ++k) sum += eigen.values[k] * eigen.vectors[k][i] * eigen.vectors[k][j];
    return sum;
  };
  return {entry(0, 0), entry(1, 1), entry(2, 2), entry(1, 2), entry(2, 0), entry(0, 1)};
}

}  // namespace talus
