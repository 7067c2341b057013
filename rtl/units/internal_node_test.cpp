// SPDX-License-Identifier: Apache-2.0
// Nodes and marks against the reference, and the cycles of shifter and planes against the model's.
#include "model/units/internal_node.h"

#include <gtest/gtest.h>

#include <set>

#include "Vinternal_node_16.h"
#include "Vinternal_node_64.h"
#include "Vinternal_node_8.h"
#include "Vinternal_node_wide.h"
#include "Vsplit_plane.h"
#include "model/units/unit_bench.h"
#include "reference/internal_node.h"
#include "rtl/bench/bench.h"
#include "rtl/bench/grid_port.h"
#include "rtl/bench/write_memory.h"

namespace fasttree::rtl {
namespace {

std::vector<std::uint32_t> random_leaves(std::size_t count, int depth, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::set<std::uint32_t> codes;
  while (codes.size() < count) codes.insert(random() >> (32 - depth));
  return {codes.begin(), codes.end()};
}

struct Output {
  std::vector<std::uint32_t> marks, codes, bits;
  std::uint64_t cycles = 0, busy = 0;
  std::uint64_t stalled[3] = {};
};

template <typename Model>
void offer_beat(Bench<Model>& bench, const std::vector<std::uint32_t>& leaves, std::size_t at,
                std::size_t words) {
  for (std::size_t i = 0; i < words; ++i) {
    set_word(bench.unit.rd_data, i, at + i < leaves.size() ? leaves[at + i] : bench.random());
  }
}

template <typename Model>
Output run(Bench<Model>& bench, const std::vector<std::uint32_t>& leaves, std::size_t bus_bytes,
           unsigned in, unsigned node_percent, unsigned mark_percent) {
  auto& unit = bench.unit;
  unit.rd_valid = unit.node_ready = unit.mark_ready = 0;
  unit.leaves = static_cast<std::uint32_t>(leaves.size());
  unit.start = 1;
  bench.settle();
  EXPECT_TRUE(unit.done);
  bench.cycle();
  unit.start = 0;
  bench.settle();
  EXPECT_EQ(unit.done, leaves.empty());
  Output output;
  bool mark_waits = false;
  std::uint32_t mark = 0;
  for (std::size_t at = 0; !unit.done; ++output.cycles) {
    if (output.cycles > 1000000) {
      ADD_FAILURE() << "not done";
      break;
    }
    if (!unit.rd_valid && bench.chance(in)) {
      unit.rd_valid = 1;
      offer_beat(bench, leaves, at, bus_bytes / 4);
    }
    unit.node_ready = bench.chance(node_percent);
    unit.mark_ready = bench.chance(mark_percent);
    bench.settle();
    if (mark_waits) {
      EXPECT_TRUE(unit.mark_valid && unit.mark_index == mark);
    }
    mark_waits = unit.mark_valid && !unit.mark_ready;
    mark = unit.mark_index;
    if (unit.mark_valid && unit.mark_ready) output.marks.push_back(unit.mark_index);
    if (unit.node_valid && unit.node_ready) {
      output.codes.push_back(unit.node_code);
      output.bits.push_back(unit.node_bit);
    }
    EXPECT_LE(unit.activity, 4);
    if (unit.activity == 1) ++output.busy;
    if (unit.activity > 1) ++output.stalled[unit.activity - 2];
    const bool taken = unit.rd_valid && unit.rd_ready;
    bench.cycle();
    if (taken) {
      at += bus_bytes / 4;
      unit.rd_valid = 0;
    }
    bench.settle();
    if (unit.done) {
      EXPECT_GE(at, leaves.size());
      EXPECT_LT(at, leaves.size() + bus_bytes / 4);
    }
  }
  EXPECT_EQ(unit.activity, 0);
  return output;
}

template <typename Model>
void makes_the_nodes(std::size_t bus_bytes) {
  Bench<Model> bench(static_cast<std::uint32_t>(bus_bytes));
  for (std::uint32_t i = 0; i < 600; ++i) {
    const int depth = i % 3 == 0 ? 30 : i % 3 == 1 ? 9 : 17;
    const std::vector<std::uint32_t> leaves = random_leaves(bench.random() % 90, depth, i);
    const auto percent = [&] { return bench.chance(50) ? 100u : 30u; };
    const Output output = run(bench, leaves, bus_bytes, percent(), percent(), percent());
    std::vector<std::uint32_t> marks, codes, bits;
    for (std::size_t j = 1; j < leaves.size(); ++j) {
      const int m = reference::highest_different_bit(leaves[j - 1], leaves[j]);
      codes.push_back(leaves[j]);
      bits.push_back(static_cast<std::uint32_t>(m));
      marks.push_back(leaves[j] >> m << m << 1);
    }
    ASSERT_EQ(output.codes, codes) << i;
    ASSERT_EQ(output.bits, bits) << i;
    ASSERT_EQ(output.marks, marks) << i;
  }
  EXPECT_EQ(bench.failed_assertions(), 0);
}

TEST(RtlInternalNode, MakesTheReferencesNodes) {
  makes_the_nodes<Vinternal_node_16>(16);
}
TEST(RtlInternalNode, MakesTheReferencesNodesOnOtherBuses) {
  makes_the_nodes<Vinternal_node_8>(8);
  makes_the_nodes<Vinternal_node_64>(64);
}
TEST(RtlInternalNode, MakesTheReferencesNodesWithALongerShift) {
  makes_the_nodes<Vinternal_node_wide>(16);
}

TEST(RtlInternalNode, TakesAShiftMoreThanTheHighestDifferentBit) {
  Bench<Vinternal_node_16> bench;
  const std::vector<std::uint32_t> leaves = random_leaves(3000, 20, 1);
  std::uint64_t shifts = 0;
  for (std::size_t j = 1; j < leaves.size(); ++j) {
    const int m = reference::highest_different_bit(leaves[j - 1], leaves[j]);
    shifts += static_cast<std::uint64_t>(m + 1);
  }
  const Output output = run(bench, leaves, 16, 100, 100, 100);
  // Two codes and a load to begin with, and the last node's way through the queue.
  EXPECT_EQ(output.cycles, shifts + 4);
}

TEST(RtlInternalNode, SaysWhatItWaitsFor) {
  Bench<Vinternal_node_16> bench;
  const std::vector<std::uint32_t> leaves = random_leaves(500, 9, 1);
  EXPECT_GT(run(bench, leaves, 16, 2, 100, 100).stalled[0], 1000u);
  EXPECT_GT(run(bench, leaves, 16, 100, 2, 100).stalled[1], 1000u);
  EXPECT_GT(run(bench, leaves, 16, 100, 100, 2).stalled[2], 1000u);
}

TEST(RtlInternalNode, NoticesTwoLeavesOfOneCode) {
  Bench<Vinternal_node_16> bench;
  run(bench, {1, 2, 2, 3}, 16, 100, 100, 100);
  EXPECT_GT(bench.failed_assertions(), 0);
}

/// Both units one behind the other, in step.
std::uint64_t rtl_cycles(const std::vector<std::uint32_t>& leaves, const Grid& grid,
                         std::vector<std::uint32_t>& records) {
  Bench<Vinternal_node_64> nodes;
  Bench<Vsplit_plane> planes;
  set_grid(planes.unit.grid, grid);
  nodes.unit.leaves = static_cast<std::uint32_t>(leaves.size());
  planes.unit.count = nodes.unit.leaves - 1;
  planes.unit.nodes = 0;
  planes.unit.node_valid = 0;
  nodes.unit.start = planes.unit.start = 1;
  nodes.cycle();
  planes.cycle();
  nodes.unit.start = planes.unit.start = 0;
  nodes.unit.mark_ready = planes.unit.wr_ready = 1;
  nodes.unit.rd_valid = 1;
  WriteMemory memory(64);
  std::uint64_t cycles = 0;
  std::size_t at = 0;
  offer_beat(nodes, leaves, at, 16);
  while (!nodes.unit.done || !planes.unit.done) {
    nodes.settle();
    planes.unit.node_valid = nodes.unit.node_valid;
    planes.unit.node_code = nodes.unit.node_code;
    planes.unit.node_bit = nodes.unit.node_bit;
    planes.settle();
    nodes.unit.node_ready = planes.unit.node_ready;
    nodes.settle();
    memory.look(planes.unit.wr_valid, true, planes.unit.wr_addr, planes.unit.wr_bytes,
                planes.unit.wr_data);
    const bool taken = nodes.unit.rd_ready;
    nodes.cycle();
    planes.cycle();
    if (taken) offer_beat(nodes, leaves, at += 16, 16);
    if (++cycles > 1000000) break;
  }
  records = memory.run_from(0);
  return cycles;
}

std::uint64_t model_cycles(const std::vector<std::uint32_t>& leaves, const Grid& grid,
                           std::vector<std::uint32_t>& records) {
  model::PaperConfig config;
  config.bus.bytes = 64;  // wide enough not to count
  const model::Address at(1 << 18);
  model::test::UnitBench bench(config);
  bench.put(model::Address(0), leaves);
  model::Queue<std::uint32_t> marks(config.internal_node.queue);
  model::SplitPlaneUnit planes(config, bench.bus.add_port("nodes"));
  model::InternalNodeUnit unit(config, bench.bus.add_port("read"), planes.input, marks);
  unit.start(model::Address(0), static_cast<std::uint32_t>(leaves.size()));
  planes.start(at, static_cast<std::uint32_t>(leaves.size() - 1), grid);
  model::Clocks clocks;
  clocks.add(planes);
  clocks.add(marks);
  std::uint64_t cycles = 0;
  while (!unit.done() || !planes.done() || !bench.bus.done()) {
    if (marks.valid()) marks.pop();
    bench.step({&unit, &planes}, clocks);
    if (++cycles > 1000000) break;
  }
  records = bench.words(at, 4 * (leaves.size() - 1));
  return cycles;
}

TEST(RtlInternalNode, WithItsPlanesTakesTheModelsCycles) {
  for (const int depth : {12, 14, 20, 30}) {
    const Grid grid({{-1, 0, 5}, {3, 1, 5.5f}}, AxisSchedule::longest, depth);
    const std::vector<std::uint32_t> leaves = random_leaves(3000, depth, 2);
    std::vector<std::uint32_t> rtl_records, model_records;
    const auto rtl = static_cast<double>(rtl_cycles(leaves, grid, rtl_records));
    const auto model = static_cast<double>(model_cycles(leaves, grid, model_records));
    // The model's includes its memory's latency, once for codes and once for nodes.
    EXPECT_NEAR(rtl, model, 40 + 0.005 * model) << depth;
    EXPECT_EQ(rtl_records, model_records);
  }
}

}  // namespace
}  // namespace fasttree::rtl
