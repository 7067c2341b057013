// SPDX-License-Identifier: Apache-2.0
// The verifier against the builders: what they make passes, on meshes that are hard on both.
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "fasttree/build.h"
#include "fasttree/verify.h"
#include "tree/test_trees.h"

namespace fasttree {
namespace {

using test::Mesh;
using test::Rng;

std::vector<BuildSettings> all_settings() {
  std::vector<BuildSettings> all;
  for (const Profile profile :
       {Profile::paper, Profile::realtime, Profile::sah_exact, Profile::sah_binned}) {
    for (const AxisSchedule axes : {AxisSchedule::cyclic, AxisSchedule::longest}) {
      BuildSettings settings;
      settings.profile = profile;
      settings.axes = axes;
      all.push_back(settings);
      if (profile == Profile::paper || profile == Profile::realtime) {
        settings.implementation = Implementation::reference;
        all.push_back(settings);
      }
      if (profile != Profile::paper) break;
    }
  }
  return all;
}

testing::AssertionResult passes(const Mesh& mesh) {
  for (const BuildSettings& settings : all_settings()) {
    const Result<Tree> tree = Builder().build(mesh.view(), settings);
    if (!tree.ok()) return testing::AssertionFailure() << tree.status().message();
    const Verification v = verify(tree.value(), mesh.view());
    if (!v.ok) {
      return testing::AssertionFailure()
             << to_string(settings.profile) << ", " << to_string(settings.axes) << ": "
             << v.invariant << ": " << v.detail;
    }
  }
  return testing::AssertionSuccess();
}

TEST(VerifyBuilders, RandomMeshesPass) {
  ASSERT_TRUE(rc::check([](std::uint64_t seed) {
    Rng rng(seed);
    const auto ok = passes(test::random_mesh(rng, *rc::gen::inRange<std::uint32_t>(0, 300)));
    if (!ok) RC_FAIL(ok.message());
  }));
}

TEST(VerifyBuilders, MeshesFarFromTheOriginPass) {
  for (const float offset : {1e4f, 1e5f, 1e6f, 1e7f}) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      Rng rng(seed);
      Mesh mesh = test::random_mesh(rng, 200);
      for (Vec3& p : mesh.corners) p = p + Vec3{offset, -offset, 0};
      EXPECT_TRUE(passes(mesh)) << offset << ", seed " << seed;
    }
  }
}

TEST(VerifyBuilders, MeshesOfAnySizePass) {
  for (const float size : {1e-40f, 1e-30f, 1e-7f, 1e7f, 1e30f, 4e37f}) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      Rng rng(seed);
      Mesh mesh = test::random_mesh(rng, 200);
      for (Vec3& p : mesh.corners) p = p * size;
      EXPECT_TRUE(passes(mesh)) << size << ", seed " << seed;
    }
  }
}

TEST(VerifyBuilders, MeshesOnALatticePass) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Rng rng(seed);
    Mesh mesh;
    for (int corner = 0; corner < 3 * 200; ++corner) {
      mesh.corners.push_back({static_cast<float>(test::below(rng, 5)),
                              static_cast<float>(test::below(rng, 5)),
                              static_cast<float>(test::below(rng, 3))});
    }
    EXPECT_TRUE(passes(mesh)) << "seed " << seed;
  }
}

TEST(VerifyBuilders, FlatMeshesPass) {
  for (std::size_t dead = 0; dead < 8; ++dead) {
    Rng rng(dead);
    Mesh mesh = test::random_mesh(rng, 100);
    for (Vec3& p : mesh.corners) {
      for (std::size_t a = 0; a < 3; ++a) {
        if (dead >> a & 1) p[a] = -0.0f;
      }
    }
    EXPECT_TRUE(passes(mesh)) << "dead axes " << dead;
  }
}

}  // namespace
}  // namespace fasttree
