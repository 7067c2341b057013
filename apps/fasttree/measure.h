// SPDX-License-Identifier: Apache-2.0
// Rays to measure tracing with, and how fast and at what cost something traces them.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

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

/// The same rays for everything that is compared.
struct MeasuredRays {
  std::array<std::vector<Ray>, kRayKinds.size()> rays;

  const std::vector<Ray>& of(RayKind kind) const { return rays[static_cast<std::size_t>(kind)]; }
};

/// One ray through each pixel's middle, and one shadow and one diffuse ray from each hit. Depends
/// on nothing but its arguments: all tracers find the same hits.
MeasuredRays make_measured_rays(const render::Camera& camera, std::uint32_t width,
                                std::uint32_t height, const MeshView& mesh, const Box3& bounds,
                                const Tracer& tracer);

/// Something that traces. Both functions are called from many threads.
struct RayCaster {
  std::function<void(std::span<const Ray>, std::span<Hit>)> closest;
  std::function<void(std::span<const Ray>, std::span<std::uint8_t>)> occluded;
};

/// Results of one kind, to be compared with those of another tracer.
struct Traced {
  std::vector<Hit> hits;
  std::vector<std::uint8_t> flags;
};

/// Milliseconds for all rays of a kind on the threads of the calling arena.
double time_rays(const RayCaster& caster, RayKind kind, const std::vector<Ray>& rays,
                 Traced& traced);

/// Steps and tests of all rays of a kind.
TraceCounters count_rays(const Tracer& tracer, RayKind kind, const std::vector<Ray>& rays);

}  // namespace fasttree::app
