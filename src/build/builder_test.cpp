// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <vector>

#include "fasttree/build.h"
#include "fasttree/verify.h"
#include "tests/support/meshes.h"

namespace fasttree {
namespace {

const std::vector<Profile> kProfiles{Profile::paper, Profile::realtime, Profile::sah_exact,
                                     Profile::sah_binned};
// Those with a grid, and with two implementations.
const std::vector<Profile> kGridProfiles{Profile::paper, Profile::realtime};

void expect_same_bytes(const Tree& a, const Tree& b) {
  EXPECT_EQ(a.info(), b.info());
  EXPECT_TRUE(std::equal(a.nodes().begin(), a.nodes().end(), b.nodes().begin(), b.nodes().end()));
  EXPECT_TRUE(std::equal(a.ids().begin(), a.ids().end(), b.ids().begin(), b.ids().end()));
  EXPECT_EQ(a.hash(), b.hash());
}

Tree reference_tree(const MeshView& mesh, BuildSettings settings) {
  settings.implementation = Implementation::reference;
  Builder builder;
  Result<Tree> tree = builder.build(mesh, settings);
  EXPECT_TRUE(tree.ok()) << tree.status().message();
  return tree.ok() ? std::move(tree).value() : Tree();
}

TEST(Builder, WritesTheReferencesBytesForEveryThreadCountAndInstructionSet) {
  // Seven threads also on a machine with fewer cores.
  const tbb::global_control threads_allowed(tbb::global_control::max_allowed_parallelism, 7);
  std::vector<test::NamedMesh> meshes = test::degenerate_meshes();
  meshes.push_back({"large soup", test::soup(20000, 7, 0.02f)});
  meshes.push_back({"sheet", test::sheet(90, 0.2f)});
  Builder builder;  // one for all, so that reused memory is tested too
  for (const auto& [name, owned] : meshes) {
    for (const AxisSchedule axes : {AxisSchedule::cyclic, AxisSchedule::longest}) {
      for (const int depth : {kAutoDepth, 0, 9}) {
        SCOPED_TRACE(name + " " + to_string(axes) + " " + std::to_string(depth));
        BuildSettings settings;
        settings.profile = Profile::paper;
        settings.axes = axes;
        settings.depth = depth;
        const Tree expected = reference_tree(owned.view(), settings);
        for (const int threads : {1, 2, 7}) {
          for (const Simd simd : {Simd::scalar, Simd::widest}) {
            settings.simd = simd;
            tbb::task_arena arena(threads);
            Tree tree;
            const Status status =
                arena.execute([&] { return builder.build(owned.view(), settings, tree); });
            ASSERT_TRUE(status.ok()) << status.message();
            expect_same_bytes(tree, expected);
          }
        }
      }
    }
  }
}

TEST(Builder, EqualsTheReferenceOnRandomMeshes) {
  EXPECT_TRUE(rc::check("fast equals reference", [] {
    const auto triangles = *rc::gen::inRange<std::uint32_t>(0, 700);
    const auto seed = *rc::gen::arbitrary<std::uint64_t>();
    const float size = static_cast<float>(*rc::gen::inRange(0, 1000)) * 1e-3f;
    const auto scale = [] { return std::ldexp(1.0f, *rc::gen::inRange(-12, 12)); };
    const test::OwnedMesh owned = test::moved(test::soup(triangles, seed, size),
                                              {scale(), scale(), scale()}, {scale(), -scale(), 0});
    BuildSettings settings;
    settings.profile = Profile::paper;
    settings.axes = *rc::gen::element(AxisSchedule::cyclic, AxisSchedule::longest);
    settings.depth = *rc::gen::inRange(-1, 13);
    Builder builder;
    const Result<Tree> fast = builder.build(owned.view(), settings);
    settings.implementation = Implementation::reference;
    const Result<Tree> slow = builder.build(owned.view(), settings);
    RC_ASSERT(fast.ok() && slow.ok());
    RC_ASSERT(fast.value().info() == slow.value().info());
    RC_ASSERT(fast.value().hash() == slow.value().hash());
    RC_ASSERT(std::equal(fast.value().nodes().begin(), fast.value().nodes().end(),
                         slow.value().nodes().begin(), slow.value().nodes().end()));
  }));
}

// Vertices that no triangle uses count for nothing, wherever they are.
TEST(Builder, PassesOverVerticesNobodyUses) {
  const test::OwnedMesh used = test::sheet(30, 0.2f);
  Builder builder;
  const Tree expected = builder.build(used.view()).value();
  for (const Vec3 stray : {Vec3{-9, 0, 0}, Vec3{0, 9, 0}, Vec3{NAN, 0, 0}, Vec3{0, INFINITY, 0},
                           Vec3{3e38f, -3e38f, 0}, Vec3{0.5f, 0.5f, 0}}) {
    test::OwnedMesh owned = used;
    owned.positions.push_back(stray);
    const Result<Tree> tree = builder.build(owned.view());
    ASSERT_TRUE(tree.ok()) << tree.status().message();
    expect_same_bytes(tree.value(), expected);
  }
  // A builder remembers them; another frame may use them after all.
  test::OwnedMesh owned = used;
  owned.positions.push_back({0.5f, 0.5f, 70});
  for (int frame = 0; frame < 3; ++frame) {
    expect_same_bytes(builder.build(owned.view()).value(), expected);
  }
  owned.indices.back() = static_cast<std::uint32_t>(owned.positions.size() - 1);
  expect_same_bytes(builder.build(owned.view()).value(), reference_tree(owned.view(), {}));
  expect_same_bytes(builder.build(used.view()).value(), expected);
  owned.positions.back() = {NAN, 0, 0};
  EXPECT_EQ(builder.build(owned.view()).status().code(), StatusCode::bad_input);
  MeshView nothing;
  nothing.vertex_count = 7;  // without positions, and nobody asks for them
  EXPECT_EQ(builder.build(nothing).value().nodes().size(), 1u);
}

TEST(Builder, ReusesTheTreesMemory) {
  const test::OwnedMesh owned = test::soup(5000, 1, 0.02f);
  for (const Profile profile : kGridProfiles) {
    SCOPED_TRACE(to_string(profile));
    BuildSettings settings;
    settings.profile = profile;
    Builder builder;
    Tree tree;
    ASSERT_TRUE(builder.build(owned.view(), settings, tree).ok());
    const Node* const nodes = tree.nodes().data();
    const std::uint32_t* const ids = tree.ids().data();
    for (int frame = 0; frame < 3; ++frame) {
      ASSERT_TRUE(builder.build(owned.view(), settings, tree).ok());
      EXPECT_EQ(tree.nodes().data(), nodes);
      EXPECT_EQ(tree.ids().data(), ids);
    }
    builder.shrink();
    ASSERT_TRUE(builder.build(owned.view(), settings, tree).ok());
    EXPECT_EQ(builder.stats().triangles, 5000u);
    EXPECT_EQ(builder.stats().references, tree.ids().size());
    EXPECT_GT(builder.stats().planned_bytes, tree.ids().size_bytes());
  }
}

TEST(Builder, SaysWhatIsWrongWithAMeshInEveryProfile) {
  for (const Profile profile : kProfiles) {
    SCOPED_TRACE(to_string(profile));
    BuildSettings settings;
    settings.profile = profile;
    Builder builder;
    test::OwnedMesh owned = test::soup(600, 1, 0.1f);
    owned.positions[3 * 555].z = NAN;
    Tree tree;
    ASSERT_TRUE(builder.build(test::soup(9, 1, 1).view(), {}, tree).ok());
    Status status = builder.build(owned.view(), settings, tree);
    EXPECT_EQ(status.code(), StatusCode::bad_input);
    EXPECT_NE(status.message().find("triangle 555, corner 0, z"), std::string::npos)
        << status.message();
    EXPECT_EQ(tree.info().triangle_count, 0u) << "after a failure the tree is the empty one";
    EXPECT_EQ(tree.nodes().size(), 1u);

    owned.positions[3 * 555].z = 3e38f;
    owned.positions[3 * 222].z = -3e38f;
    EXPECT_EQ(builder.build(owned.view(), settings, tree).code(), StatusCode::bad_input);

    owned.indices = {0, 1, 2000};
    EXPECT_EQ(builder.build(owned.view(), settings, tree).code(), StatusCode::bad_input);
  }
}

TEST(Builder, RefusesSettingsThatCannotBe) {
  const test::OwnedMesh owned = test::soup(50, 1, 0.1f);
  Builder builder;
  for (const Implementation implementation : {Implementation::fast, Implementation::reference}) {
    BuildSettings settings;
    settings.implementation = implementation;
    settings.depth = 31;
    EXPECT_EQ(builder.build(owned.view(), settings).status().code(), StatusCode::invalid_argument);
    settings.depth = kAutoDepth;
    settings.profile = Profile::paper;
    settings.max_growth = 0.5;
    EXPECT_EQ(builder.build(owned.view(), settings).status().code(), StatusCode::invalid_argument);
  }
  BuildSettings settings;
  settings.depth = 31;
  EXPECT_EQ(builder.build(owned.view(), settings).status().code(), StatusCode::invalid_argument);
  settings.profile = static_cast<Profile>(77);
  EXPECT_EQ(builder.build(owned.view(), settings).status().code(), StatusCode::invalid_argument);
}

TEST(Builder, RefusesMoreMemoryThanItsLimitBeforeItTakesIt) {
  test::OwnedMesh owned = test::soup(1000, 4, 0.01f);
  owned.add({0, 0, 0}, {1, 1, 1}, {1, 0, 1});
  Builder builder;
  for (const Implementation implementation : {Implementation::fast, Implementation::reference}) {
    for (const Profile profile : kGridProfiles) {
      BuildSettings settings;
      settings.profile = profile;
      settings.implementation = implementation;
      settings.depth = 27;
      settings.memory_limit_bytes = 100 << 20;
      EXPECT_EQ(builder.build(owned.view(), settings).status().code(), StatusCode::resource_limit);
      settings.depth = kAutoDepth;
      EXPECT_TRUE(builder.build(owned.view(), settings).ok());
      settings.memory_limit_bytes = 1000;
      EXPECT_EQ(builder.build(owned.view(), settings).status().code(), StatusCode::resource_limit);
    }
  }
}

TEST(Builder, CanBeCancelledAtEveryReport) {
  const test::OwnedMesh owned = test::soup(3000, 1, 0.05f);
  for (const Profile profile : kProfiles) {
    SCOPED_TRACE(to_string(profile));
    Builder builder;
    BuildSettings settings;
    settings.profile = profile;
    int reports = 0;
    settings.progress = [&](const char*, double fraction) {
      EXPECT_GE(fraction, 0.0);
      EXPECT_LE(fraction, 1.0);
      ++reports;
      return true;
    };
    ASSERT_TRUE(builder.build(owned.view(), settings).ok());
    ASSERT_GT(reports, 1);
    for (int stop = 0; stop < reports; stop += 1 + reports / 20) {
      int seen = 0;
      settings.progress = [&](const char*, double) { return seen++ < stop; };
      EXPECT_EQ(builder.build(owned.view(), settings).status().code(), StatusCode::cancelled);
    }
    settings.progress = nullptr;
    EXPECT_TRUE(builder.build(owned.view(), settings).ok()) << "a builder survives a cancel";
  }
}

}  // namespace
}  // namespace fasttree
