// SPDX-License-Identifier: Apache-2.0
// Rays through a tree: closest hit and any hit, watertight, equal to brute force bit for bit.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "fasttree/mesh.h"
#include "fasttree/status.h"
#include "fasttree/tree.h"
#include "fasttree/vec.h"

namespace fasttree {

/// Hits are accepted for t_min <= t <= t_max; the point is origin + t * direction. The direction
/// need not have length 1. A ray whose origin or direction is not finite, or whose direction is
/// zero (or so small that its reciprocal overflows), hits nothing.
struct Ray {
  Vec3 origin;
  float t_min = 0.0f;
  Vec3 direction;
  float t_max = std::numeric_limits<float>::infinity();
};

inline constexpr std::uint32_t kNoTriangle = 0xffffffffu;

/// The nearest hit; at equal t the lowest triangle id. u and v weigh the triangle's second and
/// third vertex.
struct Hit {
  float t = std::numeric_limits<float>::infinity();
  std::uint32_t triangle = kNoTriangle;
  float u = 0.0f;
  float v = 0.0f;

  bool hit() const { return triangle != kNoTriangle; }
  friend bool operator==(const Hit&, const Hit&) = default;
};

/// What tracing cost, for quality figures and heat maps.
struct TraceCounters {
  std::uint64_t inner_steps = 0;
  std::uint64_t leaf_visits = 0;
  std::uint64_t triangle_tests = 0;
};

/// Traces rays through one tree over one mesh. Holds views: tree and mesh have to outlive it.
/// Thread-safe.
class Tracer {
 public:
  /// invalid_argument where the tree was not made for a mesh of this many triangles. A tree from
  /// an untrusted file has to pass verify() first.
  static Result<Tracer> create(const Tree& tree, const MeshView& mesh);

  Hit closest(const Ray& ray) const;
  Hit closest(const Ray& ray, TraceCounters& counters) const;

  /// Whether anything is hit between t_min and t_max.
  bool occluded(const Ray& ray) const;
  bool occluded(const Ray& ray, TraceCounters& counters) const;

  /// Many rays, on the threads of the calling task arena. Spans of equal length.
  void closest(std::span<const Ray> rays, std::span<Hit> hits) const;
  void occluded(std::span<const Ray> rays, std::span<std::uint8_t> flags) const;

 private:
  Tracer(const Tree& tree, const MeshView& mesh);

  std::span<const Node> nodes_;
  std::span<const std::uint32_t> ids_;
  Box3 bounds_;
  MeshView mesh_;
};

/// Every triangle tested with the same routine: the judge of every tracer.
Hit brute_force_closest(const MeshView& mesh, const Ray& ray);
bool brute_force_occluded(const MeshView& mesh, const Ray& ray);

/// The same for many rays: the same answers to the bit, about ten times as fast. Copies the
/// triangles (36 bytes each) into an order that vector instructions like. Thread-safe.
class BruteForce {
 public:
  explicit BruteForce(const MeshView& mesh);

  Hit closest(const Ray& ray) const;
  bool occluded(const Ray& ray) const;

 private:
  MeshView mesh_;
  std::size_t stride_ = 0;          ///< triangles, rounded up to whole vectors
  std::vector<float> coordinates_;  ///< [corner][axis][triangle]
};

}  // namespace fasttree
