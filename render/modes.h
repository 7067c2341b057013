// SPDX-License-Identifier: Apache-2.0
// One function a kind of picture; render() has checked the settings.
#pragma once

#include "fasttree/mesh.h"
#include "fasttree/trace.h"
#include "fasttree/tree.h"
#include "render/image.h"
#include "render/passes.h"
#include "render/render.h"

namespace fasttree::render {

struct Scene {
  const Tree& tree;
  const Tracer& tracer;
  const MeshView& mesh;
};

/// How many tiles a picture passes through, for the progress.
std::uint64_t shaded_work(const RenderSettings& settings);
std::uint64_t heat_work(const RenderSettings& settings);
std::uint64_t leaves_work(const RenderSettings& settings);

/// Bytes a picture holds at once, beside itself.
std::uint64_t shaded_bytes(const Scene& scene, const RenderSettings& settings);
std::uint64_t heat_bytes(const RenderSettings& settings);
std::uint64_t leaves_bytes(const RenderSettings& settings);

/// Each draws into an image of the right size. False: cancelled.
bool draw_shaded(const Scene& scene, const RenderSettings& settings, Work& work, Image& image,
                 RenderStats& stats);
bool draw_heat(const Scene& scene, const RenderSettings& settings, Work& work, Image& image,
               RenderStats& stats);
bool draw_leaves(const Scene& scene, const RenderSettings& settings, Work& work, Image& image,
                 RenderStats& stats);

}  // namespace fasttree::render
