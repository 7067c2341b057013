// SPDX-License-Identifier: Apache-2.0
#include "report/frame_split.h"

#include <algorithm>
#include <filesystem>

#include "inputs.h"
#include "live/frame_tracer.h"
#include "live/rebuild.h"
#include "progress.h"
#include "render/render.h"
#include "views.h"

namespace fasttree::app {
namespace {

constexpr std::uint32_t kOcclusionSamples = 4;

/// Known scenes that are looked at from inside.
bool is_room(const std::string& source) {
  const auto rooms = {"sibenik", "conference", "sponza"};
  return std::find(rooms.begin(), rooms.end(), std::filesystem::path(source).stem().string()) !=
         rooms.end();
}

live::Shot shot_of(const ExploredScene& scene, const live::Rebuild& built) {
  live::Shot shot;
  shot.camera =
      CameraOptions{}.choose(scene.name, built.tree().info().bounds, built.tracer(),
                             is_room(scene.name) ? render::View::inside : render::View::corner);
  shot.light = live::place_light(shot.camera, built.tracer());
  return shot;
}

void draw(Context& context, const ExploredScene& scene, const live::Rebuild& built,
          const render::Camera& camera, const FrameSplitSettings& settings, FrameSplit& split) {
  render::RenderSettings render;
  render.width = split.picture_width = settings.picture_width;
  render.height = split.picture_height = settings.picture_height;
  render.camera = camera;
  render.samples = settings.samples;
  render.ao_samples = kOcclusionSamples;
  render.memory_limit_bytes = settings.memory_bytes;
  render.progress = context.progress.callback("drawing " + scene.scene.mesh.name);
  split.png = take(render::encode_png(
      take(render::render(built.tree(), built.tracer(), scene.scene.view, render))));
}

}  // namespace

FrameSplit split_frame(Context& context, const ExploredScene& scene,
                       const FrameSplitSettings& settings) {
  FrameSplit split;
  const MeshView& mesh = scene.scene.view;
  const ProgressCallback say = context.progress.callback("measuring " + scene.scene.mesh.name);
  live::FrameTracer tracer(settings.width, settings.height);
  live::Shot shot;
  for (const Profile profile : {Profile::paper, Profile::realtime}) {
    BuildSettings build;
    build.profile = profile;
    build.memory_limit_bytes = settings.memory_bytes;
    // Cancels, and draws nothing: the bar would be part of what is measured.
    build.progress = [](const char*, double) { return !cancelled(); };
    live::Rebuild built;
    std::vector<double> tree, layout, trace;
    for (std::uint32_t i = 0; i <= settings.repeat; ++i) {
      say(to_string(profile), static_cast<double>(i) / (settings.repeat + 1));
      check(built.run(mesh, build));
      if (profile == Profile::paper && i == 0) shot = shot_of(scene, built);
      const live::TraceFigures figures = tracer.trace(built.tracer(), mesh, shot);
      stop_if_cancelled();
      split.rays = figures.primary_rays + figures.shadow_rays;
      if (i == 0) continue;  // it warms up
      tree.push_back(built.tree_ms());
      layout.push_back(built.layout_ms());
      trace.push_back(figures.trace_ms());
    }
    split.library.push_back({to_string(profile), median(tree), median(layout), median(trace)});
    if (profile != Profile::paper) continue;
    split.depth = built.tree().info().depth;
    split.tree_hash = hash_string(built.tree().hash());
    draw(context, scene, built, shot.camera, settings, split);
  }
  context.progress.clear();
  return split;
}

}  // namespace fasttree::app
