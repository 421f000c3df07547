// Bodies as they are drawn: a mesh each, and where it was at which time. A run folder may hold
//   bodies.csv          a row for each body and moment: time_s, body, x_m, y_m, z_m, qw, qx, qy, qz
//   bodies/NAME.stl     one for each name in it, about the body's centre of mass and along its own axes, m
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "continuum/grid/grid.h"

namespace talus {

struct Triangles {
  std::vector<Eigen::Vector3f> corners;        // m
  std::vector<std::array<unsigned, 3>> faces;  // by number of corner
};

/// Throws InputError when the file cannot be read or holds no triangle.
Triangles read_triangles(const std::filesystem::path& file);

struct DrawnBody {
  struct Moment {
    double time;                  // s
    Eigen::Isometry3d placement;  // of the body's own axes in space
  };
  std::string name;
  Triangles surface;
  std::vector<Moment> moments;  // by time
};

/// In the order of their names; none where there is no bodies.csv. Throws InputError naming the file, the row, and what is
/// wrong with it: columns, numbers, quaternions that are not of unit length, times of a body that go back.
std::vector<DrawnBody> read_bodies(const std::filesystem::path& run_folder);

/// Where a body is at a time: as its latest row by then says. Throws InputError when there is none yet.
const Eigen::Isometry3d& placement_at(const DrawnBody& body, double time);
/// There, and where its images over periodic seams are; those that the domain sees.
std::vector<Eigen::Isometry3d> images_at(const DrawnBody& body, double time, const Grid& grid);

}  // namespace talus
