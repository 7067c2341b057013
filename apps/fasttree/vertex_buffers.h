// SPDX-License-Identifier: Apache-2.0
// A copy of a mesh in memory as a renderer's vertex buffers have it: packed, and in huge pages
// where the system has them. Embree's copy is in its own buffers, which are so too.
#pragma once

#include <cstring>

#include "fasttree/mesh.h"
#include "support/raw_array.h"

namespace fasttree::app {

class VertexBuffers {
 public:
  explicit VertexBuffers(const MeshView& mesh) {
    positions_.resize_and_forget(mesh.vertex_count);
    for (std::uint32_t v = 0; v < mesh.vertex_count; ++v) positions_[v] = mesh.position(v);
    if (mesh.indices != nullptr && mesh.triangle_count > 0) {
      indices_.resize_and_forget(std::size_t{3} * mesh.triangle_count);
      std::memcpy(indices_.data(), mesh.indices, indices_.size() * sizeof(std::uint32_t));
    }
    view_.positions = positions_.data();
    view_.vertex_count = mesh.vertex_count;
    view_.indices = mesh.indices != nullptr ? indices_.data() : nullptr;  // or there are none
    view_.triangle_count = mesh.triangle_count;
  }
  VertexBuffers(const VertexBuffers&) = delete;
  VertexBuffers& operator=(const VertexBuffers&) = delete;

  const MeshView& view() const { return view_; }

 private:
  RawArray<Vec3> positions_;
  RawArray<std::uint32_t> indices_;
  MeshView view_;
};

}  // namespace fasttree::app
