// SPDX-License-Identifier: Apache-2.0
#include "fasttree/mesh.h"

#include <string>

#include "geometry/mesh_checks.h"

namespace fasttree {

Status validate_shape(const MeshView& mesh) {
  if (mesh.triangle_count == 0) return {};
  if (mesh.triangle_count > kMaxTriangles) {
    return {StatusCode::resource_limit, "mesh: " + std::to_string(mesh.triangle_count) +
                                            " triangles; a tree holds at most " +
                                            std::to_string(kMaxTriangles) + ". Split the mesh."};
  }
  if (mesh.positions == nullptr) {
    return {StatusCode::invalid_argument, "mesh: triangles without positions (null pointer)"};
  }
  if (mesh.position_stride_bytes < 3 * sizeof(float)) {
    return {StatusCode::invalid_argument, "mesh: a position stride of " +
                                              std::to_string(mesh.position_stride_bytes) +
                                              " bytes is less than the 12 bytes of a position"};
  }
  if (mesh.indices == nullptr) {
    if (std::uint64_t{3} * mesh.triangle_count > mesh.vertex_count) {
      return {StatusCode::invalid_argument,
              "mesh: without indices " + std::to_string(mesh.triangle_count) + " triangles need " +
                  std::to_string(std::uint64_t{3} * mesh.triangle_count) + " vertices, not " +
                  std::to_string(mesh.vertex_count)};
    }
  }
  return {};
}

Status validate(const MeshView& mesh) {
  if (Status status = validate_shape(mesh); !status.ok()) return status;
  if (mesh.indices == nullptr) return {};
  for (std::uint32_t t = 0; t < mesh.triangle_count; ++t) {
    for (std::uint32_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t index = mesh.vertex_index(t, corner);
      if (index >= mesh.vertex_count) {
        return {StatusCode::bad_input, "mesh: triangle " + std::to_string(t) + " uses vertex " +
                                           std::to_string(index) + ", but there are only " +
                                           std::to_string(mesh.vertex_count)};
      }
    }
  }
  return {};
}

}  // namespace fasttree
