// Triangle surfaces that tests make, and files of them in each format that is read.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <string_view>
#include <vector>

namespace talus::testing {

using Triangle = std::array<Eigen::Vector3d, 3>;
using Triangles = std::vector<Triangle>;

/// A rows x columns net of cells over point(u, v), u and v in [0, 1], outside on the side of du x dv.
template <class Point>
Triangles net(int rows, int columns, Point point) {
  Triangles triangles;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const double u0 = double(i) / rows, u1 = double(i + 1) / rows;
      const double v0 = double(j) / columns, v1 = j + 1 < columns ? double(j + 1) / columns : 1.0;
      const Eigen::Vector3d a = point(u0, v0), b = point(u1, v0), c = point(u1, v1), d = point(u0, v1);
      triangles.push_back({a, b, c});
      triangles.push_back({a, c, d});
    }
  }
  return triangles;
}

/// sin and cos of a turn, the same to the last bit at 0 and 1, so that nets close.
inline double turn_cos(double turn) { return std::cos(2.0 * std::numbers::pi * (turn < 1.0 ? turn : 0.0)); }
inline double turn_sin(double turn) { return std::sin(2.0 * std::numbers::pi * (turn < 1.0 ? turn : 0.0)); }

/// Inscribed in the sphere. Its net has triangles with two corners in one pole, which bound nothing.
inline Triangles sphere_mesh(const Eigen::Vector3d& centre, double radius, int rows) {
  return net(rows, 2 * rows, [&](double u, double v) -> Eigen::Vector3d {
    const double ring = u > 0.0 && u < 1.0 ? std::sin(std::numbers::pi * u) : 0.0;
    return centre +
           radius * Eigen::Vector3d(ring * turn_cos(v), ring * turn_sin(v), std::cos(std::numbers::pi * u));
  });
}

inline Triangles torus_mesh(double ring_radius, double tube_radius, int rows) {
  return net(rows, rows, [&](double u, double v) {
    const double r = ring_radius + tube_radius * turn_cos(v);
    return Eigen::Vector3d(r * turn_cos(u), r * turn_sin(u), tube_radius * turn_sin(v));
  });
}

inline Triangles box_mesh(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) {
  Triangles triangles;
  for (int axis = 0; axis < 3; ++axis) {
    const int second = (axis + 1) % 3, third = (axis + 2) % 3;
    for (const bool high : {false, true}) {
      const auto corner = [&](bool b, bool c) {
        Eigen::Vector3d at = high ? upper : lower;
        at[second] = b ? upper[second] : lower[second];
        at[third] = c ? upper[third] : lower[third];
        return at;
      };
      const auto a = corner(false, false), b = corner(true, false), c = corner(true, true),
                 d = corner(false, true);
      if (high) {
        triangles.push_back({a, b, c});
        triangles.push_back({a, c, d});
      } else {
        triangles.push_back({a, c, b});
        triangles.push_back({a, d, c});
      }
    }
  }
  return triangles;
}

inline Triangles flipped(Triangles triangles) {
  for (Triangle& triangle : triangles) std::swap(triangle[1], triangle[2]);
  return triangles;
}

inline Triangles together(Triangles a, const Triangles& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

inline void write_text_stl(const std::filesystem::path& file, const Triangles& triangles) {
  std::ofstream out(file);
  out.precision(std::numeric_limits<double>::max_digits10);
  out << "solid test\n";
  for (const Triangle& triangle : triangles) {
    out << "facet normal 0 0 0\n outer loop\n";
    for (const auto& corner : triangle) out << "  vertex " << corner.transpose() << '\n';
    out << " endloop\nendfacet\n";
  }
  out << "endsolid test\n";
}

inline void write_binary_stl(const std::filesystem::path& file, const Triangles& triangles) {
  std::ofstream out(file, std::ios::binary);
  const auto put = [&](const auto& value) { out.write(reinterpret_cast<const char*>(&value), sizeof value); };
  put(std::array<char, 80>{});
  put(static_cast<std::uint32_t>(triangles.size()));
  for (const Triangle& triangle : triangles) {
    const Eigen::Vector3f normal =
        (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalized().cast<float>();
    for (const float value : normal) put(value);
    for (const auto& corner : triangle) {
      for (const double value : corner) put(static_cast<float>(value));
    }
    put(std::uint16_t{0});
  }
}

inline void write_obj(const std::filesystem::path& file, const Triangles& triangles) {
  std::ofstream out(file);
  out.precision(std::numeric_limits<double>::max_digits10);
  for (const Triangle& triangle : triangles) {
    for (const auto& corner : triangle) out << "v " << corner.transpose() << '\n';
  }
  for (std::size_t i = 0; i < triangles.size(); ++i)
    out << "f " << 3 * i + 1 << ' ' << 3 * i + 2 << ' ' << 3 * i + 3 << '\n';
}

}  // namespace talus::testing
