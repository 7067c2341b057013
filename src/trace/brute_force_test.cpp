// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <bit>

#include "fasttree/build.h"
#include "fasttree/trace.h"
#include "tests/support/meshes.h"
#include "tests/support/rays.h"

namespace fasttree {
namespace {

TEST(BruteForce, EqualsOneTriangleAfterTheOther) {
  std::vector<test::NamedMesh> meshes = test::degenerate_meshes();
  meshes.push_back({"sheet", test::sheet(15, 0.2f)});
  for (const std::uint32_t n : {7u, 8u, 9u, 16u, 17u}) {
    meshes.push_back({std::to_string(n), test::soup(n, n, 0.7f)});
  }
  for (const auto& [name, owned] : meshes) {
    SCOPED_TRACE(name);
    const MeshView mesh = owned.view();
    const Tree tree = Builder().build(mesh).value();
    const BruteForce brute(mesh);
    for (const Ray& ray : test::hard_rays(mesh, tree, 1400, 77)) {
      const Hit expected = brute_force_closest(mesh, ray);
      const Hit found = brute.closest(ray);
      ASSERT_EQ(found, expected);
      ASSERT_EQ(std::bit_cast<std::uint32_t>(found.t), std::bit_cast<std::uint32_t>(expected.t));
      ASSERT_EQ(brute.occluded(ray), brute_force_occluded(mesh, ray));
    }
  }
}

}  // namespace
}  // namespace fasttree
