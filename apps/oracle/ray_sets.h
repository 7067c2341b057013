// SPDX-License-Identifier: Apache-2.0
// Rays to test a tracer with: what a renderer sends, and what breaks tracers.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "fasttree/mesh.h"
#include "fasttree/trace.h"
#include "fasttree/tree.h"

namespace fasttree::oracle {

/// Kinds of rays. From `planes` on they are adversarial: made to meet the tree's planes, the mesh's
/// edges and vertices, and the ends of the ray's own interval exactly.
enum class RaySet : std::uint8_t {
  outside,   ///< a pinhole camera outside the bounds
  inside,    ///< from points inside the bounds, in all directions
  shadow,    ///< from points on triangles to a light, t in (0, 1)
  random,    ///< lines between random points round the bounds
  planes,    ///< inside a split plane: origin on it, direction 0 across it
  edges,     ///< along the edges of triangles
  vertices,  ///< through vertices, some of them ending exactly there
  corners,   ///< through points where three split planes meet
  axes,      ///< parallel to an axis, through vertices and split planes, zeros of both signs
  origins,   ///< starting exactly on split planes and vertices
  segments,  ///< short intervals of t, some of a single point
};

inline constexpr std::array kAllRaySets = {RaySet::outside,  RaySet::inside,  RaySet::shadow,
                                           RaySet::random,   RaySet::planes,  RaySet::edges,
                                           RaySet::vertices, RaySet::corners, RaySet::axes,
                                           RaySet::origins,  RaySet::segments};

const char* to_string(RaySet set);

/// Makes the rays of a set. Ray i depends on seed, set and i alone, so that any part of a set can
/// be made on any thread.
class RayGenerator {
 public:
  /// Holds a view of the mesh; copies what it needs of the tree. The tree has passed verify().
  RayGenerator(const MeshView& mesh, const Tree& tree, std::uint64_t seed);

  /// Rays first, first + 1, ... of the set.
  void generate(RaySet set, std::uint64_t first, std::span<Ray> rays) const;

 private:
  class Random;
  Ray make(RaySet set, Random& random) const;
  Vec3 point_inside(Random& random) const;
  Vec3 point_around(Random& random) const;
  Vec3 point_on_triangle(Random& random) const;
  Vec3 vertex(Random& random) const;
  Vec3 corner(Random& random) const;
  float split(Random& random, std::size_t axis) const;

  MeshView mesh_;
  std::uint64_t seed_;
  Vec3 centre_;
  Vec3 half_;                                 ///< half the bounds' extent, nowhere zero
  float radius_;                              ///< of a sphere round the bounds
  std::array<std::vector<float>, 3> splits_;  ///< distinct splits an axis; at least one
};

}  // namespace fasttree::oracle
