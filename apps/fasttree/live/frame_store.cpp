// SPDX-License-Identifier: Apache-2.0
#include "live/frame_store.h"

#include <algorithm>
#include <utility>

namespace fasttree::live {

std::uint64_t mesh_bytes(const scene::Mesh& mesh) {
  return std::uint64_t{mesh.positions.size()} * sizeof(Vec3) +
         std::uint64_t{mesh.indices.size()} * sizeof(std::uint32_t) +
         std::uint64_t{mesh.mapped_vertex_count} * mesh.mapped_stride_bytes;
}

Box3 mesh_bounds(const MeshView& mesh) {
  Box3 bounds;
  for (std::uint32_t t = 0; t < mesh.triangle_count; ++t) {
    for (const Vec3& corner : mesh.triangle(t)) bounds.include(corner);
  }
  return bounds;
}

FrameStore::FrameStore(Frames frames, std::uint64_t limit_bytes, std::uint64_t keep_bytes)
    : frames_(std::move(frames)),
      limit_bytes_(limit_bytes),
      keep_bytes_(keep_bytes),
      meshes_(frames_.specs.size()) {}

Result<const scene::Mesh*> FrameStore::get(std::size_t frame, const ProgressCallback& progress) {
  std::optional<scene::Mesh>& slot = meshes_[frame];
  if (!slot) {
    // The next mesh is taken to be as large as the largest so far, and room is made before it is
    // read: a moment with too many would be over the limit as well.
    if (held_bytes_ + largest_bytes_ > keep_bytes_) {
      for (auto& other : meshes_) other.reset();
      held_bytes_ = 0;
    }
    scene::LoadSettings settings;
    settings.progress = progress;
    // 1 stands for nothing left, as 0 stands for no limit.
    if (limit_bytes_ > 0) {
      settings.memory_limit_bytes =
          limit_bytes_ > held_bytes_ ? limit_bytes_ - held_bytes_ : std::uint64_t{1};
    }
    Result<scene::Mesh> loaded = scene::load_scene(frames_.specs[frame], settings);
    if (!loaded.ok()) return loaded.status();
    slot = std::move(loaded).value();
    const std::uint64_t bytes = mesh_bytes(*slot);
    held_bytes_ += bytes;
    largest_bytes_ = std::max(largest_bytes_, bytes);
  }
  return &*slot;
}

}  // namespace fasttree::live
