// SPDX-License-Identifier: Apache-2.0
// Points, directions and boxes in binary32, as small as they can be.
#pragma once

#include <cstddef>
#include <limits>

namespace fasttree {

/// A point or a direction, three binary32 components.
struct Vec3 {
  float x = 0.0f;
  float y = 0.0f;
  float z = 0.0f;

  float operator[](std::size_t axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  float& operator[](std::size_t axis) { return axis == 0 ? x : axis == 1 ? y : z; }

  friend bool operator==(const Vec3&, const Vec3&) = default;
};

inline Vec3 operator+(Vec3 a, Vec3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3 operator-(Vec3 a, Vec3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3 operator*(Vec3 a, float s) {
  return {a.x * s, a.y * s, a.z * s};
}
inline float dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// An axis-aligned box, closed on both sides. Default: empty (lo > hi).
struct Box3 {
  Vec3 lo{std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
          std::numeric_limits<float>::infinity()};
  Vec3 hi{-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
          -std::numeric_limits<float>::infinity()};

  bool empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }
  Vec3 extent() const { return hi - lo; }

  /// Grows to include a point.
  void include(Vec3 p) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (p[a] < lo[a]) lo[a] = p[a];
      if (p[a] > hi[a]) hi[a] = p[a];
    }
  }

  friend bool operator==(const Box3&, const Box3&) = default;
};

}  // namespace fasttree
