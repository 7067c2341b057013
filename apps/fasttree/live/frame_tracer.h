// SPDX-License-Identifier: Apache-2.0
// One frame's rays, in packets, and the picture they give: quick rather than pretty.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fasttree/mesh.h"
#include "fasttree/trace.h"
#include "live/tile_order.h"
#include "render/camera.h"
#include "render/image.h"

namespace fasttree::live {

/// From where and in which light a frame is seen.
struct Shot {
  render::Camera camera;
  Vec3 light;
  bool shadows = true;
};

/// A lamp that stays where it is while the scene and the camera move: above the first camera and
/// to its right, and nearer where something is in between, as a ceiling is.
Vec3 place_light(const render::Camera& camera, const Tracer& tracer);

/// What the rays of a frame took. Times include making the rays.
struct TraceFigures {
  double primary_ms = 0;
  double shadow_ms = 0;
  std::uint64_t primary_rays = 0;
  std::uint64_t shadow_rays = 0;
  std::uint64_t hits = 0;  ///< of the primary rays
  std::uint64_t lit = 0;   ///< shadow rays that reached the light
  double trace_ms() const { return primary_ms + shadow_ms; }
};

/// Traces frames of one size, keeping its memory. Works on the threads of the calling task arena.
class FrameTracer {
 public:
  FrameTracer(std::uint32_t width, std::uint32_t height);

  /// Bytes that a tracer of this size holds, with a picture.
  static std::uint64_t bytes(std::uint32_t width, std::uint32_t height);

  /// Primary rays, then a shadow ray for each hit that faces the light.
  TraceFigures trace(const Tracer& tracer, const MeshView& mesh, const Shot& shot);

  /// The picture of the last trace(); `image` gets the right size.
  void shade(render::Image& image) const;

 private:
  struct Surface {
    Vec3 point;           ///< a little above the surface
    float headlight = 0;  ///< cosine between normal and viewer
    float lamp = -1;      ///< between normal and light; shadow rays are for those above 0
  };
  struct TileCount {
    std::uint32_t hits = 0;
    std::uint32_t shadow_rays = 0;
    std::size_t first_shadow = 0;  ///< place in the batch of shadow rays
  };

  void find_surfaces(const MeshView& mesh, const Shot& shot);

  TileOrder order_;
  std::vector<Ray> rays_;
  std::vector<Hit> hits_;
  std::vector<Surface> surfaces_;
  std::vector<TileCount> tiles_;
  std::vector<Ray> shadow_rays_;
  std::vector<std::uint8_t> occluded_;
  std::vector<std::array<std::uint8_t, 3>> shades_;      ///< by brightness
  std::vector<std::array<std::uint8_t, 3>> background_;  ///< by row
  bool shadows_ = true;
};

}  // namespace fasttree::live
