// SPDX-License-Identifier: Apache-2.0
// One mesh written in every format gives the same triangles in the same order, bit for bit.
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <string>
#include <vector>

#include "scene/formats/formats.h"
#include "tests/formats/mesh_writers.h"

namespace fasttree::scene {
namespace {

using Parse = Result<Mesh> (*)(const Source&, const LoadSettings&);

TEST(RoundTrip, EveryFormatGivesTheSameTriangles) {
  const bool good = rc::check("round trip", [] {
    const auto seed = *rc::gen::arbitrary<std::uint32_t>();
    const auto vertices = *rc::gen::inRange<std::uint32_t>(1, 60);
    const auto triangles = *rc::gen::inRange<std::uint32_t>(0, 90);
    const test::TriangleMesh mesh = test::random_mesh(seed, vertices, triangles);
    const struct {
      const char* name;
      Parse parse;
      std::string text;
      bool keeps_indices;
    } files[] = {{"PLY, ascii", &parse_ply, test::write_ply_ascii(mesh), true},
                 {"PLY, little-endian", &parse_ply, test::write_ply_binary(mesh, false), true},
                 {"PLY, big-endian", &parse_ply, test::write_ply_binary(mesh, true), true},
                 {"OBJ", &parse_obj, test::write_obj(mesh), true},
                 {"STL, ascii", &parse_stl, test::write_stl_ascii(mesh), false},
                 {"STL, binary", &parse_stl, test::write_stl_binary(mesh, "solid"), false},
                 {"glTF", &parse_gltf, test::write_gltf(mesh), true},
                 {"GLB", &parse_gltf, test::write_glb(mesh), true}};
    for (const auto& file : files) {
      const Result<Mesh> read = file.parse(test::source_of(file.text), {});
      if (!read.ok()) RC_FAIL(std::string(file.name) + ": " + read.status().message());
      if (!test::same_bits(test::corners_of(read.value()), test::corners_of(mesh))) {
        RC_FAIL(std::string(file.name) + ": other triangles");
      }
      // A glTF primitive without triangles brings no vertices along.
      const bool all_vertices = file.keeps_indices && triangles > 0;
      if (file.keeps_indices) RC_ASSERT(read.value().indices == mesh.indices);
      if (all_vertices) RC_ASSERT(test::same_bits(read.value().positions, mesh.positions));
    }
  });
  ASSERT_TRUE(good);
}

}  // namespace
}  // namespace fasttree::scene
