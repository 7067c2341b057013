// SPDX-License-Identifier: Apache-2.0
// The meshes of an animation: read when they are wanted, kept where memory allows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "fasttree/build.h"
#include "live/frames.h"
#include "scene/scene.h"

namespace fasttree::live {

/// Bytes that a mesh takes, in memory or in its mapping.
std::uint64_t mesh_bytes(const scene::Mesh& mesh);

/// The bounds of a mesh's triangles; empty where it has none.
Box3 mesh_bounds(const MeshView& mesh);

class FrameStore {
 public:
  /// Keeps as many meshes as `keep_bytes` hold, and always the last one. A mesh may take
  /// `limit_bytes`; 0: no limit.
  FrameStore(Frames frames, std::uint64_t limit_bytes, std::uint64_t keep_bytes);

  const Frames& frames() const { return frames_; }
  std::size_t size() const { return frames_.specs.size(); }
  /// Leaves only the first frames.
  void keep_first(std::size_t count) {
    frames_.specs.resize(count);
    meshes_.resize(count);
  }

  /// The mesh, which may go with the next get(). Errors name the file.
  Result<const scene::Mesh*> get(std::size_t frame, const ProgressCallback& progress = {});

  /// Bytes of all meshes that are held now.
  std::uint64_t held_bytes() const { return held_bytes_; }
  /// Bytes of the largest mesh seen so far.
  std::uint64_t largest_bytes() const { return largest_bytes_; }

 private:
  Frames frames_;
  std::uint64_t limit_bytes_;
  std::uint64_t keep_bytes_;
  std::vector<std::optional<scene::Mesh>> meshes_;
  std::uint64_t held_bytes_ = 0;
  std::uint64_t largest_bytes_ = 0;
};

}  // namespace fasttree::live
