#include "continuum/particles/semi_axis.h"

#include <Eigen/Dense>

namespace talus {

bool is_longer(const Eigen::Matrix3d& shape, double longest) {
  const double square = longest * longest;
  if (!(shape.norm() > square) || !shape.allFinite())
    return false;  // the norm is no less than the eigenvalue
  // No eigenvalue exceeds `square` where longest^2 I - S is positive definite, which its minors tell (Sylvester).
  const Eigen::Matrix3d rest = Eigen::Matrix3d::Identity() - shape / square;
  const double one = rest(0, 0), two = rest(0, 0) * rest(1, 1) - rest(0, 1) * rest(1, 0),
               three = rest.determinant();
  constexpr double clear = 1e-9;  // well above round-off, where no minor is large
  if (rest.cwiseAbs().maxCoeff() < 100.0) {
    if (one > clear && two > clear && three > clear) return false;
    if (one < -clear || two < -clear || three < -clear) return true;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(shape, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues()[2] > square;
}

}  // namespace talus
