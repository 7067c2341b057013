// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "scene/formats/formats.h"
#include "tests/formats/mesh_writers.h"

namespace fasttree::scene {
namespace {

using test::source_of;

const test::TriangleMesh kTwo = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {0, 1, 2, 0, 2, 3}};

Mesh good(const std::string& text, const LoadSettings& settings = {}) {
  Result<Mesh> mesh = parse_stl(source_of(text), settings);
  EXPECT_TRUE(mesh.ok()) << mesh.status().message();
  return mesh.ok() ? std::move(mesh).value() : Mesh();
}

void expect_refusal(const std::string& text, const std::string& part) {
  const Result<Mesh> mesh = parse_stl(source_of(text));
  EXPECT_EQ(mesh.status().code(), StatusCode::bad_input) << text;
  EXPECT_NE(mesh.status().message().find(part), std::string::npos) << mesh.status().message();
}

std::string facet(const std::string& vertices) {
  return "solid\nfacet normal 0 0 0\nouter loop\n" + vertices + "endloop\nendfacet\nendsolid\n";
}

TEST(Stl, ReadsBinaryWhateverItsHeaderSays) {
  for (const char* header : {"", "anything", "solid", "solid but binary"}) {
    const Mesh mesh = good(test::write_stl_binary(kTwo, header));
    EXPECT_TRUE(test::same_bits(test::corners_of(mesh), test::corners_of(kTwo))) << header;
    EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5}));
  }
}

TEST(Stl, ReadsAscii) {
  const Mesh mesh = good(test::write_stl_ascii(kTwo));
  EXPECT_TRUE(test::same_bits(test::corners_of(mesh), test::corners_of(kTwo)));
}

TEST(Stl, ReadsSeveralSolidsInAnyCaseWithOddNormals) {
  const std::string text =
      "\r\n  SOLID facet vertex\r\nFacet Normal nan nan nan\r\nOuter Loop\r\nVertex +1 2e0 3\r\n"
      "vertex 4 5 6\r\nvertex 7 8 9\r\nEndLoop\r\nEndFacet\r\nEndSolid x\r\nsolid two\r\n"
      "facet\r\nouter loop\r\nvertex 0 0 0\r\nvertex 0 0 1\r\nvertex 0 1 0\r\nendloop\r\n"
      "endfacet\r\nendsolid";
  const Mesh mesh = good(text);
  EXPECT_EQ(mesh.positions,
            (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {0, 0, 0}, {0, 0, 1}, {0, 1, 0}}));
}

TEST(Stl, AnEmptyMeshIsAMesh) {
  EXPECT_EQ(good("solid\nendsolid\n").view().triangle_count, 0u);
  EXPECT_EQ(good(test::write_stl_binary({}, "")).view().triangle_count, 0u);
}

TEST(Stl, ToleratesAFewBytesAfterABinaryMesh) {
  const std::string text = test::write_stl_binary(kTwo, "x");
  EXPECT_EQ(good(text + "tail").view().triangle_count, 2u);
  expect_refusal(text + std::string(50, 'x'), "holds 3");
}

TEST(Stl, SaysWhereBinaryIsWrong) {
  std::string text = test::write_stl_binary(kTwo, "x");
  text.pop_back();
  expect_refusal(text, "test, byte 80: the file says 2 triangles of 50 bytes, but has room for 1");
  expect_refusal("", "84 bytes");
  expect_refusal("hello", "byte 5");
}

TEST(Stl, SaysWhereAsciiIsWrong) {
  const std::string three = "vertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\n";
  EXPECT_EQ(good(facet(three)).view().triangle_count, 1u);
  expect_refusal(facet("vertex 0 0 0\nvertex 1 0 0\n"),
                 "line 6: found 'endloop' instead of 'vertex'");
  expect_refusal(facet(three + "vertex 0 1 0\n"), "instead of 'endloop'");
  expect_refusal(facet("vertex 0 0\n" + three), "line 4: a vertex needs three numbers");
  expect_refusal(facet("vertex 0 0 zero\n" + three), "'zero' instead of a number");
  expect_refusal(facet("vertex 0 0 0 0\n" + three), "instead of the end of the line");
  expect_refusal("solid\nfacet\nouter\n", "instead of 'loop'");
  expect_refusal("solid\n", "truncated");
  expect_refusal("solid\nfacet normal 0 0 0\n", "where 'outer' has to follow");
  expect_refusal("solid\nfact\n", "'facet' or 'endsolid'");
  expect_refusal("solid\nendsolid\nfacet\n", "instead of 'solid'");
}

TEST(Stl, KeepsToTheMemoryLimit) {
  for (const std::string& text : {test::write_stl_binary(kTwo, "x"), test::write_stl_ascii(kTwo)}) {
    LoadSettings settings;
    settings.memory_limit_bytes = 2 * (3 * 12 + 12);
    EXPECT_EQ(good(text, settings).view().triangle_count, 2u);
    --settings.memory_limit_bytes;
    EXPECT_EQ(parse_stl(source_of(text), settings).status().code(), StatusCode::resource_limit);
  }
}

TEST(Stl, CanBeCancelled) {
  LoadSettings settings;
  settings.progress = [](const char*, double) { return false; };
  for (const std::string& text : {test::write_stl_binary(kTwo, "x"), test::write_stl_ascii(kTwo)}) {
    EXPECT_EQ(parse_stl(source_of(text), settings).status().code(), StatusCode::cancelled);
  }
}

}  // namespace
}  // namespace fasttree::scene
