// SPDX-License-Identifier: Apache-2.0
#include "build/node_emission.h"

#include <gtest/gtest.h>

#include <set>

#include "fasttree/device_image.h"
#include "reference/reference_build.h"
#include "tests/support/meshes.h"

namespace fasttree::build {
namespace {

// Judge: the bitmap and the climb, turned into a tree.
TEST(NodeEmission, EqualsPathCompression) {
  test::Random random(1);
  for (const int depth : {0, 1, 2, 6, 13, 22, 30}) {
    for (const std::uint32_t wanted : {1u, 2u, 5u, 100u, 3000u}) {
      if (depth == 30 && wanted > 5) continue;  // the bitmap takes 256 MB
      std::set<std::uint32_t> codes;
      for (std::uint32_t i = 0; i < wanted; ++i) codes.insert(random.below(1u << depth));
      reference::ReferenceBuild b;
      b.grid = Grid({{0, 0, 0}, {1, 2, 3}}, AxisSchedule::longest, depth);
      std::uint32_t first = 0;
      for (const std::uint32_t code : codes) {
        b.leaves.code.push_back(code);
        b.leaves.first.push_back(first);
        b.leaves.count.push_back(1 + random.below(4));
        first += b.leaves.count.back();
      }
      b.sorted.ids.assign(first, 0);
      b.triangle_count = 1;
      b.internal = reference::internal_node(b.leaves, b.grid);
      b.essential = reference::bit_encoding(b.internal, depth);
      b.links = reference::path_compression(b.leaves, b.internal, b.essential, depth);
      const Result<Tree> expected = tree_from_device_image(reference::device_image(b));
      ASSERT_TRUE(expected.ok()) << expected.status().message();

      std::vector<LeafStart> leaves;
      for (std::size_t j = 0; j < b.leaves.size(); ++j) {
        leaves.push_back({b.leaves.code[j], b.leaves.first[j]});
      }
      Buffer<Node> nodes(2 * codes.size() - 1);
      emit_nodes(leaves, first, b.grid, 0, nodes);
      ASSERT_TRUE(std::equal(nodes.begin(), nodes.end(), expected.value().nodes().begin(),
                             expected.value().nodes().end()))
          << depth << ' ' << wanted;
    }
  }
}

}  // namespace
}  // namespace fasttree::build
