// SPDX-License-Identifier: Apache-2.0
#include "reference/scene_bound.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/meshes.h"

namespace fasttree::reference {
namespace {

TEST(SceneBound, IsTheSmallestBoxRoundTheTriangles) {
  test::OwnedMesh owned = test::sheet(3, 0.5f);
  owned.positions.push_back({100, 100, NAN});  // no triangle uses it
  const Box3 bounds = scene_bound(owned.view()).value();
  Box3 expected;
  for (const std::uint32_t index : owned.indices) expected.include(owned.positions[index]);
  EXPECT_EQ(bounds, expected);
}

TEST(SceneBound, MakesMinusZeroPlusZero) {
  test::OwnedMesh owned;
  owned.add({-0.0f, -1, 0}, {-0.0f, 0, 1}, {-0.0f, -0.0f, -0.0f});
  const Box3 bounds = scene_bound(owned.view()).value();
  EXPECT_FALSE(std::signbit(bounds.lo.x));
  EXPECT_FALSE(std::signbit(bounds.hi.x));
  EXPECT_FALSE(std::signbit(bounds.hi.y));
  EXPECT_FALSE(std::signbit(bounds.lo.z));
}

TEST(SceneBound, OfNothingIsZero) {
  EXPECT_EQ(scene_bound(MeshView{}).value(), (Box3{{0, 0, 0}, {0, 0, 0}}));
}

TEST(SceneBound, NamesTheTriangleThatIsNotFinite) {
  for (const float bad : {NAN, INFINITY, -INFINITY}) {
    test::OwnedMesh owned = test::soup(10, 1, 0.1f);
    owned.positions[3 * 7 + 1].y = bad;
    const Status status = scene_bound(owned.view()).status();
    EXPECT_EQ(status.code(), StatusCode::bad_input);
    EXPECT_NE(status.message().find("triangle 7, corner 1, y"), std::string::npos)
        << status.message();
  }
}

TEST(SceneBound, RefusesAnExtentThatOverflows) {
  test::OwnedMesh owned;
  owned.add({0, -3e38f, 0}, {1, 3e38f, 0}, {0, 0, 1});
  const Status status = scene_bound(owned.view()).status();
  EXPECT_EQ(status.code(), StatusCode::bad_input);
  EXPECT_NE(status.message().find(" in y"), std::string::npos) << status.message();
}

}  // namespace
}  // namespace fasttree::reference
