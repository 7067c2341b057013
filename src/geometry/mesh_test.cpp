// SPDX-License-Identifier: Apache-2.0
#include "fasttree/mesh.h"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/support/meshes.h"

namespace fasttree {
namespace {

TEST(Mesh, ReadsPositionsWithAnyStrideAndAlignment) {
  std::vector<unsigned char> bytes(1 + 3 * 20);
  for (int i = 0; i < 3; ++i) {
    const float p[3] = {1.0f * i, 2.0f * i, 3.0f * i};
    std::memcpy(&bytes[1 + 20 * static_cast<std::size_t>(i)], p, sizeof p);
  }
  MeshView mesh;
  mesh.positions = &bytes[1];
  mesh.position_stride_bytes = 20;
  mesh.vertex_count = 3;
  mesh.triangle_count = 1;
  ASSERT_TRUE(validate(mesh).ok());
  EXPECT_EQ(mesh.triangle(0)[2], (Vec3{2, 4, 6}));
}

TEST(Mesh, NamesTheTriangleWithABadIndex) {
  test::OwnedMesh owned = test::sheet(2, 0);
  owned.indices[10] = 9;
  const Status status = validate(owned.view());
  EXPECT_EQ(status.code(), StatusCode::bad_input);
  EXPECT_NE(status.message().find("triangle 3 uses vertex 9"), std::string::npos)
      << status.message();
}

TEST(Mesh, RefusesWhatCannotBe) {
  MeshView none;
  EXPECT_TRUE(validate(none).ok()) << "an empty mesh is valid";
  MeshView no_positions;
  no_positions.triangle_count = 1;
  no_positions.vertex_count = 3;
  EXPECT_EQ(validate(no_positions).code(), StatusCode::invalid_argument);

  const test::OwnedMesh owned = test::soup(2, 1, 1);
  MeshView mesh = owned.view();
  mesh.position_stride_bytes = 8;
  EXPECT_EQ(validate(mesh).code(), StatusCode::invalid_argument);
  mesh = owned.view();
  mesh.triangle_count = 3;
  EXPECT_EQ(validate(mesh).code(), StatusCode::invalid_argument);
  mesh = owned.view();
  mesh.triangle_count = kMaxTriangles + 1;
  EXPECT_EQ(validate(mesh).code(), StatusCode::resource_limit);
}

}  // namespace
}  // namespace fasttree
