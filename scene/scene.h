// SPDX-License-Identifier: Apache-2.0
// A scene by name: a mesh file, or a procedural scene ("scene:knot:100000").
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "fasttree/build.h"
#include "fasttree/mesh.h"
#include "fasttree/status.h"
#include "fasttree/vec.h"

namespace fasttree::scene {

/// A loaded mesh. Owns its memory, or views positions inside a mapped file.
struct Mesh {
  std::string name;                     ///< for people: the file's stem, or the procedural name
  std::vector<Vec3> positions;          ///< empty where the positions lie in the mapping
  std::vector<std::uint32_t> indices;   ///< three a triangle
  std::shared_ptr<const void> mapping;  ///< keeps the file mapped
  const void* mapped_positions = nullptr;
  std::size_t mapped_stride_bytes = 0;
  std::uint32_t mapped_vertex_count = 0;

  MeshView view() const;
};

struct LoadSettings {
  /// Bytes the mesh may take in memory; 0: no limit. Checked from the file's own counts, which are
  /// checked against the file's size, before memory is allocated.
  std::uint64_t memory_limit_bytes = 0;
  ProgressCallback progress;
};

/// Loads "scene:NAME[:SIZE][:...]" or a file by its content and extension (PLY, OBJ, STL, glTF,
/// GLB). io_error: cannot open or read; bad_input: what, where (line or byte) and what to do.
Result<Mesh> load_scene(const std::string& spec, const LoadSettings& settings = {});

/// Parts of load_scene.
Result<Mesh> load_mesh_file(const std::string& path, const LoadSettings& settings = {});
Result<Mesh> make_procedural_scene(const std::string& spec, const LoadSettings& settings = {});

}  // namespace fasttree::scene
