// SPDX-License-Identifier: Apache-2.0
// Copies a leaf's triangles into rows, several at once, and finds the box round them.
#pragma once

#include <cstdint>
#include <span>

#include "fasttree/mesh.h"
#include "fasttree/vec.h"

namespace fasttree {

class LeafTriangles {
 public:
  LeafTriangles(const MeshView& mesh, std::span<const std::uint32_t> ids)
      : mesh_(mesh), ids_(ids) {}

  /// Writes the triangles ids[first ... first + count - 1] in rows of `count` values each (see
  /// WideLayout::triangles) and returns the box round them.
  Box3 operator()(std::uint32_t first, std::uint32_t count, float* rows) const;

 private:
  MeshView mesh_;
  std::span<const std::uint32_t> ids_;
};

}  // namespace fasttree
