// SPDX-License-Identifier: Apache-2.0
// Step 2 of 6, Morton code generation and triangle duplication (MCGU). Docs: docs/morton_code.md.
#pragma once

#include <cstdint>
#include <vector>

#include "fasttree/mesh.h"
#include "grid/grid.h"

namespace fasttree::reference {

/// References: triangle ids[i] lies in the cell with Morton code codes[i].
struct References {
  std::vector<std::uint32_t> codes;
  std::vector<std::uint32_t> ids;

  std::size_t size() const { return codes.size(); }
};

/// Every triangle in every cell of its box, x fastest, then y, then z; triangles in order of their
/// ids. `count` is M(D), known from count_references.
References morton_code(const MeshView& mesh, const Grid& grid, std::uint64_t count);

}  // namespace fasttree::reference
