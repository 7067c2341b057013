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
  explicit LeafTriangles(const MeshView& mesh) : mesh_(mesh) {}

  /// Writes rows of ids.size() values each (see WideLayout::triangles) and returns the box.
  Box3 operator()(std::span<const std::uint32_t> ids, float* rows) const;

 private:
  MeshView mesh_;
};

}  // namespace fasttree
