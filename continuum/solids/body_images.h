// Bodies and periodic seams. A body's pose runs on over a seam: what the domain sees of the body are its images, whole periods away.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <vector>

#include "continuum/grid/grid.h"
#include "continuum/solids/body.h"

namespace talus {

/// `point`, moved by whole periods to where it is nearest to `to`; m. Unchanged along axes that are not periodic.
Eigen::Vector3d nearest_image(const Grid& grid, const Eigen::Vector3d& point, const Eigen::Vector3d& to);

/// The middle of each body's bounds, m: the image of a point that is nearest to it is the one that is in or on the body, as long as
/// that is no longer than a period.
std::vector<Eigen::Vector3d> middles(std::span<const Body> bodies);

/// The moves by whole periods, m, that let `box` meet `place`; no move at all is one of them where they meet as they are. Throws
/// NumericalError where they are more than can be told or wanted: no body that was sound gets there.
std::vector<Eigen::Vector3d> meeting_shifts(const Grid& grid, const Eigen::AlignedBox3d& box,
                                            const Eigen::AlignedBox3d& place);
/// Those that let it meet the domain, which for this has no ends along axes that are not periodic: there is always one.
std::vector<Eigen::Vector3d> shifts_into_domain(const Grid& grid, const Eigen::AlignedBox3d& box);

Body shifted(Body body, const Eigen::Vector3d& shift);

}  // namespace talus
