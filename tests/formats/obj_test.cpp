// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "scene/formats/formats.h"
#include "tests/formats/mesh_writers.h"

namespace fasttree::scene {
namespace {

using test::source_of;
using Indices = std::vector<std::uint32_t>;

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

Mesh good(const std::string& text, const LoadSettings& settings = {}) {
  Result<Mesh> mesh = parse_obj(source_of(text), settings);
  EXPECT_TRUE(mesh.ok()) << mesh.status().message();
  return mesh.ok() ? std::move(mesh).value() : Mesh();
}

void expect_refusal(const std::string& text, const std::string& part) {
  const Result<Mesh> mesh = parse_obj(source_of(text));
  EXPECT_EQ(mesh.status().code(), StatusCode::bad_input) << text;
  EXPECT_NE(mesh.status().message().find(part), std::string::npos) << mesh.status().message();
}

TEST(Obj, CutsPolygonsIntoFansInFileOrder) {
  EXPECT_EQ(good(kSquare + "f 1 2 3 4\nf 4 3 2\n").indices, (Indices{0, 1, 2, 0, 2, 3, 3, 2, 1}));
}

TEST(Obj, KnowsAllFormsOfACorner) {
  EXPECT_EQ(good(kSquare + "f 1/7 2//8 3/7/8\nf 4/-1/-2 +3/ 2//\n").indices,
            (Indices{0, 1, 2, 3, 2, 1}));
}

TEST(Obj, CountsNegativeIndicesBackFromTheirLine) {
  EXPECT_EQ(good("v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 9 9 9\nf -1 -4 -2\n").indices,
            (Indices{0, 1, 2, 3, 0, 2}));
}

TEST(Obj, TakesVerticesThatFollowTheirFace) {
  EXPECT_EQ(good("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 1 1 0\n").indices, (Indices{0, 1, 2}));
}

TEST(Obj, ContinuesLinesAndSkipsWhatItDoesNotNeed) {
  const Mesh mesh = good(
      "# comment \\\nmtllib a b.mtl\r\nv 0 0 \\\n 0\nv 1 0 0 0.5 0.5 0.5\n"
      "\tv\t1 1 0 1.0 # weight\n vt 0 0\nvn 0 0 1\ng a b\ns off\nusemtl x\n"
      "my_extension 1 2\nl 1 2\np 1\nf 1 2\\\n3\nf 1 2\nf 1\nf\n");
  EXPECT_EQ(mesh.indices, (Indices{0, 1, 2}));
  EXPECT_EQ(mesh.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}));
}

TEST(Obj, AnEmptyMeshIsAMesh) {
  EXPECT_EQ(good("").view().triangle_count, 0u);
  EXPECT_EQ(good("# nothing\n").view().triangle_count, 0u);
  EXPECT_EQ(good(kSquare).view().vertex_count, 4u);
}

TEST(Obj, SaysWhereItIsWrong) {
  expect_refusal(kSquare + "f 1 2 5\n", "test, line 5: a face names vertex 5");
  expect_refusal(kSquare + "f 1 2 0\n", "vertex 0");
  expect_refusal(kSquare + "f 1 2 -5\n", "vertex -5");
  expect_refusal("v 0 0 0\nf -2 1 1\nv 0 0 0\n", "-1 to -1");
  expect_refusal(kSquare + "f 1 2 x\n", "'x'");
  expect_refusal(kSquare + "f 1 2 3/x\n", "'3/x'");
  expect_refusal(kSquare + "f 1 2 3/1/1/1\n", "'3/1/1/1'");
  expect_refusal(kSquare + "f 1 2 /1\n", "'/1'");
  expect_refusal(kSquare + "f 1 2 3.0\n", "'3.0'");
  expect_refusal(kSquare + "f 1 2 99999999999999999999\n", "'99999999999999999999'");
  expect_refusal("v 0 0\n", "test, line 1: a vertex needs three numbers");
  expect_refusal("v 0 \\\n\\\n0 oops\n", "test, line 3: found 'oops'");
  expect_refusal("hello world\n", "no line begins with an OBJ statement");
  expect_refusal(std::string("v 0 0 0\n\0", 9), "byte 8");
}

TEST(Obj, KeepsToTheMemoryLimit) {
  LoadSettings settings;
  settings.memory_limit_bytes = 4 * 12 + 2 * 12;
  EXPECT_EQ(good(kSquare + "f 1 2 3 4\n", settings).indices.size(), 6u);
  --settings.memory_limit_bytes;
  const Result<Mesh> mesh = parse_obj(source_of(kSquare + "f 1 2 3 4\n"), settings);
  EXPECT_EQ(mesh.status().code(), StatusCode::resource_limit);
}

TEST(Obj, CanBeCancelled) {
  LoadSettings settings;
  settings.progress = [](const char*, double) { return false; };
  EXPECT_EQ(parse_obj(source_of(kSquare), settings).status().code(), StatusCode::cancelled);
}

}  // namespace
}  // namespace fasttree::scene
