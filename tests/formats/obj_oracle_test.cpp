// SPDX-License-Identifier: Apache-2.0
// Generated OBJ files against tinyobjloader: the same polygons and, as near as its own number
// parser comes, the same positions.
#define TINYOBJLOADER_IMPLEMENTATION
#include <gtest/gtest.h>
#include <tiny_obj_loader.h>

#include <cstdint>
#include <cstdio>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "scene/formats/formats.h"
#include "tests/formats/mesh_writers.h"

namespace fasttree::scene {
namespace {

std::string random_obj(std::mt19937& random) {
  // Texture coordinate and normal 1 have to exist for tinyobjloader.
  std::string text = "# generated\nvt 0 0\nvn 0 0 1\n";
  int vertices = 0;
  for (int row = 0; row < 200; ++row) {
    const auto pick = random() % 10;
    if (vertices < 3 || pick < 4) {
      char line[96];
      const auto number = [&] {
        return static_cast<double>(static_cast<int>(random() % 20001) - 10000) / 64;
      };
      std::snprintf(line, sizeof line, pick % 2 == 0 ? "v %.6f %.6f %.6f\n" : "v\t%g  %g %g \r\n",
                    number(), number(), number());
      text += line;
      ++vertices;
    } else if (pick < 8) {
      text += "f";
      for (std::uint32_t corner = 0, corners = 3 + random() % 5; corner < corners; ++corner) {
        const int index = static_cast<int>(random() % static_cast<std::uint32_t>(vertices));
        text += ' ';
        text += std::to_string(random() % 2 == 0 ? index + 1 : index - vertices);
        if (pick == 5) text += "/1";
        if (pick == 6) text += "//1";
        if (pick == 7) text += "/1/1";
      }
      text += "\n";
    } else {
      text += pick == 8 ? "vt 0 0\nvn 0 0 1\n" : "g group\ns 1\n# remark\n\n";
    }
  }
  return text;
}

TEST(ObjOracle, AgreesWithTinyobjloader) {
  std::mt19937 random(20);
  for (int file = 0; file < 200; ++file) {
    const std::string text = random_obj(random);
    tinyobj::attrib_t attributes;
    std::vector<tinyobj::shape_t> shapes;
    std::vector<tinyobj::material_t> materials;
    std::string warning;
    std::string error;
    std::istringstream in(text);
    ASSERT_TRUE(tinyobj::LoadObj(&attributes, &shapes, &materials, &warning, &error, &in, nullptr,
                                 /*triangulate=*/false))
        << error;
    std::vector<std::uint32_t> expected;
    for (const tinyobj::shape_t& shape : shapes) {
      std::size_t first = 0;
      for (const std::size_t corners : shape.mesh.num_face_vertices) {
        for (std::size_t c = 2; c < corners; ++c) {
          for (const std::size_t corner : {std::size_t{0}, c - 1, c}) {
            expected.push_back(
                static_cast<std::uint32_t>(shape.mesh.indices[first + corner].vertex_index));
          }
        }
        first += corners;
      }
    }

    const Result<Mesh> mesh = parse_obj(test::source_of(text));
    ASSERT_TRUE(mesh.ok()) << mesh.status().message();
    ASSERT_EQ(mesh.value().indices, expected);
    ASSERT_EQ(mesh.value().positions.size() * 3, attributes.vertices.size());
    for (std::size_t i = 0; i < attributes.vertices.size(); ++i) {
      ASSERT_NEAR(mesh.value().positions[i / 3][i % 3], attributes.vertices[i], 1e-4);
    }
  }
}

}  // namespace
}  // namespace fasttree::scene
