// SPDX-License-Identifier: Apache-2.0
// The scenes that need no file: "scene:NAME[:TRIANGLES[:FRAME]]". TRIANGLES is met as nearly as the
// shape allows and is never under the shape's coarsest form (the hall's has about 25,000); it may
// end in k or M. FRAME counts from 0 and wraps around.
//
// The same name gives the same mesh on every machine and for every number of threads, as far as
// sine and cosine of the C library agree: they are taken in binary64 and rounded once to binary32,
// so a difference in their last bit hardly ever shows.
#pragma once

#include <cstdint>
#include <span>

namespace fasttree::scene {

/// What a procedural scene is, for lists and help texts.
struct ProceduralInfo {
  const char* name;                 ///< as in "scene:NAME"
  const char* description;          ///< one line
  std::uint32_t default_triangles;  ///< about as many where the specification gives no size
  std::uint32_t frames;             ///< of the animation's loop; 1: it does not move
  bool interior;                    ///< best seen from inside (View::inside)
};

/// All procedural scenes, in the order they are to be listed.
std::span<const ProceduralInfo> procedural_scenes();

/// Largest number of triangles that can be asked for.
inline constexpr std::uint64_t kMaxProceduralTriangles = 100'000'000;

}  // namespace fasttree::scene
