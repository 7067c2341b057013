// SPDX-License-Identifier: Apache-2.0
// The one ray-triangle test every tracer and the brute force share: Woop, Benthin and Wald 2013,
// "Watertight Ray/Triangle Intersection", with the edge functions in binary64.
//
// Why binary64: the sheared coordinates are binary32, so their products are exact and an edge
// function has the right sign always, zero included. That makes the test watertight without a
// special case for zero, and it keeps the hit point within a few ulps of the triangle even where
// the ray sees it edge-on. The tracer's slack (docs/tracing.md) rests on the latter.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "fasttree/trace.h"
#include "fasttree/vec.h"

namespace fasttree {

/// A ray made ready for the test: the dominant axis becomes z, and a shear makes the ray the z
/// axis.
struct ShearedRay {
  Vec3 origin;
  std::uint32_t kx = 0, ky = 1, kz = 2;
  float sx = 0, sy = 0, sz = 0;
  bool valid = false;  ///< false: the ray hits nothing (see Ray)
};

inline ShearedRay shear(const Ray& ray) {
  ShearedRay s;
  s.origin = ray.origin;
  const Vec3 d = ray.direction;
  const float ax = std::fabs(d.x), ay = std::fabs(d.y), az = std::fabs(d.z);
  s.kz = az >= ax && az >= ay ? 2 : ay >= ax ? 1 : 0;
  s.kx = (s.kz + 1) % 3;
  s.ky = (s.kz + 2) % 3;
  if (d[s.kz] < 0.0f) std::swap(s.kx, s.ky);  // keeps the winding
  s.sx = d[s.kx] / d[s.kz];
  s.sy = d[s.ky] / d[s.kz];
  s.sz = 1.0f / d[s.kz];
  s.valid = std::isfinite(s.sz) && std::isfinite(ax) && std::isfinite(ay) && std::isfinite(az) &&
            std::isfinite(ray.origin.x) && std::isfinite(ray.origin.y) &&
            std::isfinite(ray.origin.z);
  return s;
}

/// Tests one triangle whose corners are given relative to the ray's origin, with the ray's axes
/// (kx, ky, kz) in the places of x, y and z. Else as intersect_triangle().
inline bool intersect_moved(const ShearedRay& s, float t_min, float t_max, Vec3 a, Vec3 b, Vec3 c,
                            float& t, float& u, float& v) {
  const double ax = a.x - s.sx * a.z, ay = a.y - s.sy * a.z;
  const double bx = b.x - s.sx * b.z, by = b.y - s.sy * b.z;
  const double cx = c.x - s.sx * c.z, cy = c.y - s.sy * c.z;
  const double edge_u = cx * by - cy * bx;
  const double edge_v = ax * cy - ay * cx;
  const double edge_w = bx * ay - by * ax;
  if ((edge_u < 0 || edge_v < 0 || edge_w < 0) && (edge_u > 0 || edge_v > 0 || edge_w > 0)) {
    return false;
  }
  const double det = edge_u + edge_v + edge_w;
  if (det == 0) return false;
  const double depth = edge_u * (s.sz * a.z) + edge_v * (s.sz * b.z) + edge_w * (s.sz * c.z);
  const float hit_t = static_cast<float>(depth / det);
  if (!(hit_t >= t_min && hit_t <= t_max) || !std::isfinite(hit_t)) return false;
  t = hit_t;
  u = static_cast<float>(edge_v / det);
  v = static_cast<float>(edge_w / det);
  return true;
}

/// Tests one triangle. Where it is hit with t_min <= t <= t_max, sets t, u and v (weights of the
/// second and third vertex) and returns true. Two-sided; triangles of zero area are never hit.
inline bool intersect_triangle(const ShearedRay& s, float t_min, float t_max,
                               const std::array<Vec3, 3>& triangle, float& t, float& u, float& v) {
  const auto moved = [&](const Vec3& p) {
    const Vec3 q = p - s.origin;
    return Vec3{q[s.kx], q[s.ky], q[s.kz]};
  };
  return intersect_moved(s, t_min, t_max, moved(triangle[0]), moved(triangle[1]),
                         moved(triangle[2]), t, u, v);
}

}  // namespace fasttree
