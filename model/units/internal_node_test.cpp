// SPDX-License-Identifier: Apache-2.0
#include "model/units/internal_node.h"

#include <gtest/gtest.h>

#include <set>

#include "fasttree/device_image.h"
#include "model/units/unit_bench.h"
#include "reference/internal_node.h"
#include "tests/support/meshes.h"

namespace fasttree::model {
namespace {

TEST(PlaneSearch, FindsTheDefinitionsPlane) {
  for (const auto& [lo, hi] : std::vector<std::pair<float, float>>{
           {0, 1}, {-1, 1}, {-0.1083f, 0.0966f}, {1e6f, 1e6f + 1}, {-1e38f, 1e38f}, {-3e-20f, 1}}) {
    const Box3 bounds{{lo, lo, lo}, {hi, hi, hi}};
    const AxisLevels levels = make_axis_levels(bounds, AxisSchedule::cyclic);
    const AxisQuantiser quantiser = make_axis_quantiser(bounds, levels, 0);
    for (std::uint32_t k = 1; k < kFinestCells; k += 37) {
      PlaneSearch search(quantiser, hi, k);
      int trials = 0;
      for (; !search.found(); ++trials) search.trial();
      ASSERT_EQ(search.plane(), find_plane(quantiser, hi, k)) << lo << ' ' << hi << ' ' << k;
      ASSERT_GE(trials, 1);
      ASSERT_LE(trials, 70);
    }
  }
}

struct Output {
  std::vector<std::uint32_t> marks;
  std::vector<DeviceInternalNode> nodes;
  std::uint64_t cycles = 0;
};

Output run(const PaperConfig& config, const std::vector<std::uint32_t>& codes, const Grid& grid) {
  const Address nodes(1 << 18);
  test::UnitBench bench(config);
  bench.put(Address(0), codes);
  Queue<std::uint32_t> marks(config.internal_node.queue);
  SplitPlaneUnit planes(config, bench.bus.add_port("nodes"));
  InternalNodeUnit unit(config, bench.bus.add_port("read"), planes.input, marks);
  const auto leaves = static_cast<std::uint32_t>(codes.size());
  unit.start(Address(0), leaves);
  planes.start(nodes, leaves - 1, grid);
  Clocks clocks;
  clocks.add(planes);
  clocks.add(marks);
  Output output;
  while (!unit.done() || !planes.done() || !marks.empty() || !bench.bus.done()) {
    if (marks.valid()) output.marks.push_back(marks.pop());
    bench.step({&unit, &planes}, clocks);
    if (++output.cycles > 1000000) break;
  }
  output.nodes.resize(leaves - 1);
  bench.store.read(nodes, output.nodes.data(), output.nodes.size() * sizeof(DeviceInternalNode));
  return output;
}

TEST(InternalNodeUnit, MakesTheReferencesNodes) {
  fasttree::test::Random random(4);
  std::set<std::uint32_t> codes;
  for (int i = 0; i < 2000; ++i) codes.insert(random.below(1u << 14));
  reference::LeafTable leaves;
  leaves.code.assign(codes.begin(), codes.end());
  const Grid grid(Box3{{-1, 0, 5}, {3, 1, 5.5f}}, AxisSchedule::longest, 14);
  const reference::InternalNodes expected = reference::internal_node(leaves, grid);
  for (const std::uint32_t shifts : {1u, 32u}) {
    PaperConfig config;
    config.internal_node.shifts_per_cycle = shifts;
    const Output output = run(config, leaves.code, grid);
    EXPECT_EQ(output.marks, expected.node_index);
    for (std::size_t j = 0; j < expected.size(); ++j) {
      ASSERT_EQ(output.nodes[j].axis, expected.axis[j]);
      ASSERT_EQ(output.nodes[j].split, expected.split[j]);
    }
  }
}

/// Codes 0, 1, 2, 3 differ in bits 0, 1, 0: one, two, one shifts.
TEST(InternalNodeUnit, ShiftsOnceMoreThanTheHighestDifferentBit) {
  const Grid grid(Box3{{0, 0, 0}, {1, 1, 1}}, AxisSchedule::cyclic, 14);
  std::vector<std::uint32_t> codes;
  std::uint64_t shifts = 0;
  for (std::uint32_t code = 0; code < 4096; ++code) {
    codes.push_back(code * 4);
    if (code > 0) {
      shifts += static_cast<std::uint64_t>(
          reference::highest_different_bit(codes[code - 1], codes[code]) + 1);
    }
  }
  PaperConfig config;
  config.internal_node.plane_trials = 64;
  const Output output = run(config, codes, grid);
  EXPECT_GE(output.cycles, shifts);
  EXPECT_LE(output.cycles, shifts + 120);
}

}  // namespace
}  // namespace fasttree::model
