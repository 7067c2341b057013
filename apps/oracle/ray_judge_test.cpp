// SPDX-License-Identifier: Apache-2.0
// The judge has to pass a right tree and to catch wrong ones, with either oracle.
#include "oracle/ray_judge.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "fasttree/build.h"
#include "oracle/embree_oracle.h"

namespace fasttree::oracle {
namespace {

struct Cloud {
  std::vector<Vec3> positions;
  MeshView mesh;

  explicit Cloud(std::uint32_t triangles) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> place(-1.0f, 1.0f);
    std::uniform_real_distribution<float> side(-0.2f, 0.2f);
    for (std::uint32_t t = 0; t < triangles; ++t) {
      const Vec3 p{place(random), place(random), place(random)};
      positions.push_back(p);
      positions.push_back(p + Vec3{side(random), side(random), side(random)});
      positions.push_back(p + Vec3{side(random), side(random), side(random)});
    }
    mesh.positions = positions.data();
    mesh.vertex_count = 3 * triangles;
    mesh.triangle_count = triangles;
  }
};

Tree build(const MeshView& mesh) {
  auto tree = Builder().build(mesh);
  EXPECT_TRUE(tree.ok()) << tree.status().message();
  return std::move(tree).value();
}

RayReport judge(const MeshView& mesh, const Tree& tree, Oracle oracle) {
  auto tracer = Tracer::create(tree, mesh);
  EXPECT_TRUE(tracer.ok()) << tracer.status().message();
  JudgeSettings settings;
  settings.oracle = oracle;
  settings.rays = 5000;
  auto report = judge_rays(mesh, tree, tracer.value(), settings);
  EXPECT_TRUE(report.ok()) << report.status().message();
  return report.value();
}

class EitherOracle : public testing::TestWithParam<Oracle> {
 protected:
  void SetUp() override {
    if (GetParam() == Oracle::embree && !embree_available()) {
      GTEST_SKIP() << "built without Embree";
    }
  }
};

TEST_P(EitherOracle, PassesARightTree) {
  const Cloud cloud(500);
  const RayReport report = judge(cloud.mesh, build(cloud.mesh), GetParam());
  EXPECT_TRUE(report.ok()) << report.first_wrong;
  EXPECT_EQ(report.total().rays, 5000u);
  EXPECT_GT(report.total().hits, 1000u);
  EXPECT_EQ(report.sets.size(), kAllRaySets.size());
}

TEST_P(EitherOracle, CatchesATriangleThatALeafLost) {
  const Cloud cloud(500);
  const Tree tree = build(cloud.mesh);
  // Triangle 250's references name triangle 249 instead: 250 is in no leaf.
  std::vector<std::uint32_t> ids(tree.ids().begin(), tree.ids().end());
  for (std::uint32_t& id : ids) id = id == 250 ? 249 : id;
  const Tree broken(tree.info(), {tree.nodes().begin(), tree.nodes().end()}, ids);
  const RayReport report = judge(cloud.mesh, broken, GetParam());
  EXPECT_FALSE(report.ok());
  EXPECT_NE(report.first_wrong.find("250"), std::string::npos) << report.first_wrong;
}

TEST_P(EitherOracle, CatchesAMovedPlane) {
  const Cloud cloud(500);
  const Tree tree = build(cloud.mesh);
  std::vector<Node> nodes(tree.nodes().begin(), tree.nodes().end());
  ASSERT_FALSE(nodes[0].is_leaf());
  nodes[0] = Node::inner(nodes[0].axis(), nodes[0].split() + 0.3f, nodes[0].upper());
  const Tree broken(tree.info(), nodes, {tree.ids().begin(), tree.ids().end()});
  EXPECT_FALSE(judge(cloud.mesh, broken, GetParam()).ok());
}

TEST_P(EitherOracle, CanBeCancelled) {
  const Cloud cloud(50);
  const Tree tree = build(cloud.mesh);
  const auto tracer = Tracer::create(tree, cloud.mesh);
  ASSERT_TRUE(tracer.ok());
  JudgeSettings settings;
  settings.oracle = GetParam();
  settings.progress = [](const char*, double fraction) { return fraction < 0.5; };
  const auto report = judge_rays(cloud.mesh, tree, tracer.value(), settings);
  ASSERT_FALSE(report.ok());
  EXPECT_EQ(report.status().code(), StatusCode::cancelled);
}

TEST_P(EitherOracle, PassesHugeAndTinyCoordinates) {
  for (const float scale : {1e-30f, 1e18f, 1e37f}) {
    Cloud cloud(200);
    for (Vec3& p : cloud.positions) p = p * scale;
    const RayReport report = judge(cloud.mesh, build(cloud.mesh), GetParam());
    EXPECT_TRUE(report.ok()) << scale << ": " << report.first_wrong;
    EXPECT_GT(report.total().hits, 100u) << scale;
  }
}

TEST_P(EitherOracle, AnEmptyMeshIsNeverHit) {
  const Tree tree;
  const MeshView nothing;
  const RayReport report = judge(nothing, tree, GetParam());
  EXPECT_TRUE(report.ok()) << report.first_wrong;
  EXPECT_EQ(report.total().hits, 0u);
}

INSTANTIATE_TEST_SUITE_P(Oracles, EitherOracle, testing::Values(Oracle::brute, Oracle::embree),
                         [](const auto& instance) {
                           return std::string(to_string(instance.param));
                         });

TEST(Embree, SaysSoWhereItIsMissing) {
  if (embree_available()) GTEST_SKIP() << "built with Embree " << embree_version();
  const auto scene = EmbreeScene::create({});
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.status().code(), StatusCode::invalid_argument);
}

}  // namespace
}  // namespace fasttree::oracle
