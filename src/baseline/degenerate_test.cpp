// SPDX-License-Identifier: Apache-2.0
// Inputs that break kd-tree builders: nothing to divide, nothing to divide by, too much to divide.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "baseline/baseline.h"
#include "baseline/test_meshes.h"

namespace fasttree::baseline {
namespace {

using testing::build;
using testing::check_structure;
using testing::random_soup;
using testing::Soup;
using testing::Which;

class Degenerate : public ::testing::TestWithParam<Which> {
 protected:
  /// Builds, checks the tree's form, and returns its figures.
  Quality figures(const Soup& soup) const {
    const Result<Tree> result = build(soup, GetParam());
    EXPECT_TRUE(result.ok());
    if (!result.ok()) return {};
    check_structure(result.value(), soup, GetParam());
    const Quality quality = measure_quality(result.value());
    EXPECT_TRUE(std::isfinite(quality.sah_cost));
    return quality;
  }

  static Soup transformed(Soup soup, Vec3 scale, Vec3 offset) {
    for (Vec3& p : soup.positions) {
      for (std::size_t a = 0; a < 3; ++a) p[a] = p[a] * scale[a] + offset[a];
    }
    return soup;
  }
};

INSTANTIATE_TEST_SUITE_P(Both, Degenerate, ::testing::Values(Which::exact, Which::binned),
                         [](const auto& which) {
                           return which.param == Which::exact ? "exact" : "binned";
                         });

TEST_P(Degenerate, EmptyMesh) {
  const Result<Tree> result = build(Soup{}, GetParam());
  ASSERT_TRUE(result.ok());
  ASSERT_EQ(result.value().nodes().size(), 1u);
  EXPECT_EQ(result.value().nodes()[0], Node::leaf(0, 0));
  EXPECT_TRUE(result.value().ids().empty());
  EXPECT_EQ(result.value().info().bounds, (Box3{{0, 0, 0}, {0, 0, 0}}));
}

TEST_P(Degenerate, EmptyMeshWithEmptyBounds) {
  const MeshView mesh;
  const ProgressCallback none;
  const BaselineInput input{mesh, Box3{}, {}, 0, none};
  const Result<Tree> result =
      GetParam() == Which::exact ? build_sah_exact(input) : build_sah_binned(input);
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result.value().info().bounds, (Box3{{0, 0, 0}, {0, 0, 0}}));
}

TEST_P(Degenerate, OneTriangle) {
  Soup soup;
  soup.add({0, 0, 0}, {1, 0, 0}, {0, 1, 1});
  EXPECT_EQ(figures(soup).references, 1u);
}

TEST_P(Degenerate, IdenticalTriangles) {
  Soup soup;
  for (int i = 0; i < 3'000; ++i) soup.add({0, 0, 0}, {1, 0, 0.25f}, {0, 1, 1});
  EXPECT_EQ(figures(soup).leaves, 1u);
  // With another triangle in the scene they can be set apart from it, not from each other.
  soup.add({5, 5, 5}, {6, 5, 5}, {5, 6, 6});
  EXPECT_LE(figures(soup).references, 3u * soup.size());
}

TEST_P(Degenerate, FlatOnOneAxis) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3 scale{1, 1, 1};
    scale[axis] = 0;
    const Quality quality = figures(transformed(random_soup(500, 0.05f, 1), scale, {}));
    EXPECT_GT(quality.leaves, 100u);
    EXPECT_LT(quality.references, 3'500u);
  }
}

TEST_P(Degenerate, ALine) {
  EXPECT_EQ(figures(transformed(random_soup(500, 0.05f, 2), {1, 0, 0}, {})).leaves, 1u);
  EXPECT_EQ(figures(transformed(random_soup(500, 0.05f, 2), {0, 0, 1}, {3, 3, 3})).leaves, 1u);
}

TEST_P(Degenerate, APoint) {
  EXPECT_EQ(figures(transformed(random_soup(500, 0.05f, 3), {0, 0, 0}, {7, 8, 9})).leaves, 1u);
}

TEST_P(Degenerate, ThinSlab) {
  for (const float thickness : {1e-7f, 1e-20f, 1e-40f}) {
    const Quality quality = figures(transformed(random_soup(500, 0.05f, 4), {1, 1, thickness}, {}));
    EXPECT_GT(quality.leaves, 100u);
  }
}

TEST_P(Degenerate, FarFromTheOrigin) {
  for (const float offset : {1e4f, 1e5f, 1e6f, -1e6f}) {
    const Quality quality =
        figures(transformed(random_soup(2'000, 0.05f, 5), {1, 1, 1}, {offset, offset, offset}));
    EXPECT_GT(quality.leaves, 50u);
  }
}

TEST_P(Degenerate, SubnormalExtents) {
  for (const float size : {1e-38f, 1e-41f, 1e-44f}) {
    figures(transformed(random_soup(500, 0.05f, 6), {size, size, size}, {}));
  }
}

TEST_P(Degenerate, SubnormalExtentsKeepTheTreeOfTheUnitCube) {
  // A power of two scales everything exactly, so only an underflow could change the tree's shape.
  const Soup lattice = testing::lattice_soup(300, 16, 7);
  const float tiny = std::ldexp(1.0f, -140);
  EXPECT_EQ(figures(lattice).leaves, figures(transformed(lattice, {tiny, tiny, tiny}, {})).leaves);
}

TEST_P(Degenerate, HugeCoordinates) {
  const float huge = std::ldexp(1.0f, 127);
  Soup soup = random_soup(1'000, 0.05f, 8);
  soup = transformed(soup, {2, 2, 2}, {-1, -1, -1});
  for (Vec3& p : soup.positions) {
    for (std::size_t a = 0; a < 3; ++a) p[a] = std::clamp(p[a], -1.0f, 1.0f);
  }
  const Quality unit = figures(soup);
  const Quality scaled = figures(transformed(soup, {huge, huge, huge}, {}));
  EXPECT_EQ(unit.leaves, scaled.leaves);
}

TEST_P(Degenerate, ZeroAreaTrianglesAreKept) {
  Soup soup = random_soup(300, 0.05f, 9);
  std::mt19937 rng(9);
  std::uniform_real_distribution<float> d(0, 1);
  for (int i = 0; i < 300; ++i) {
    const Vec3 a{d(rng), d(rng), d(rng)};
    const Vec3 b{d(rng), d(rng), d(rng)};
    soup.add(a, a, a);
    soup.add(a, b, a);
  }
  figures(soup);  // check_structure asks for every id
}

TEST_P(Degenerate, AllVerticesOnPlanes) {
  // Walls of unit squares on every integer plane.
  Soup soup;
  for (int axis = 0; axis < 3; ++axis) {
    for (int plane = 0; plane <= 4; ++plane) {
      for (int i = 0; i < 16; ++i) {
        const auto corner = [&](int du, int dv) {
          Vec3 p;
          p[static_cast<std::size_t>(axis)] = static_cast<float>(plane);
          p[static_cast<std::size_t>((axis + 1) % 3)] = static_cast<float>(i % 4 + du);
          p[static_cast<std::size_t>((axis + 2) % 3)] = static_cast<float>(i / 4 + dv);
          return p;
        };
        soup.add(corner(0, 0), corner(1, 0), corner(1, 1));
        soup.add(corner(0, 0), corner(1, 1), corner(0, 1));
      }
    }
  }
  const Quality quality = figures(soup);
  EXPECT_LT(quality.references, 3u * soup.size());
}

TEST_P(Degenerate, OneTriangleAcrossManySmall) {
  Soup soup = random_soup(5'000, 0.005f, 10);
  soup.add({0, 0, 0}, {1, 1, 0}, {0.5f, 0.5f, 1});
  figures(soup);
}

TEST_P(Degenerate, DenseObjectInAHugeRoom) {
  Soup soup = transformed(random_soup(2'000, 0.02f, 11), {1e-3f, 1e-3f, 1e-3f}, {});
  soup.add({-1000, -1000, -1000}, {1000, -1000, -1000}, {1000, 1000, -1000});
  soup.add({-1000, -1000, 1000}, {1000, -1000, 1000}, {1000, 1000, 1000});
  const Quality quality = figures(soup);
  // The object has to be found and divided, not left in one leaf.
  EXPECT_LT(quality.max_leaf_size, 100u);
}

TEST_P(Degenerate, NeedlesThroughEverything) {
  // Long needles that all cross: every split cuts most of them. References stay bounded
  // (check_structure), however cheap steps are.
  std::mt19937 rng(12);
  std::uniform_real_distribution<float> d(-1, 1);
  Soup soup;
  for (int i = 0; i < 400; ++i) {
    const Vec3 a{d(rng), d(rng), d(rng)};
    const Vec3 shift{1e-3f, 0, 0};
    soup.add(a, Vec3{-a.x, -a.y, -a.z}, a + shift);
  }
  figures(soup);
  const Result<Tree> deep = build(soup, GetParam(), {0, 1});
  ASSERT_TRUE(deep.ok());
  check_structure(deep.value(), soup, GetParam());
}

}  // namespace
}  // namespace fasttree::baseline
