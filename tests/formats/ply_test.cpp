// SPDX-License-Identifier: Apache-2.0
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

const std::string kVertices =
    "element vertex 4\nproperty float x\nproperty float y\n"
    "property float z\n";
const std::string kPositions = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

std::string ascii(const std::string& elements, const std::string& body) {
  return "ply\nformat ascii 1.0\n" + elements + "end_header\n" + body;
}

std::string faces(int count) {
  return "element face " + std::to_string(count) + "\nproperty list uchar int vertex_indices\n";
}

Mesh good(const std::string& text, const LoadSettings& settings = {}) {
  Result<Mesh> mesh = parse_ply(source_of(text), settings);
  EXPECT_TRUE(mesh.ok()) << mesh.status().message();
  return mesh.ok() ? std::move(mesh).value() : Mesh();
}

// The message of the refusal, which has to have this code.
std::string refusal(const std::string& text, StatusCode code = StatusCode::bad_input,
                    const LoadSettings& settings = {}) {
  const Result<Mesh> mesh = parse_ply(source_of(text), settings);
  EXPECT_EQ(mesh.status().code(), code) << mesh.status().message();
  return mesh.status().message();
}

void expect_has(const std::string& message, const std::string& part) {
  EXPECT_NE(message.find(part), std::string::npos) << message;
}

TEST(Ply, CutsPolygonsIntoFansInFileOrder) {
  const Mesh mesh =
      good(ascii(kVertices + faces(4), kPositions + "4 0 1 2 3\n2 0 1\n0\n3 3 2 1\n"));
  EXPECT_EQ(mesh.indices, (Indices{0, 1, 2, 0, 2, 3, 3, 2, 1}));
  EXPECT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.positions[2], (Vec3{1, 1, 0}));
  EXPECT_EQ(mesh.view().triangle_count, 3u);
}

TEST(Ply, UnrollsTriangleStrips) {
  const std::string strips = "element tristrips 2\nproperty list int int vertex_indices\n";
  const Mesh mesh =
      good(ascii(kVertices + strips, kPositions + "10 0 1 2 3 0 -1 3 2 1 0\n3 1 2 3\n"));
  EXPECT_EQ(mesh.indices, (Indices{0, 1, 2, 2, 1, 3, 2, 3, 0, 3, 2, 1, 1, 2, 0, 1, 2, 3}));
}

TEST(Ply, TakesFacesAndStripsInTheOrderOfTheElements) {
  const std::string elements =
      "element tristrips 1\nproperty list int int vertex_index\n" + faces(1) + kVertices;
  const Mesh mesh = good(ascii(elements, "3 3 2 1\n3 0 1 2\n" + kPositions));
  EXPECT_EQ(mesh.indices, (Indices{3, 2, 1, 0, 1, 2}));
  EXPECT_EQ(mesh.positions[3], (Vec3{0, 1, 0}));
}

TEST(Ply, SkipsWhatItDoesNotNeed) {
  const std::string elements =
      "comment a\nobj_info b\nelement camera 1\nproperty list uchar float pose\n"
      "element nothing 3\nelement vertex 3\nproperty uchar red\nproperty list uchar int tags\n"
      "property float z\nproperty float x\nproperty float y\nelement face 1\n"
      "property float w\nproperty list uchar int vertex_index\nproperty list uchar float uv\n"
      "element tail 1\nproperty int t\n";
  const Mesh mesh =
      good(ascii(elements, "2 1 2\n9 1 5 3 1 2\n9 0 3 4 5\n\n9 2 1 1 3 7 8\n1 3 2 1 0 1 .5\n4\n"));
  EXPECT_EQ(mesh.positions, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 3}, {7, 8, 3}}));
  EXPECT_EQ(mesh.indices, (Indices{2, 1, 0}));
}

// Every scalar type, under both of its names, as a coordinate and as an index, in all encodings.
struct TypeCase {
  const char* name;
  const char* other_name;
  void (*append)(std::string& out, int value, bool big_endian);
  bool is_integer;
};
template <typename T>
void append_as(std::string& out, int value, bool big_endian) {
  append(out, static_cast<T>(value), big_endian);
}
const TypeCase kTypes[] = {
    {"char", "int8", &append_as<std::int8_t>, true},
    {"uchar", "uint8", &append_as<std::uint8_t>, true},
    {"short", "int16", &append_as<std::int16_t>, true},
    {"ushort", "uint16", &append_as<std::uint16_t>, true},
    {"int", "int32", &append_as<std::int32_t>, true},
    {"uint", "uint32", &append_as<std::uint32_t>, true},
    {"float", "float32", &append_as<float>, false},
    {"double", "float64", &append_as<double>, false},
};

TEST(Ply, KnowsEveryScalarTypeInEveryEncoding) {
  for (const TypeCase& type : kTypes) {
    for (const bool other_name : {false, true}) {
      const std::string name = other_name ? type.other_name : type.name;
      const std::string index_type = type.is_integer ? name : "int";
      const std::string elements = "element vertex 3\nproperty " + name + " x\nproperty " + name +
                                   " y\nproperty " + name + " z\nelement face 1\nproperty list " +
                                   index_type + " " + index_type + " vertex_indices\nend_header\n";
      const auto append_index = type.is_integer ? type.append : &append_as<std::int32_t>;
      for (const std::string encoding : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        std::string text = "ply\nformat " + encoding + " 1.0\n" + elements;
        if (encoding == "ascii") {
          text += "1 2 3\n4 5 6\n7 8 9\n3 2 0 1\n";
        } else {
          const bool big = encoding == "binary_big_endian";
          for (int value = 1; value <= 9; ++value) type.append(text, value, big);
          for (const int value : {3, 2, 0, 1}) append_index(text, value, big);
        }
        SCOPED_TRACE(name + " " + encoding);
        const Mesh mesh = good(text);
        EXPECT_EQ(mesh.positions, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}));
        EXPECT_EQ(mesh.indices, (Indices{2, 0, 1}));
      }
    }
  }
}

TEST(Ply, ReadsSignedNumbersAndTheStripEndOfUnsignedOnes) {
  std::string text =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty short x\n"
      "property char y\nproperty int z\nelement tristrips 1\n"
      "property list uchar uint vertex_indices\nend_header\n";
  for (int v = 0; v < 3; ++v) {
    append(text, std::int16_t{-2});
    append(text, std::int8_t{-3});
    append(text, std::int32_t{-4});
  }
  text += '\7';
  for (const std::uint32_t i : {0u, 1u, 2u, 0xffffffffu, 2u, 1u, 0u}) append(text, i);
  const Mesh mesh = good(text);
  EXPECT_EQ(mesh.positions[0], (Vec3{-2, -3, -4}));
  EXPECT_EQ(mesh.indices, (Indices{0, 1, 2, 2, 1, 0}));
}

TEST(Ply, ViewsPositionsInPlaceInAMapping) {
  std::string text =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty uchar red\n"
      "property float x\nproperty float y\nproperty float z\nproperty short w\n"
      "element face 1\nproperty list uchar uchar vertex_indices\nend_header\n";
  const std::size_t body = text.size();
  for (int v = 0; v < 3; ++v) {
    text += 'r';
    for (int axis = 0; axis < 3; ++axis) append(text, static_cast<float>(10 * v + axis));
    append(text, std::int16_t{7});
  }
  text += std::string("\3\2\1\0", 4);

  Source source = source_of(text);
  source.mapping = std::make_shared<int>(0);
  const Result<Mesh> in_place = parse_ply(source);
  ASSERT_TRUE(in_place.ok()) << in_place.status().message();
  EXPECT_TRUE(in_place.value().positions.empty());
  EXPECT_EQ(in_place.value().mapped_positions, text.data() + body + 1);
  EXPECT_EQ(in_place.value().mapped_stride_bytes, 15u);
  EXPECT_EQ(in_place.value().mapping, source.mapping);
  const Mesh copied = good(text);
  EXPECT_EQ(copied.mapped_positions, nullptr);
  EXPECT_TRUE(test::same_bits(test::corners_of(in_place.value()), test::corners_of(copied)));
  EXPECT_EQ(copied.positions[2], (Vec3{20, 21, 22}));
}

TEST(Ply, CopiesPositionsThatCannotBeViewed) {
  for (const std::string properties :
       {"property float x\nproperty float z\nproperty float y\n",
        "property float x\nproperty float y\nproperty float q\nproperty float z\n",
        "property double x\nproperty double y\nproperty double z\n",
        "property float x\nproperty float y\nproperty float z\nproperty list uchar int t\n"}) {
    std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" + properties +
                       faces(0) + "end_header\n";
    text.append(properties.find("double") != std::string::npos ? 24
                : properties.find(" q") != std::string::npos   ? 16
                : properties.find("list") != std::string::npos ? 13
                                                               : 12,
                '\0');
    Source source = source_of(text);
    source.mapping = std::make_shared<int>(0);
    const Result<Mesh> mesh = parse_ply(source);
    ASSERT_TRUE(mesh.ok()) << mesh.status().message();
    EXPECT_EQ(mesh.value().mapped_positions, nullptr) << properties;
    EXPECT_EQ(mesh.value().positions.size(), 1u);
  }
}

TEST(Ply, EndsHeaderLinesInCrLfOrCr) {
  for (const std::string end : {"\r\n", "\r"}) {
    std::string text;
    for (const char c : ascii(kVertices + faces(1), kPositions + "3 0 1 2")) {
      text += c == '\n' ? end : std::string(1, c);
    }
    EXPECT_EQ(good(text).indices, (Indices{0, 1, 2}));
  }
  // A binary body whose first byte is a line feed, after a header in CR.
  std::string text =
      "ply\rformat binary_little_endian 1.0\relement vertex 1\rproperty uchar x\r"
      "property uchar y\rproperty uchar z\relement face 0\rend_header\r\n\n\n";
  EXPECT_EQ(good(text).positions[0], (Vec3{10, 10, 10}));
}

TEST(Ply, AnEmptyMeshIsAMesh) {
  const Mesh mesh =
      good(ascii("element vertex 0\nproperty float x\nproperty float y\n"
                 "property float z\n" +
                     faces(0),
                 ""));
  EXPECT_EQ(mesh.view().triangle_count, 0u);
  EXPECT_EQ(mesh.view().vertex_count, 0u);
  EXPECT_EQ(good(ascii(kVertices + faces(0), kPositions)).view().vertex_count, 4u);
}

TEST(Ply, LeavesOddCoordinatesToTheBuilder) {
  const Mesh mesh =
      good(ascii(kVertices + faces(1), "nan 0 0\n-inf 0 0\n1e99 0 0\n0 0 0\n3 0 1 2\n"));
  EXPECT_TRUE(std::isnan(mesh.positions[0].x));
  EXPECT_EQ(mesh.positions[1].x, -INFINITY);
  EXPECT_EQ(mesh.positions[2].x, INFINITY);
}

TEST(Ply, SaysWhereAHeaderIsWrong) {
  expect_has(refusal("plx\n"), "test, line 1: ");
  expect_has(refusal("ply\nformat ascii 2.0\nend_header\n"), "test, line 2: ");
  expect_has(refusal("ply\nformat morse 1.0\nend_header\n"), "'morse'");
  expect_has(refusal("ply\nelement vertex 0\nend_header\n"), "no 'format'");
  expect_has(refusal("ply\nformat ascii 1.0\nformat ascii 1.0\n"), "second 'format'");
  expect_has(refusal(ascii("elephant vertex 3\n", "")), "'elephant'");
  expect_has(refusal(ascii("element vertex -3\n", "")), "'-3'");
  expect_has(refusal(ascii("element vertex 18446744073709551616\n", "")), "count");
  expect_has(refusal(ascii("element vertex\n", "")), "element NAME COUNT");
  expect_has(refusal(ascii("property float x\n", "")), "before the first element");
  expect_has(refusal(ascii("element vertex 1\nproperty quad x\n", "")), "'quad'");
  expect_has(refusal(ascii("element vertex 1\nproperty float\n", "")), "property TYPE NAME");
  expect_has(refusal(ascii("element face 1\nproperty list float int i\n", "")), "integer type");
  expect_has(refusal(ascii(faces(0) + faces(0), "")), "second element 'face'");
  expect_has(refusal(ascii(faces(0), "")), "no element 'vertex'");
  expect_has(refusal(ascii(kVertices, kPositions)), "point cloud");
  expect_has(refusal(ascii("element vertex 0\nproperty float x\nproperty list int float y\n"
                           "property float z\n" +
                               faces(0),
                           "")),
             "no number 'y'");
  expect_has(refusal(ascii(kVertices + "element face 1\nproperty int a\n", kPositions + "1\n")),
             "no list of integers");
  expect_has(refusal("ply\nformat ascii 1.0\nelement vertex 0"), "truncated");
}

TEST(Ply, SaysWhereABodyIsWrong) {
  expect_has(refusal(ascii(kVertices + faces(1), kPositions + "3 0 1 4\n")), "test, line 14: ");
  expect_has(refusal(ascii(kVertices + faces(1), kPositions + "3 0 1 4\n")), "vertex 4");
  expect_has(refusal(ascii(kVertices + faces(1), kPositions + "3 0 1 -1\n")), "vertex -1");
  expect_has(refusal(ascii(kVertices + faces(1), "0 0 0\n1 x 0\n1 1 0\n0 1 0\n3 0 1 2\n")), "'x'");
  expect_has(refusal(ascii(kVertices + faces(1), kPositions + "3 0 1\n")), "ends too early");
  expect_has(refusal(ascii(kVertices + faces(1), kPositions + "3 0 1 2 3\n")), "from '3' on");
  expect_has(refusal(ascii(kVertices + faces(1), kPositions + "-3 0 1 2\n")), "list of -3");
  expect_has(refusal(ascii(kVertices + faces(1), kPositions + "3 0 1 2.5\n")), "'2.5'");
  expect_has(refusal(ascii(kVertices + faces(2), kPositions + "3 0 1 2\n")), "is missing");
  expect_has(refusal(ascii(kVertices + faces(1), kPositions + "3 0 1 2\n3 0 1 2\n")),
             "more data follows");
  expect_has(refusal(ascii(kVertices + faces(1), kPositions + "4000000000 0 1 2\n")), "too early");
  std::string binary = "ply\nformat binary_little_endian 1.0\n" + kVertices + faces(1) +
                       "end_header\n" + std::string(48, '\0');
  const std::size_t face_at = binary.size();
  append(binary, std::uint8_t{3});
  for (const std::int32_t i : {0, 1, 5}) append(binary, i);
  expect_has(refusal(binary),
             "test, byte " + std::to_string(face_at + 13) + ": row 0 of element 'face'");
}

TEST(Ply, RefusesCountsThatTheFileCannotHold) {
  const std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex ";
  const std::string xyz = "\nproperty float x\nproperty float y\nproperty float z\n";
  for (const char* count : {"2", "4294967295", "4294967296", "18446744073709551615"}) {
    expect_has(refusal(header + count + xyz + faces(0) + "end_header\n" + std::string(12, '\0')),
               "truncated");
  }
  std::string list = header + "0" + xyz +
                     "element face 1\nproperty list uint int vertex_indices\n"
                     "end_header\n";
  append(list, std::uint32_t{0xffffffff});
  expect_has(refusal(list), "17179869180 more bytes");
}

TEST(Ply, KeepsToTheMemoryLimit) {
  const std::string text = ascii(kVertices + faces(1), kPositions + "3 0 1 2\n");
  LoadSettings settings;
  settings.memory_limit_bytes = 4 * 12 + 12;
  EXPECT_EQ(good(text, settings).indices.size(), 3u);
  --settings.memory_limit_bytes;
  expect_has(refusal(text, StatusCode::resource_limit, settings), "limit");
}

TEST(Ply, CanBeCancelled) {
  const std::string text = ascii(kVertices + faces(1), kPositions + "3 0 1 2\n");
  LoadSettings settings;
  int calls = 0;
  for (int last = 0;; ++last) {
    calls = 0;
    settings.progress = [&](const char*, double fraction) {
      EXPECT_GE(fraction, 0.0);
      EXPECT_LE(fraction, 1.0);
      return calls++ < last;
    };
    const Result<Mesh> mesh = parse_ply(source_of(text), settings);
    if (mesh.ok()) break;
    EXPECT_EQ(mesh.status().code(), StatusCode::cancelled);
  }
  EXPECT_GE(calls, 2);
}

}  // namespace
}  // namespace fasttree::scene
