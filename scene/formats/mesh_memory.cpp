// SPDX-License-Identifier: Apache-2.0
#include "scene/formats/mesh_memory.h"

#include <limits>

namespace fasttree::scene {

Status MemoryBudget::claim(std::uint64_t bytes, const char* what) {
  if (limit_ != 0 && (bytes > limit_ || held_ > limit_ - bytes)) {
    return {StatusCode::resource_limit,
            source_.name + ": " + what + " would take " + std::to_string(bytes) + " bytes, with " +
                std::to_string(held_) + " held already, but the limit is " +
                std::to_string(limit_) + ". Raise the memory limit or use a smaller mesh."};
  }
  held_ += bytes;
  return {};
}

Status MemoryBudget::allocate(std::uint64_t vertices, std::uint64_t triangles, Mesh& mesh) {
  if (Status s = check_counts(source_, vertices, triangles); !s.ok()) return s;
  if (Status s = claim(vertices * sizeof(Vec3) + triangles * 3 * sizeof(std::uint32_t), "the mesh");
      !s.ok()) {
    return s;
  }
  mesh.positions.resize(vertices);
  mesh.indices.resize(triangles * 3);
  return {};
}

Status check_counts(const Source& source, std::uint64_t vertices, std::uint64_t triangles) {
  constexpr std::uint64_t kMaxVertices = std::numeric_limits<std::uint32_t>::max();
  if (vertices > kMaxVertices) {
    return {StatusCode::resource_limit,
            source.name + ": has " + std::to_string(vertices) + " vertices; the most is " +
                std::to_string(kMaxVertices) + " (32-bit indices). Split the mesh."};
  }
  if (triangles > kMaxTriangles) {
    return {StatusCode::resource_limit, source.name + ": has " + std::to_string(triangles) +
                                            " triangles; the most is " +
                                            std::to_string(kMaxTriangles) + ". Split the mesh."};
  }
  return {};
}

Status changed_while_read(const Source& source) {
  return {StatusCode::io_error,
          source.name + ": the file changed while it was read. Load it again once it is complete."};
}

}  // namespace fasttree::scene
