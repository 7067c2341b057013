// SPDX-License-Identifier: Apache-2.0
// A view of the caller's triangles. Nothing is copied and nothing is owned.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "fasttree/status.h"
#include "fasttree/vec.h"

namespace fasttree {

/// Triangles in the caller's memory: positions with a stride, and 32-bit indices or none.
///
/// Position i is three binary32 at `positions + i * position_stride_bytes` (any alignment).
/// Triangle t uses positions indices[3t .. 3t+2], or 3t .. 3t+2 where `indices` is null.
/// The memory stays the caller's and has to outlive every object made from the view.
struct MeshView {
  const void* positions = nullptr;
  std::size_t position_stride_bytes = 3 * sizeof(float);
  std::uint32_t vertex_count = 0;
  const std::uint32_t* indices = nullptr;
  std::uint32_t triangle_count = 0;

  std::uint32_t vertex_index(std::uint32_t triangle, std::uint32_t corner) const {
    const std::size_t i = std::size_t{3} * triangle + corner;
    return indices != nullptr ? indices[i] : static_cast<std::uint32_t>(i);
  }

  Vec3 position(std::uint32_t vertex) const {
    Vec3 p;
    static_assert(sizeof(Vec3) == 3 * sizeof(float));
    std::memcpy(&p, static_cast<const std::byte*>(positions) + vertex * position_stride_bytes,
                sizeof p);
    return p;
  }

  std::array<Vec3, 3> triangle(std::uint32_t t) const {
    return {position(vertex_index(t, 0)), position(vertex_index(t, 1)),
            position(vertex_index(t, 2))};
  }
};

/// Largest number of triangles in a mesh: a leaf's count has 30 bits.
inline constexpr std::uint32_t kMaxTriangles = (1u << 30) - 1;

/// Checks the shape of a view: pointers, stride, the number of triangles, and that every index
/// names a vertex. bad_input names the first triangle with a bad index. Coordinates are checked
/// where the bounds are computed (scene_bound), not here.
Status validate(const MeshView& mesh);

}  // namespace fasttree
