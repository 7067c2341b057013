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
  const Output output = run({}, codes, grid);
  EXPECT_GE(output.cycles, shifts);
  EXPECT_LE(output.cycles, shifts + 120);
}

TEST(SplitPlaneUnit, TakesItsRateAndItsLatency) {
  const Grid grid(Box3{{0, 0, 0}, {1, 1, 1}}, AxisSchedule::cyclic, 14);
  std::vector<std::uint32_t> codes;
  for (std::uint32_t code = 0; code < 1000; ++code) codes.push_back(code);
  PaperConfig config;
  config.internal_node.shifts_per_cycle = 32;
  // On one shared bus, codes read while the pipeline fills hide a part of a longer latency.
  config.bus.duplex = true;
  const std::uint64_t one = run(config, codes, grid).cycles;
  config.internal_node.plane_latency += 100;
  EXPECT_EQ(run(config, codes, grid).cycles, one + 100);
  config.internal_node.plane_cycles = 7;
  EXPECT_NEAR(static_cast<double>(run(config, codes, grid).cycles), 7000.0, 200.0);
}

}  // namespace
}  // namespace fasttree::model
