// SPDX-License-Identifier: Apache-2.0
#include "reference/reference_build.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "fasttree/verify.h"
#include "tests/support/meshes.h"

namespace fasttree::reference {
namespace {

TEST(ReferenceBuild, KeepsEveryIntermediateArray) {
  const test::OwnedMesh owned = test::soup(2000, 1, 0.05f);
  BuildStats stats;
  const ReferenceBuild b = build(owned.view(), {}, stats).value();
  const auto d = static_cast<std::size_t>(b.grid.depth());
  EXPECT_EQ(b.references.size(), b.counts.at[d]);
  EXPECT_EQ(b.sorted.size(), b.references.size());
  EXPECT_EQ(b.internal.size() + 1, b.leaves.size());
  EXPECT_EQ(b.links.leaf_parent.size(), b.leaves.size());
  EXPECT_GE(b.links.climb_steps, b.leaves.size() + b.internal.size() - 1);
  // Ids ascend within a leaf: the sort is stable.
  for (std::size_t j = 0; j < b.leaves.size(); ++j) {
    const auto first = b.sorted.ids.begin() + b.leaves.first[j];
    EXPECT_TRUE(std::is_sorted(first, first + b.leaves.count[j]));
  }
  std::vector<std::string> names;
  for (const StageTime& stage : stats.stages) names.push_back(stage.stage);
  EXPECT_EQ(names, (std::vector<std::string>{"scene_bound", "grid", "morton_code", "radix_sort",
                                             "leaf_node", "internal_node", "bit_encoding",
                                             "path_compression"}));
}

TEST(ReferenceBuild, MakesAVerifiedTreeOfEveryDegenerateMesh) {
  for (const auto& [name, owned] : test::degenerate_meshes()) {
    for (const AxisSchedule axes : {AxisSchedule::cyclic, AxisSchedule::longest}) {
      SCOPED_TRACE(name + std::string(", ") + to_string(axes));
      BuildSettings settings;
      settings.axes = axes;
      BuildStats stats;
      const Result<ReferenceBuild> built = build(owned.view(), settings, stats);
      ASSERT_TRUE(built.ok()) << built.status().message();
      const Result<Tree> tree = tree_from_device_image(device_image(built.value()));
      ASSERT_TRUE(tree.ok()) << tree.status().message();
      const Verification verification = verify(tree.value(), owned.view());
      EXPECT_TRUE(verification.ok) << verification.invariant << ": " << verification.detail;
      EXPECT_LE(tree.value().ids().size(), 6 * owned.view().triangle_count);
    }
  }
}

TEST(ReferenceBuild, RefusesOneTriangleAcrossTheSceneAtDepth27) {
  test::OwnedMesh owned = test::soup(100, 4, 0.01f);
  owned.add({0, 0, 0}, {1, 1, 1}, {1, 0, 1});
  BuildSettings settings;
  settings.depth = 27;
  settings.memory_limit_bytes = std::uint64_t{1} << 30;
  BuildStats stats;
  const Status status = build(owned.view(), settings, stats).status();
  EXPECT_EQ(status.code(), StatusCode::resource_limit);
  EXPECT_NE(status.message().find("133972850 references"), std::string::npos) << status.message();
}

TEST(ReferenceBuild, CanBeCancelledAtEveryReport) {
  const test::OwnedMesh owned = test::soup(500, 1, 0.05f);
  int reports = 0;
  BuildSettings settings;
  double last = 0;
  settings.progress = [&](const char*, double fraction) {
    EXPECT_GE(fraction, last);
    last = fraction;
    ++reports;
    return true;
  };
  BuildStats stats;
  ASSERT_TRUE(build(owned.view(), settings, stats).ok());
  ASSERT_GE(reports, 8);
  for (int stop = 0; stop < reports; ++stop) {
    int seen = 0;
    settings.progress = [&](const char*, double) { return seen++ < stop; };
    EXPECT_EQ(build(owned.view(), settings, stats).status().code(), StatusCode::cancelled);
    EXPECT_EQ(seen, stop + 1) << "no report after cancelling";
  }
}

}  // namespace
}  // namespace fasttree::reference
