// SPDX-License-Identifier: Apache-2.0
#include "tests/formats/mesh_writers.h"

#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <random>

namespace fasttree::test {
namespace {

// Nine significant digits give every binary32 back.
std::string decimal(float value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", static_cast<double>(value));
  return text;
}

std::string decimals(Vec3 p) {
  return decimal(p.x) + " " + decimal(p.y) + " " + decimal(p.z);
}

std::string ply_header(const TriangleMesh& mesh, const std::string& encoding) {
  return "ply\nformat " + encoding + " 1.0\nelement vertex " +
         std::to_string(mesh.positions.size()) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
         std::to_string(mesh.indices.size() / 3) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

void append(std::string& out, Vec3 p, bool big_endian = false) {
  for (std::size_t axis = 0; axis < 3; ++axis) test::append(out, p[axis], big_endian);
}

std::string buffer_of(const TriangleMesh& mesh) {
  std::string bytes;
  for (const Vec3 p : mesh.positions) append(bytes, p);
  for (const std::uint32_t i : mesh.indices) test::append(bytes, i);
  return bytes;
}

std::string gltf_json(const TriangleMesh& mesh, const std::string& uri) {
  const std::size_t positions = mesh.positions.size() * 12;
  const std::size_t indices = mesh.indices.size() * 4;
  return R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
         R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
         R"("accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":)" +
         std::to_string(mesh.positions.size()) +
         R"(},{"bufferView":1,"componentType":5125,"type":"SCALAR","count":)" +
         std::to_string(mesh.indices.size()) + R"(}],"bufferViews":[{"buffer":0,"byteLength":)" +
         std::to_string(positions) + R"(},{"buffer":0,"byteOffset":)" + std::to_string(positions) +
         R"(,"byteLength":)" + std::to_string(indices) + R"(}],"buffers":[{)" + uri +
         R"("byteLength":)" + std::to_string(positions + indices) + "}]}";
}

}  // namespace

TriangleMesh random_mesh(std::uint32_t seed, std::uint32_t vertices, std::uint32_t triangles) {
  std::mt19937 random(seed);
  TriangleMesh mesh;
  while (mesh.positions.size() < vertices) {
    Vec3 p;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      do {  // any bits that are a finite number
        p[axis] = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
      } while (!std::isfinite(p[axis]));
      if (random() % 8 == 0) p[axis] = random() % 2 == 0 ? -0.0f : 1e-42f;
    }
    mesh.positions.push_back(p);
  }
  while (mesh.indices.size() < std::size_t{3} * triangles) {
    mesh.indices.push_back(static_cast<std::uint32_t>(random() % vertices));
  }
  return mesh;
}

std::string write_ply_ascii(const TriangleMesh& mesh) {
  std::string out = ply_header(mesh, "ascii");
  for (const Vec3 p : mesh.positions) out += decimals(p) + "\n";
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    out += "3 " + std::to_string(mesh.indices[i]) + " " + std::to_string(mesh.indices[i + 1]) +
           " " + std::to_string(mesh.indices[i + 2]) + "\n";
  }
  return out;
}

std::string write_ply_binary(const TriangleMesh& mesh, bool big_endian) {
  std::string out = ply_header(mesh, big_endian ? "binary_big_endian" : "binary_little_endian");
  for (const Vec3 p : mesh.positions) append(out, p, big_endian);
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    if (i % 3 == 0) out += '\3';
    test::append(out, mesh.indices[i], big_endian);
  }
  return out;
}

std::string write_obj(const TriangleMesh& mesh) {
  std::string out = "# test\no mesh\n";
  for (const Vec3 p : mesh.positions) out += "v " + decimals(p) + "\n";
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    out += "f " + std::to_string(mesh.indices[i] + 1) + " " +
           std::to_string(mesh.indices[i + 1] + 1) + " " + std::to_string(mesh.indices[i + 2] + 1) +
           "\n";
  }
  return out;
}

std::string write_stl_ascii(const TriangleMesh& mesh) {
  std::string out = "solid test\n";
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    out += "facet normal 0 0 0\n outer loop\n";
    for (std::size_t c = 0; c < 3; ++c) {
      out += "  vertex " + decimals(mesh.positions[mesh.indices[i + c]]) + "\n";
    }
    out += " endloop\nendfacet\n";
  }
  return out + "endsolid test\n";
}

std::string write_stl_binary(const TriangleMesh& mesh, std::string_view header) {
  std::string out(header);
  out.resize(80);
  test::append(out, static_cast<std::uint32_t>(mesh.indices.size() / 3));
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    if (i % 3 == 0) append(out, Vec3{0, 0, 1});
    append(out, mesh.positions[mesh.indices[i]]);
    if (i % 3 == 2) test::append(out, std::uint16_t{0});
  }
  return out;
}

std::string write_gltf(const TriangleMesh& mesh) {
  return gltf_json(
      mesh, R"("uri":"data:application/octet-stream;base64,)" + base64(buffer_of(mesh)) + "\",");
}

std::string write_glb(const TriangleMesh& mesh) {
  return glb_of(gltf_json(mesh, ""), buffer_of(mesh));
}

std::string glb_of(std::string json, std::string binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4);
  std::string body;
  test::append(body, static_cast<std::uint32_t>(json.size()));
  body += "JSON" + json;
  if (!binary.empty()) {
    test::append(body, static_cast<std::uint32_t>(binary.size()));
    body += std::string("BIN\0", 4) + binary;
  }
  std::string out = "glTF";
  test::append(out, std::uint32_t{2});
  test::append(out, static_cast<std::uint32_t>(body.size() + 12));
  return out + body;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      out += i + k <= bytes.size() ? kAlphabet[group >> (18 - 6 * k) & 63u] : '=';
    }
  }
  return out;
}

scene::Source source_of(std::string_view bytes) {
  scene::Source source;
  source.name = "test";
  source.bytes = std::as_bytes(std::span(bytes.data(), bytes.size()));
  return source;
}

std::vector<Vec3> corners_of(const scene::Mesh& mesh) {
  const MeshView view = mesh.view();
  std::vector<Vec3> corners;
  for (std::uint32_t t = 0; t < view.triangle_count; ++t) {
    for (const Vec3 p : view.triangle(t)) corners.push_back(p);
  }
  return corners;
}

std::vector<Vec3> corners_of(const TriangleMesh& mesh) {
  std::vector<Vec3> corners;
  for (const std::uint32_t i : mesh.indices) corners.push_back(mesh.positions[i]);
  return corners;
}

bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0);
}

}  // namespace fasttree::test
