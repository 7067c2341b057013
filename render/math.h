// SPDX-License-Identifier: Apache-2.0
// Shading is computed in binary64, so that scenes of any size and place look the same; rays are
// rounded to binary32 last.
#pragma once

#include <cmath>

#include "fasttree/vec.h"

namespace fasttree::render {

struct Double3 {
  double x = 0;
  double y = 0;
  double z = 0;

  Double3() = default;
  Double3(double x_, double y_, double z_) : x(x_), y(y_), z(z_) {}
  explicit Double3(Vec3 v) : x(v.x), y(v.y), z(v.z) {}

  Double3& operator+=(Double3 b) { return *this = {x + b.x, y + b.y, z + b.z}; }
};

inline Double3 operator+(Double3 a, Double3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Double3 operator-(Double3 a, Double3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Double3 operator*(Double3 a, double s) {
  return {a.x * s, a.y * s, a.z * s};
}
inline Double3 operator*(Double3 a, Double3 b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
inline double dot(Double3 a, Double3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Double3 cross(Double3 a, Double3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Double3 a) {
  return std::sqrt(dot(a, a));
}
inline Double3 lerp(Double3 a, Double3 b, double s) {
  return a * (1 - s) + b * s;
}
inline double max_component(Double3 a) {
  return std::fmax(std::fabs(a.x), std::fmax(std::fabs(a.y), std::fabs(a.z)));
}

/// Length 1; the zero vector stays what it is. Scaled first, so that nothing under- or overflows.
inline Double3 normalized(Double3 a) {
  const double scale = max_component(a);
  if (!(scale > 0)) return {};
  a = a * (1 / scale);
  return a * (1 / length(a));
}

inline Vec3 to_float(Double3 a) {
  return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}

inline bool finite(Vec3 a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// Some orthonormal basis with `normal` (of length 1) as its third vector.
struct Basis {
  Double3 tangent, bitangent, normal;

  explicit Basis(Double3 n) : normal(n) {
    const Double3 helper = std::fabs(n.x) < 0.6 ? Double3(1, 0, 0) : Double3(0, 1, 0);
    tangent = normalized(cross(helper, n));
    bitangent = cross(n, tangent);
  }

  Double3 operator()(double x, double y, double z) const {
    return tangent * x + bitangent * y + normal * z;
  }
};

}  // namespace fasttree::render
