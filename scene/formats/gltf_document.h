// SPDX-License-Identifier: Apache-2.0
// The part of a glTF 2.0 document that makes triangles, with types, ranges and references checked.
// (glTF 2.0 specification, Khronos Group, section 5, names the properties.)
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/formats/source.h"

namespace fasttree::scene {

/// Accessor component types and primitive modes by their numbers in the file.
enum class GltfComponent : std::uint32_t {
  int8 = 5120,
  uint8 = 5121,
  int16 = 5122,
  uint16 = 5123,
  uint32 = 5125,
  float32 = 5126,
};
enum class GltfMode : std::uint32_t {
  points = 0,
  lines = 1,
  line_loop = 2,
  line_strip = 3,
  triangles = 4,
  triangle_strip = 5,
  triangle_fan = 6,
};

std::size_t gltf_size(GltfComponent component);

using GltfIndex = std::optional<std::size_t>;  ///< into another array of the document, checked

struct GltfBuffer {
  std::optional<std::string> uri;
  std::uint64_t byte_length = 0;
};

struct GltfBufferView {
  std::size_t buffer = 0;
  std::uint64_t byte_offset = 0;
  std::uint64_t byte_length = 0;
  std::uint64_t byte_stride = 0;  ///< 0: elements without gaps
};

struct GltfSparse {
  std::uint64_t count = 0;
  std::size_t index_view = 0;
  std::uint64_t index_offset = 0;
  GltfComponent index_component = GltfComponent::uint32;
  std::size_t value_view = 0;
  std::uint64_t value_offset = 0;
};

struct GltfAccessor {
  GltfIndex view;  ///< none: all elements zero, before the sparse ones
  std::uint64_t byte_offset = 0;
  std::uint64_t count = 0;
  GltfComponent component = GltfComponent::float32;
  bool normalized = false;
  std::string type;  ///< "SCALAR", "VEC3", ...
  std::optional<GltfSparse> sparse;
};

struct GltfPrimitive {
  GltfMode mode = GltfMode::triangles;
  GltfIndex positions;  ///< none: nothing to draw
  GltfIndex indices;    ///< none: positions in order
};

struct GltfMesh {
  std::vector<GltfPrimitive> primitives;
};

/// A 4 x 4 matrix by columns, as in the file.
using GltfMatrix = std::array<double, 16>;
GltfMatrix gltf_identity();
GltfMatrix gltf_product(const GltfMatrix& a, const GltfMatrix& b);

struct GltfNode {
  GltfIndex mesh;
  std::vector<std::size_t> children;
  GltfMatrix local = gltf_identity();  ///< from `matrix`, or from translation, rotation and scale
};

struct GltfDocument {
  std::vector<GltfBuffer> buffers;
  std::vector<GltfBufferView> views;
  std::vector<GltfAccessor> accessors;
  std::vector<GltfMesh> meshes;
  std::vector<GltfNode> nodes;
  std::vector<std::size_t> roots;  ///< nodes to draw, in order
};

/// Reads the JSON text, which begins at `offset` in the file. bad_input with the property's path
/// ("accessors[3].count") or, for bad JSON, the byte.
Result<GltfDocument> parse_gltf_document(const Source& source, std::string_view json,
                                         std::size_t offset);

}  // namespace fasttree::scene
