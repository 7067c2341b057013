// SPDX-License-Identifier: Apache-2.0
// The machine's tree is the reference builder's, whatever the configuration.
#include "model/fasttree2/machine.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>

#include "fasttree/build.h"
#include "model/fasttree2/test_memory.h"
#include "tests/support/meshes.h"

namespace fasttree::model::ft2 {
namespace {

Result<Tree> reference_tree(const MeshView& mesh, const FastTree2Config& config) {
  BuildSettings settings;
  settings.profile = Profile::paper;
  settings.implementation = Implementation::reference;
  settings.axes = config.axes;
  settings.depth =
      config.depth == FastTree2Config::kDepthByRule ? kAutoDepth : static_cast<int>(config.depth);
  settings.extra_depth = static_cast<int>(config.extra_depth);
  settings.max_growth = config.max_growth;
  return Builder().build(mesh, settings);
}

/// Empty where the machine's tree is the reference's; else what differs.
std::string difference(const MeshView& mesh, const FastTree2Config& config,
                       const TestMemory::Shape& shape = {}, const Extras& extras = {},
                       Figures* figures = nullptr) {
  TestMemory memory(shape);
  const auto result = run(mesh, "test", config, 500, memory, {}, extras, figures);
  if (!result.ok()) return result.status().message();
  const Result<Tree> expected = reference_tree(mesh, config);
  if (!expected.ok()) return expected.status().message();
  const Tree& tree = result.value().tree;
  if (!(tree.info() == expected.value().info())) return "info";
  if (!std::ranges::equal(tree.ids(), expected.value().ids())) return "ids";
  if (!std::ranges::equal(tree.nodes(), expected.value().nodes())) return "nodes";
  if (tree.hash() != expected.value().hash()) return "hash";
  return "";
}

TEST(FastTree2, BuildsTheReferenceTreeOfDegenerateMeshes) {
  for (const auto& [name, mesh] : test::degenerate_meshes()) {
    for (const AxisSchedule axes : {AxisSchedule::cyclic, AxisSchedule::longest}) {
      for (const bool given : {false, true}) {
        SCOPED_TRACE(name + " " + to_string(axes) + (given ? " given" : ""));
        FastTree2Config config;
        config.axes = axes;
        config.bounds_given = given;
        EXPECT_EQ(difference(mesh.view(), config), "");
      }
    }
  }
}

}  // namespace
}  // namespace fasttree::model::ft2
