// SPDX-License-Identifier: Apache-2.0
#include "moving.h"

#include <fmt/format.h>

#include <utility>

#include "progress.h"

namespace fasttree::app {

MovingOptions::MovingOptions() {
  // What is rebuilt every frame wants the builder that is made for it.
  build.settings.profile = Profile::realtime;
}

void MovingOptions::declare(Options& options, const char* source_help) {
  options.positional(source, "SOURCE", source_help);
  options.extent(width, height, "--size", "Pixels", 16384);
  camera.declare(options);
  options.flag_pair(shadows, "--shadows", "--no-shadows", "Trace shadow rays (the default)",
                    "Trace none");
  options.point(light, "--light", "Where the light is; else above the camera, to its right");
  build.declare(options);
}

Moving::Moving(Context& context, const MovingOptions& options, live::Frames frames,
               std::uint64_t keep_bytes, std::uint64_t trace_bytes)
    : context_(context),
      store_(std::move(frames), options.build.settings.memory_limit_bytes, keep_bytes),
      settings_(options.build.settings),
      limit_bytes_(options.build.settings.memory_limit_bytes),
      trace_bytes_(trace_bytes) {
  // Cancels, and draws nothing: the bar would be part of what is measured.
  settings_.progress = [](const char*, double) { return !cancelled(); };
  const ProgressCallback say = context.progress.callback("reading");
  for (std::size_t f = 0; f < store_.size(); ++f) {
    say(label(f).c_str(), static_cast<double>(f) / static_cast<double>(store_.size()));
    load(f);
    const Box3 box = live::mesh_bounds(mesh_);
    if (box.empty()) continue;
    bounds_.include(box.lo);
    bounds_.include(box.hi);
  }
  rebuild(0);
  first_build_ms_ = rebuild_.build_ms();
  shot_.camera = options.camera.choose(options.source, bounds_, rebuild_.tracer());
  shot_.light = options.light ? *options.light : live::place_light(shot_.camera, rebuild_.tracer());
  shot_.shadows = options.shadows;
  context.progress.clear();
}

std::string Moving::label(std::size_t frame) const {
  return live::frame_label(store_.frames(), frame);
}

void Moving::load(std::size_t frame) {
  stop_if_cancelled();
  mesh_ = take(store_.get(frame, settings_.progress))->view();
}

std::uint64_t Moving::memory_left() const {
  if (limit_bytes_ == 0) return 0;
  const std::uint64_t used = store_.held_bytes() + trace_bytes_;
  if (used >= limit_bytes_) {
    throw Failure{kResourceLimit,
                  fmt::format("meshes and rays take {}, and the limit is {}; use a smaller --size "
                              "or a larger --memory-limit",
                              bytes_text(used), bytes_text(limit_bytes_))};
  }
  return limit_bytes_ - used;
}

void Moving::rebuild(std::size_t frame) {
  load(frame);
  settings_.memory_limit_bytes = memory_left();
  const Status status = rebuild_.run(mesh_, settings_);
  if (status.ok()) return;
  if (status.code() == StatusCode::cancelled) check(status);
  throw Failure{exit_code_of(status.code()),
                fmt::format("{}: {}", store_.frames().specs[frame], status.message())};
}

}  // namespace fasttree::app
