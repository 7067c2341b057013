// SPDX-License-Identifier: Apache-2.0
// What animate and view have in common: a source of frames, a tree that is rebuilt for each, and
// where they are looked at from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "command.h"
#include "inputs.h"
#include "live/frame_store.h"
#include "live/frame_tracer.h"
#include "live/rebuild.h"
#include "options.h"
#include "views.h"

namespace fasttree::app {

struct MovingOptions {
  std::string source;
  std::uint32_t width = 512;
  std::uint32_t height = 512;
  bool shadows = true;
  std::optional<Vec3> light;
  CameraOptions camera;
  BuildOptions build;

  MovingOptions();
  void declare(Options& options, const char* source_help);
};

/// Frames, read and rebuilt one after the other.
class Moving {
 public:
  /// Reads every frame once, for the bounds of all of them and so that a bad one is found now;
  /// builds the first, and chooses camera and light. Keeps `keep_bytes` of meshes where there is
  /// more than one. `trace_bytes` are taken by whoever traces.
  Moving(Context& context, const MovingOptions& options, live::Frames frames,
         std::uint64_t keep_bytes, std::uint64_t trace_bytes);

  std::size_t frames() const { return store_.size(); }
  const std::string& name() const { return store_.frames().name; }
  std::string label(std::size_t frame) const;

  /// Makes tree and tracer those of a frame. The mesh is read first, where it is not there yet.
  void rebuild(std::size_t frame);

  const MeshView& mesh() const { return mesh_; }
  const live::Rebuild& built() const { return rebuild_; }
  const live::Shot& shot() const { return shot_; }
  const Box3& bounds() const { return bounds_; }
  /// Of the very first build, whose memory was not there yet.
  double first_build_ms() const { return first_build_ms_; }
  /// Bytes that are left beside the meshes, for a build or a picture; 0: no limit.
  std::uint64_t memory_left() const;

  /// Another size of picture.
  void set_trace_bytes(std::uint64_t bytes) { trace_bytes_ = bytes; }

 private:
  void load(std::size_t frame);

  Context& context_;
  live::FrameStore store_;
  BuildSettings settings_;
  std::uint64_t limit_bytes_;
  std::uint64_t trace_bytes_;
  live::Rebuild rebuild_;
  MeshView mesh_;
  Box3 bounds_;
  live::Shot shot_;
  double first_build_ms_ = 0;
};

}  // namespace fasttree::app
