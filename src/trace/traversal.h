// SPDX-License-Identifier: Apache-2.0
// How a ray walks the tree without losing a hit. Docs: docs/tracing.md.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "fasttree/trace.h"
#include "fasttree/tree.h"

namespace fasttree {

/// A ray made ready for traversal. Every split plane is taken to be as thick as the error a hit
/// found by intersect_triangle() can have, so a hit is never on a side that is not visited.
///
/// The sheared coordinates of a vertex are off by at most 4 u |v - o| (u = 2^-24) and t by 4 u t,
/// so the hit point lies within about 12 u of the longest distance between the origin and the
/// scene of the true triangle; a plane's t is off by 3 u of itself. 24 u covers both, with room for
/// the clipped boxes of a tree with perfect splits.
class TraversalRay {
 public:
  TraversalRay(const Ray& ray, const Box3& bounds)
      : origin_(ray.origin), direction_(ray.direction) {
    float reach = 0.0f;
    for (std::size_t a = 0; a < 3; ++a) {
      reach = std::max(
          {reach, std::fabs(bounds.hi[a] - origin_[a]), std::fabs(bounds.lo[a] - origin_[a])});
    }
    thickness_ = 24 * 0x1p-24f * reach + 8 * kSmallest;
    for (std::size_t a = 0; a < 3; ++a) {
      reciprocal_[a] = 1.0f / direction_[a];
      slack_[a] = thickness_ * std::fabs(reciprocal_[a]) + 8 * kSmallest;
    }
  }

  /// Parts of the ray's interval on the near and far side of a plane; empty where from > to.
  struct Sides {
    bool lower_is_near = true;
    float near_to = 0.0f;
    float far_from = 0.0f;
  };

  /// The near side is [from, near_to], the far side [far_from, to]. Comparisons and minima are
  /// written so that a value that is not a number leaves an interval as it is.
  Sides split(std::size_t axis, float position, float from, float to) const {
    const float d = direction_[axis];
    const float offset = position - origin_[axis];
    Sides sides;
    sides.lower_is_near = d > 0.0f;
    if (d == 0.0f) {
      // Parallel: one side, or both within the thickness. In the plane, the upper cell first.
      sides.near_to = offset > thickness_ ? -kInfinity : to;
      sides.far_from = offset < -thickness_ ? kInfinity : from;
      return sides;
    }
    const float t = offset * reciprocal_[axis];
    sides.near_to = std::min(to, t + slack_[axis]);
    sides.far_from = std::max(from, t - slack_[axis]);
    return sides;
  }

  /// The part of [from, to] inside the scene's bounds, a thickness wider on all sides. False where
  /// there is none.
  bool clip(const Box3& bounds, float& from, float& to) const {
    for (std::size_t a = 0; a < 3; ++a) {
      const float lower = bounds.lo[a] - origin_[a];
      const float upper = bounds.hi[a] - origin_[a];
      if (direction_[a] == 0.0f) {
        if (lower > thickness_ || upper < -thickness_) return false;
        continue;
      }
      const float t0 = lower * reciprocal_[a];
      const float t1 = upper * reciprocal_[a];
      from = std::max(from, std::min(t0, t1) - slack_[a]);
      to = std::min(to, std::max(t0, t1) + slack_[a]);
    }
    return from <= to;
  }

 private:
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();
  static constexpr float kSmallest = std::numeric_limits<float>::denorm_min();

  Vec3 origin_;
  Vec3 direction_;
  Vec3 reciprocal_;
  Vec3 slack_;
  float thickness_ = 0.0f;
};

/// Walks the leaves a ray may hit something in, front to back. `leaf(node, to)` tests a leaf's
/// triangles, may lower `to` to the nearest hit so far, and returns true to end the walk.
template <typename Leaf>
void traverse(std::span<const Node> nodes, const Box3& bounds, const Ray& ray,
              TraceCounters* counters, Leaf&& leaf) {
  const TraversalRay walker(ray, bounds);
  float from = ray.t_min;
  float nearest = ray.t_max;  // nothing beyond matters
  float to = nearest;
  if (!walker.clip(bounds, from, to)) return;

  struct Postponed {
    std::uint32_t node;
    float from;
    float to;
  };
  std::array<Postponed, kMaxTreeDepth> stack;
  std::size_t depth = 0;
  std::uint32_t index = 0;
  for (;;) {
    const Node node = nodes[index];
    if (!node.is_leaf()) {
      if (counters != nullptr) ++counters->inner_steps;
      const auto sides = walker.split(node.axis(), node.split(), from, to);
      const std::uint32_t lower = index + 1;
      const std::uint32_t near = sides.lower_is_near ? lower : node.upper();
      const std::uint32_t far = sides.lower_is_near ? node.upper() : lower;
      const bool visit_near = !(sides.near_to < from);
      const bool visit_far = !(sides.far_from > to);
      if (visit_near) {
        if (visit_far) stack[depth++] = {far, sides.far_from, to};
        index = near;
        to = sides.near_to;
        continue;
      }
      if (visit_far) {
        index = far;
        from = sides.far_from;
        continue;
      }
    } else {
      if (counters != nullptr) {
        ++counters->leaf_visits;
        counters->triangle_tests += node.count();
      }
      if (leaf(node, nearest)) return;
    }
    // The next postponed side that does not begin beyond the nearest hit.
    do {
      if (depth == 0) return;
      --depth;
    } while (stack[depth].from > nearest);
    index = stack[depth].node;
    from = stack[depth].from;
    to = std::min(stack[depth].to, nearest);
  }
}

}  // namespace fasttree
