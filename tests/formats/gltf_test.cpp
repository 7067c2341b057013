// SPDX-License-Identifier: Apache-2.0
// glTF: containers, accessors and primitive modes.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "scene/formats/formats.h"
#include "tests/formats/mesh_writers.h"

namespace fasttree::scene {
namespace {

using test::append;
using test::source_of;
using Indices = std::vector<std::uint32_t>;

std::string vec3s(std::initializer_list<Vec3> points) {
  std::string bytes;
  for (const Vec3 p : points) {
    for (std::size_t axis = 0; axis < 3; ++axis) append(bytes, p[axis]);
  }
  return bytes;
}

// Five points, then the indices 0 1 2 3 4 0 as bytes, from byte 60 on.
const std::string kBuffer =
    vec3s({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 2, 2}}) + std::string("\0\1\2\3\4\0", 6);

const std::string kPoints = R"({"bufferView":0,"componentType":5126,"count":5,"type":"VEC3"})";
const std::string kIndices = R"({"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"})";

struct Parts {
  std::string buffer = kBuffer;
  std::string views = R"({"buffer":0,"byteLength":60},{"buffer":0,"byteOffset":60,"byteLength":6})";
  std::string accessors = kPoints + "," + kIndices;
  std::string primitive = R"("attributes":{"POSITION":0},"indices":1)";
  std::string more;
};

std::string gltf(const Parts& parts) {
  return R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":)" +
         std::to_string(parts.buffer.size()) + R"(,"uri":"data:application/octet-stream;base64,)" +
         test::base64(parts.buffer) + R"("}],"bufferViews":[)" + parts.views +
         R"(],"accessors":[)" + parts.accessors + R"(],"meshes":[{"primitives":[{)" +
         parts.primitive + "}]}]" + parts.more + "}";
}

Mesh good(const std::string& text, const LoadSettings& settings = {}) {
  Result<Mesh> mesh = parse_gltf(source_of(text), settings);
  EXPECT_TRUE(mesh.ok()) << mesh.status().message() << "\n" << text;
  return mesh.ok() ? std::move(mesh).value() : Mesh();
}

void expect_refusal(const std::string& text, const std::string& part,
                    const LoadSettings& settings = {}, StatusCode code = StatusCode::bad_input) {
  const Result<Mesh> mesh = parse_gltf(source_of(text), settings);
  EXPECT_EQ(mesh.status().code(), code) << mesh.status().message() << "\n" << text;
  EXPECT_NE(mesh.status().message().find(part), std::string::npos) << mesh.status().message();
}

TEST(Gltf, ReadsEveryModeThatMakesTriangles) {
  const std::string positions = R"("attributes":{"POSITION":0},"mode":)";
  const std::string indexed = R"("attributes":{"POSITION":0},"indices":1,"mode":)";
  Parts parts;
  parts.primitive = indexed + "4";
  EXPECT_EQ(good(gltf(parts)).indices, (Indices{0, 1, 2, 3, 4, 0}));
  parts.primitive = R"("attributes":{"POSITION":0},"indices":1)";
  EXPECT_EQ(good(gltf(parts)).indices, (Indices{0, 1, 2, 3, 4, 0}));
  parts.primitive = indexed + "5";
  EXPECT_EQ(good(gltf(parts)).indices, (Indices{0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 0, 4}));
  parts.primitive = indexed + "6";
  EXPECT_EQ(good(gltf(parts)).indices, (Indices{1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 0, 0}));
  parts.primitive = positions + "5";
  EXPECT_EQ(good(gltf(parts)).indices, (Indices{0, 1, 2, 1, 3, 2, 2, 3, 4}));
  parts.primitive = positions + "6";
  EXPECT_EQ(good(gltf(parts)).indices, (Indices{1, 2, 0, 2, 3, 0, 3, 4, 0}));
  for (const char* no_triangles : {"0", "1", "2", "3"}) {
    parts.primitive = positions + no_triangles;
    EXPECT_EQ(good(gltf(parts)).view().triangle_count, 0u);
  }
  parts.primitive = positions + "4";
  expect_refusal(gltf(parts), "has 5 corners, which are no whole triangles");
  parts.primitive = positions + "7";
  expect_refusal(gltf(parts), "mode is 7");
  parts.primitive = R"("attributes":{"NORMAL":0})";
  EXPECT_EQ(good(gltf(parts)).view().triangle_count, 0u);
}

TEST(Gltf, ReadsIndicesOfEveryComponentType) {
  for (const int component : {5121, 5123, 5125}) {
    Parts parts;
    parts.buffer = kBuffer.substr(0, 60);
    for (const std::uint32_t i : {4u, 2u, 0u}) {
      if (component == 5121) append(parts.buffer, static_cast<std::uint8_t>(i));
      if (component == 5123) append(parts.buffer, static_cast<std::uint16_t>(i));
      if (component == 5125) append(parts.buffer, i);
    }
    parts.views = R"({"buffer":0,"byteLength":60},{"buffer":0,"byteOffset":60,"byteLength":)" +
                  std::to_string(parts.buffer.size() - 60) + "}";
    parts.accessors = kPoints + R"(,{"bufferView":1,"count":3,"type":"SCALAR","componentType":)" +
                      std::to_string(component) + "}";
    EXPECT_EQ(good(gltf(parts)).indices, (Indices{4, 2, 0})) << component;
  }
  for (const char* component : {"5120", "5122", "5126"}) {
    Parts parts;
    parts.accessors = kPoints + R"(,{"bufferView":0,"count":3,"type":"SCALAR","componentType":)" +
                      component + "}";
    expect_refusal(gltf(parts), "accessors[1] holds indices");
  }
  Parts parts;
  parts.accessors = kPoints + R"(,{"bufferView":1,"componentType":5121,"count":2,"type":"VEC3"})";
  expect_refusal(gltf(parts), "accessors[1] holds indices");
}

TEST(Gltf, ReadsQuantizedPositions) {
  Parts parts;
  parts.buffer.clear();
  for (const int value : {-128, 0, 127, -127, 64, 1, 0, 0, 0}) {
    append(parts.buffer, static_cast<std::int8_t>(value));
    if (parts.buffer.size() % 4 == 3) parts.buffer += 'x';
  }
  parts.views = R"({"buffer":0,"byteLength":12,"byteStride":4})";
  parts.primitive = R"("attributes":{"POSITION":0})";
  parts.accessors = R"({"bufferView":0,"componentType":5120,"count":3,"type":"VEC3"})";
  EXPECT_EQ(good(gltf(parts)).positions,
            (std::vector<Vec3>{{-128, 0, 127}, {-127, 64, 1}, {0, 0, 0}}));
  parts.accessors =
      R"({"bufferView":0,"componentType":5120,"count":3,"type":"VEC3","normalized":true})";
  EXPECT_EQ(good(gltf(parts)).positions,
            (std::vector<Vec3>{{-1, 0, 1}, {-1, 64 / 127.0f, 1 / 127.0f}, {0, 0, 0}}));
  parts.accessors = R"({"bufferView":0,"componentType":5121,"count":3,"type":"VEC3"})";
  EXPECT_EQ(good(gltf(parts)).positions[0], (Vec3{128, 0, 127}));
  parts.buffer.clear();
  for (const std::uint16_t value : {65535, 0, 13107, 1, 2, 3, 4, 5, 6}) append(parts.buffer, value);
  parts.views = R"({"buffer":0,"byteLength":18})";
  parts.accessors =
      R"({"bufferView":0,"componentType":5123,"count":3,"type":"VEC3","normalized":true})";
  EXPECT_EQ(good(gltf(parts)).positions[0], (Vec3{1, 0, 0.2f}));
  parts.accessors = R"({"bufferView":0,"componentType":5122,"count":3,"type":"VEC3"})";
  EXPECT_EQ(good(gltf(parts)).positions[0], (Vec3{-1, 0, 13107}));
  parts.accessors = R"({"bufferView":0,"componentType":5125,"count":1,"type":"VEC3"})";
  expect_refusal(gltf(parts), "accessors[0] holds positions");
}

TEST(Gltf, HonoursOffsetsAndStrides) {
  Parts parts;
  parts.buffer = "..";
  for (int i = 0; i < 3; ++i) parts.buffer += "ab" + vec3s({{1.0f * i, 2, 3}}) + "cdef";
  parts.views = R"({"buffer":0,"byteOffset":2,"byteLength":52,"byteStride":18})";
  parts.accessors =
      R"({"bufferView":0,"byteOffset":2,"componentType":5126,"count":3,"type":"VEC3"})";
  parts.primitive = R"("attributes":{"POSITION":0})";
  // The last element needs 12 bytes of the stride only: 2 + 2 * 18 + 12 = 50.
  EXPECT_EQ(good(gltf(parts)).positions, (std::vector<Vec3>{{0, 2, 3}, {1, 2, 3}, {2, 2, 3}}));
  parts.views = R"({"buffer":0,"byteOffset":2,"byteLength":50,"byteStride":18})";
  EXPECT_EQ(good(gltf(parts)).positions.size(), 3u);
  parts.views = R"({"buffer":0,"byteOffset":2,"byteLength":49,"byteStride":18})";
  expect_refusal(gltf(parts), "accessors[0] ends at byte 50 of bufferViews[0], which has 49");
  parts.views = R"({"buffer":0,"byteOffset":7,"byteLength":50,"byteStride":18})";
  expect_refusal(gltf(parts), "bufferViews[0] ends at byte 57 of a buffer of 56");
  parts.views = R"({"buffer":0,"byteLength":56,"byteStride":8})";
  expect_refusal(gltf(parts), "byteStride is 8");
  parts.views = R"({"buffer":0,"byteLength":56,"byteStride":253})";
  expect_refusal(gltf(parts), "byteStride is over 252");
}

TEST(Gltf, ReadsSparseAccessors) {
  Parts parts;
  parts.buffer = kBuffer;  // 66 bytes
  append(parts.buffer, std::uint16_t{1});
  append(parts.buffer, std::uint16_t{4});
  parts.buffer += vec3s({{5, 5, 5}, {6, 6, 6}});
  parts.views = R"({"buffer":0,"byteLength":60},{"buffer":0,"byteOffset":60,"byteLength":6},)"
                R"({"buffer":0,"byteOffset":66,"byteLength":4},)"
                R"({"buffer":0,"byteOffset":70,"byteLength":24})";
  const std::string sparse = R"("componentType":5126,"count":5,"type":"VEC3","sparse":{"count":2,)"
                             R"("indices":{"bufferView":2,"componentType":5123},)"
                             R"("values":{"bufferView":3}}})";
  parts.accessors = R"({"bufferView":0,)" + sparse + "," + kIndices;
  EXPECT_EQ(good(gltf(parts)).positions,
            (std::vector<Vec3>{{0, 0, 0}, {5, 5, 5}, {1, 1, 0}, {0, 1, 0}, {6, 6, 6}}));
  parts.accessors = "{" + sparse + "," + kIndices;
  EXPECT_EQ(good(gltf(parts)).positions,
            (std::vector<Vec3>{{0, 0, 0}, {5, 5, 5}, {0, 0, 0}, {0, 0, 0}, {6, 6, 6}}));
  // Sparse indices, too: the second of 0 1 2 becomes 4.
  parts.accessors = kPoints +
                    R"(,{"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR",)"
                    R"("sparse":{"count":1,"indices":{"bufferView":2,"componentType":5123},)"
                    R"("values":{"bufferView":1,"byteOffset":4}}})";
  EXPECT_EQ(good(gltf(parts)).indices, (Indices{0, 4, 2}));

  const std::string good_text = gltf(parts);
  parts.accessors = R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","sparse":{)"
                    R"("count":2,"indices":{"bufferView":2,"componentType":5123},)"
                    R"("values":{"bufferView":3}}},)" +
                    kIndices;
  expect_refusal(gltf(parts), "element 1 is 4");
  parts.accessors = R"({"bufferView":0,"componentType":5126,"count":5,"type":"VEC3","sparse":{)"
                    R"("count":2,"indices":{"bufferView":1,"byteOffset":4,"componentType":5121},)"
                    R"("values":{"bufferView":3}}},)" +
                    kIndices;
  expect_refusal(gltf(parts), "element 1 is 0; they have to rise");
  parts.accessors = R"({"bufferView":0,"componentType":5126,"count":5,"type":"VEC3","sparse":{)"
                    R"("count":3,"indices":{"bufferView":2,"componentType":5123},)"
                    R"("values":{"bufferView":3}}},)" +
                    kIndices;
  expect_refusal(gltf(parts), "accessors[0].sparse.indices ends at byte 6");
  parts.accessors = R"({"bufferView":0,"componentType":5126,"count":5,"type":"VEC3","sparse":{)"
                    R"("count":6,"indices":{"bufferView":1,"componentType":5121},)"
                    R"("values":{"bufferView":3}}},)" +
                    kIndices;
  expect_refusal(gltf(parts), "sparse.count is over");
  parts.accessors = R"({"bufferView":0,"componentType":5126,"count":5,"type":"VEC3","sparse":{)"
                    R"("count":2,"indices":{"bufferView":2,"componentType":5122},)"
                    R"("values":{"bufferView":3}}},)" +
                    kIndices;
  expect_refusal(gltf(parts), "has to be unsigned");
}

TEST(Gltf, AnAccessorWithoutDataCannotFillTheMemory) {
  Parts parts;
  parts.accessors = R"({"componentType":5126,"count":5,"type":"VEC3"},)" + kIndices;
  EXPECT_EQ(good(gltf(parts)).positions, std::vector<Vec3>(5));
  parts.accessors = R"({"componentType":5126,"count":300000000,"type":"VEC3"})";
  parts.primitive = R"("attributes":{"POSITION":0})";
  expect_refusal(gltf(parts), "accessors[0] has no bufferView and a count of 300000000");
}

TEST(Gltf, NamesIndicesOutOfRange) {
  Parts parts;
  parts.accessors = R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)" + kIndices;
  expect_refusal(gltf(parts),
                 "meshes[0].primitives[0]: triangle 1 names vertex 4 (element 4 of accessors[1]), "
                 "but there are 4");
}

TEST(Gltf, RefusesWrongReferencesAndTypes) {
  const std::string good_text = gltf({});
  EXPECT_EQ(good(good_text).indices.size(), 6u);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good_text;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  expect_refusal(with(R"("POSITION":0)", R"("POSITION":2)"),
                 "attributes.POSITION is 2, but there are only 2 accessors");
  expect_refusal(with(R"("indices":1)", R"("indices":-1)"), "indices has to be a whole number");
  expect_refusal(with(R"("indices":1)", R"("indices":"1")"), "indices has to be a whole number");
  expect_refusal(with(R"("indices":1)", R"("indices":4294967297)"), "is 4294967297");
  expect_refusal(with(R"("indices":1)", R"("indices":1e300)"), "has to be a whole number");
  EXPECT_EQ(good(with(R"("indices":1)", R"("indices":1.0)")).indices.size(), 6u);
  expect_refusal(with(R"("bufferView":1)", R"("bufferView":7)"), "accessors[1].bufferView is 7");
  expect_refusal(with(R"("buffer":0)", R"("buffer":1)"), "bufferViews[0].buffer is 1");
  expect_refusal(with(R"("count":6)", R"("count":9007199254740992)"), "ends at byte");
  expect_refusal(with(R"("count":6)", R"("count":null)"), "accessors[1].count");
  expect_refusal(with(R"("count":6,)", ""), "accessors[1].count is missing");
  expect_refusal(with(R"("componentType":5121)", R"("componentType":5124)"), "is 5124");
  expect_refusal(with(R"("type":"SCALAR")", R"("type":3)"), "accessors[1].type has to be a string");
  expect_refusal(with(R"("version":"2.0")", R"("version":"1.0")"), "only glTF 2");
  expect_refusal(with(R"("asset":{"version":"2.0"})", R"("asset":[])"),
                 "asset has to be an object");
  expect_refusal(with(R"("byteLength":66)", R"("byteLength":67)"), "buffers[0] has 66 bytes");
  expect_refusal(with("base64,", "base64,*"), "not valid base64");
  expect_refusal(with(";base64,", ","), "not base64");
  expect_refusal(with(R"("meshes":[)", R"("meshes":[0,)"), "meshes[0] has to be an object");
  expect_refusal(with(R"("bufferViews":[)", R"("bufferViews":{"a":[)"), "not valid JSON");
  expect_refusal(good_text.substr(0, good_text.size() - 1), "truncated");
  expect_refusal(with(R"("count":6)", R"("count":1e999)"), "number");
}

TEST(Gltf, RefusesCompressedGeometry) {
  Parts parts;
  parts.more = R"(,"extensionsRequired":["KHR_materials_unlit","KHR_draco_mesh_compression"])";
  expect_refusal(gltf(parts), "has KHR_draco_mesh_compression: compressed geometry");
  parts.more = R"(,"extensionsRequired":["EXT_meshopt_compression"])";
  expect_refusal(gltf(parts), "EXT_meshopt_compression");
  // Not required: the plain accessors are used where they have data.
  parts.more = "";
  parts.primitive += R"(,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0}})";
  EXPECT_EQ(good(gltf(parts)).indices.size(), 6u);
  parts.accessors = R"({"componentType":5126,"count":5,"type":"VEC3"},)" + kIndices;
  expect_refusal(gltf(parts), "compressed by KHR_draco_mesh_compression");
}

TEST(Gltf, RefusesDeepNestingWithoutRecursion) {
  Parts parts;
  parts.more = R"(,"extras":)" + std::string(100000, '[') + std::string(100000, ']');
  expect_refusal(gltf(parts), "nested over 100 deep");
  parts.more = R"(,"extras":"[[[[)" + std::string(1000, '{') + "\\\"[\"";
  EXPECT_EQ(good(gltf(parts)).indices.size(), 6u);
}

TEST(Gltf, TakesAGlbApart) {
  const test::TriangleMesh two = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, {0, 1, 2, 2, 1, 0}};
  const std::string glb = test::write_glb(two);
  EXPECT_EQ(good(glb).indices, two.indices);
  const auto with = [&](std::size_t at, std::uint32_t value) {
    std::string bytes;
    append(bytes, value);
    return std::string(glb).replace(at, 4, bytes);
  };
  const auto size = static_cast<std::uint32_t>(glb.size());
  expect_refusal(with(4, 1), "GLB version 1");
  expect_refusal(with(8, size + 1), "byte 8: the header says");
  expect_refusal(with(8, 19), "byte 8: the header says");
  expect_refusal(with(12, size), "byte 12: a chunk of");
  expect_refusal(with(12, 0xffffffff), "byte 12: a chunk of");
  expect_refusal(with(16, 0), "first chunk of a GLB has to be JSON");
  expect_refusal(glb.substr(0, 19), "GLB header");
  expect_refusal(glb.substr(0, glb.size() - 1), "truncated");
  EXPECT_EQ(good(glb + "behind").indices, two.indices);  // the header's length counts

  // Without its binary chunk, and with a second buffer that has no source.
  const std::uint32_t json =
      20 + static_cast<unsigned char>(glb[12]) + 256u * static_cast<unsigned char>(glb[13]);
  std::string no_binary = glb.substr(0, json);
  std::string length;
  append(length, json);
  expect_refusal(no_binary.replace(8, 4, length), "no binary chunk");
  // An unknown chunk before the binary one is skipped.
  std::string chunk("\4\0\0\0WHATabcd", 12);
  std::string more = std::string(glb).insert(json, chunk);
  length.clear();
  append(length, size + 12);
  EXPECT_EQ(good(more.replace(8, 4, length)).indices, two.indices);
}

TEST(Gltf, KeepsToTheMemoryLimit) {
  LoadSettings settings;
  const std::string text = gltf({});
  // The decoded buffer counts, and so does the mesh.
  const std::uint64_t decoded = 88 / 4 * 3 + 2;
  settings.memory_limit_bytes = std::max<std::uint64_t>(decoded + 5 * 12 + 6 * 4, text.size());
  EXPECT_EQ(good(text, settings).indices.size(), 6u);
  settings.memory_limit_bytes = text.size() - 1;
  expect_refusal(text, "JSON alone", settings, StatusCode::resource_limit);

  // A hundred instances of one mesh: counted before the memory is there.
  Parts parts;
  parts.more = R"(,"nodes":[{"mesh":0})";
  for (int i = 1; i < 100; ++i) parts.more += R"(,{"mesh":0})";
  parts.more += "]";
  const std::string many = gltf(parts);
  settings.memory_limit_bytes = decoded + 100 * (5 * 12 + 6 * 4);
  EXPECT_EQ(good(many, settings).indices.size(), 600u);
  --settings.memory_limit_bytes;
  expect_refusal(many, "the mesh would take 8400 bytes", settings, StatusCode::resource_limit);
}

TEST(Gltf, AnEmptyMeshIsAMesh) {
  EXPECT_EQ(good(R"({"asset":{"version":"2.0"}})").view().triangle_count, 0u);
}

TEST(Gltf, CanBeCancelled) {
  LoadSettings settings;
  settings.progress = [](const char*, double) { return false; };
  expect_refusal(gltf({}), "cancelled", settings, StatusCode::cancelled);
}

}  // namespace
}  // namespace fasttree::scene
