// SPDX-License-Identifier: Apache-2.0
#include "reference/morton_code.h"

namespace fasttree::reference {

References morton_code(const MeshView& mesh, const Grid& grid, std::uint64_t count) {
  References references;
  references.codes.reserve(count);
  references.ids.reserve(count);
  for (std::uint32_t t = 0; t < mesh.triangle_count; ++t) {
    const CellBox box = grid.cells_of(mesh.triangle(t));
    for (std::uint32_t z = box.lo[2]; z <= box.hi[2]; ++z) {
      for (std::uint32_t y = box.lo[1]; y <= box.hi[1]; ++y) {
        for (std::uint32_t x = box.lo[0]; x <= box.hi[0]; ++x) {
          references.codes.push_back(grid.morton_code({x, y, z}));
          references.ids.push_back(t);
        }
      }
    }
  }
  return references;
}

}  // namespace fasttree::reference
