// SPDX-License-Identifier: Apache-2.0
// Small meshes written in every format, for the readers' tests. Independent of the readers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "fasttree/vec.h"
#include "scene/formats/formats.h"

namespace fasttree::test {

struct TriangleMesh {
  std::vector<Vec3> positions;
  std::vector<std::uint32_t> indices;
};

/// Random numbers of all sizes, denormal ones and negative zero among them; any triangles.
TriangleMesh random_mesh(std::uint32_t seed, std::uint32_t vertices, std::uint32_t triangles);

std::string write_ply_ascii(const TriangleMesh& mesh);
std::string write_ply_binary(const TriangleMesh& mesh, bool big_endian);
std::string write_obj(const TriangleMesh& mesh);
std::string write_stl_ascii(const TriangleMesh& mesh);
std::string write_stl_binary(const TriangleMesh& mesh, std::string_view header);
std::string write_gltf(const TriangleMesh& mesh);
std::string write_glb(const TriangleMesh& mesh);

/// A GLB of any JSON and binary chunk; none where `binary` is empty.
std::string glb_of(std::string json, std::string binary);
std::string base64(std::string_view bytes);

/// The bytes of a value, little-endian.
template <typename T>
void append(std::string& out, T value, bool big_endian = false) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
  if (big_endian) bytes = std::string(bytes.rbegin(), bytes.rend());
  out += bytes;
}

/// A file's bytes as a source named "test".
scene::Source source_of(std::string_view bytes);

/// Corner positions in order, three a triangle: what a mesh is, whatever its vertices.
std::vector<Vec3> corners_of(const scene::Mesh& mesh);
std::vector<Vec3> corners_of(const TriangleMesh& mesh);

/// Whether two lists are the same bit for bit (NaN and negative zero included).
bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b);

}  // namespace fasttree::test
