// SPDX-License-Identifier: Apache-2.0
// Rays to measure tracing with, and what they cost in steps and tests.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "build/buffer.h"
#include "fasttree/mesh.h"
#include "fasttree/trace.h"
#include "render/camera.h"

namespace fasttree::app {

/// Kinds of rays that rendering consists of.
enum class RayKind : std::uint8_t {
  primary,  ///< closest hit, from the camera
  shadow,   ///< any hit, from what the camera sees to a point light
  diffuse,  ///< closest hit, from what the camera sees in cosine-distributed directions
};
inline constexpr std::array kRayKinds = {RayKind::primary, RayKind::shadow, RayKind::diffuse};
const char* to_string(RayKind kind);

/// In huge pages where the system has them, as all that contenders are measured on.
template <typename T>
using Measured = build::Buffer<T>;

/// The same rays for everything that is compared.
struct MeasuredRays {
  std::array<Measured<Ray>, kRayKinds.size()> rays;
  Vec3 light;  ///< where the shadow rays end

  std::span<const Ray> of(RayKind kind) const { return rays[static_cast<std::size_t>(kind)]; }
};

/// Where the rays come from.
struct RaySettings {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::optional<Vec3> light;  ///< none: beside the camera, above and to the right
};

/// One ray through each pixel's middle, and one shadow and one diffuse ray from each hit. The
/// pixels come in tiles of 8 x 8, so that 64 neighbours in the array are neighbours in the picture;
/// where the picture ends within a tile, the tile is smaller. The other rays follow the order of
/// the hits. Depends on nothing but its arguments: all tracers find the same hits.
MeasuredRays make_measured_rays(const render::Camera& camera, const RaySettings& settings,
                                const MeshView& mesh, const Box3& bounds, const Tracer& tracer);

/// Steps and tests of all rays of a kind.
TraceCounters count_rays(const Tracer& tracer, RayKind kind, std::span<const Ray> rays);

}  // namespace fasttree::app
