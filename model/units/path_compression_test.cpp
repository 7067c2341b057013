// SPDX-License-Identifier: Apache-2.0
#include "model/units/path_compression.h"

#include <gtest/gtest.h>

#include <set>

#include "model/units/unit_bench.h"
#include "reference/path_compression.h"
#include "tests/support/meshes.h"

namespace fasttree::model {
namespace {

/// Leaves, marks and nodes as the steps before leave them; links as the reference's.
void check(const std::set<std::uint32_t>& codes, int depth) {
  reference::LeafTable leaves;
  leaves.code.assign(codes.begin(), codes.end());
  const Grid grid(Box3{{0, 0, 0}, {1, 1, 1}}, AxisSchedule::cyclic, depth);
  const reference::InternalNodes nodes = reference::internal_node(leaves, grid);
  const reference::EssentialBitmap bitmap = reference::bit_encoding(nodes, depth);
  const reference::Links expected = reference::path_compression(leaves, nodes, bitmap, depth);

  const Address marks(1 << 18);
  const Address records(1 << 19);
  test::UnitBench bench;
  bench.put(Address(0), leaves.code);
  bench.put(marks, bitmap.words());
  BusPort& reads = bench.bus.add_port("read");
  BusPort& links = bench.bus.add_port("links");
  MarkCache cache(bench.config, bench.bus.add_port("cache"));
  PathCompressionUnit unit(bench.config, reads, links, cache.requests, cache.answers);
  unit.start(Address(0), static_cast<std::uint32_t>(leaves.size()), marks, records,
             static_cast<std::uint32_t>(depth));
  Clocks clocks;
  clocks.add(cache);
  bench.run({&unit, &cache}, clocks);
  EXPECT_EQ(unit.root(), expected.root);
  EXPECT_EQ(unit.climb_steps(), expected.climb_steps);
  std::vector<DeviceInternalNode> found(nodes.size());
  bench.store.read(records, found.data(), found.size() * sizeof(DeviceInternalNode));
  for (std::size_t j = 0; j < nodes.size(); ++j) {
    ASSERT_EQ(found[j].lower, expected.lower[j]) << j;
    ASSERT_EQ(found[j].upper, expected.upper[j]) << j;
  }
}

TEST(PathCompressionUnit, LinksAsTheReferenceDoes) {
  fasttree::test::Random random(6);
  for (const int depth : {1, 3, 7, 14}) {
    for (const std::uint32_t count : {1u, 2u, 9u, 3000u}) {
      std::set<std::uint32_t> codes;
      for (std::uint32_t i = 0; i < count; ++i) codes.insert(random.below(1u << depth));
      SCOPED_TRACE(std::to_string(depth) + " levels, " + std::to_string(codes.size()) + " leaves");
      check(codes, depth);
    }
  }
}

TEST(PathCompressionUnit, MakesTheOnlyLeafTheRoot) {
  check({0}, 0);
  check({5}, 12);
}

}  // namespace
}  // namespace fasttree::model
