// Inlets: flat outlines through which sand enters in layers, each one lattice spacing behind the last, at a given velocity
// and at its packing limit or below.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "continuum/grid/grid.h"
#include "continuum/materials/material.h"
#include "continuum/particles/particles.h"

namespace talus {

struct Source {
  int material;
  Eigen::Vector3d lower, upper;  // m; equal along one axis, the inlet's normal
  bool round;                    // the ellipse inscribed in the rectangle
  Eigen::Vector3d velocity;      // m/s; not zero along the normal
  double fill;                   // of the sand that enters, (0, 1]
  double start, end;             // s
  double spacing;                // of particles, m
  long layers = 0;               // that have entered

  int normal() const;
  /// When the next layer has passed the inlet, s; infinite when that layer's middle would pass it after the end. A layer
  /// enters whole, so that one at an inlet on the domain's side lies inside the domain with all its sand.
  double next_layer_time() const;
};

struct EmissionReport {
  Eigen::Index count = 0;
  double mass = 0.0;  // kg
};

/// Adds the layers that have passed the inlets by `time`, each where it has got to since.
EmissionReport emit(std::span<const Material> materials, double time, std::vector<Source>& sources,
                    Particles& particles);

}  // namespace talus
