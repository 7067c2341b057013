// SPDX-License-Identifier: Apache-2.0
// The leaf table against the reference, under random stimuli and back-pressure, and the cycles
// against the model's.
#include "model/units/leaf_node.h"

#include <gtest/gtest.h>

#include "Vleaf_node_16.h"
#include "Vleaf_node_64.h"
#include "Vleaf_node_8.h"
#include "Vleaf_node_small.h"
#include "model/units/unit_bench.h"
#include "reference/leaf_node.h"
#include "rtl/bench/bench.h"
#include "rtl/bench/write_memory.h"

namespace fasttree::rtl {
namespace {

constexpr std::uint32_t kLeafCodes = 0x1000, kRows = 0x80000;

struct Table {
  std::vector<std::uint32_t> codes, rows;
  std::uint32_t leaves = 0;
  bool overflow = false;
  std::uint64_t cycles = 0, busy = 0, stalled_reading = 0, stalled_writing = 0;
};

template <typename Model>
Table run(Bench<Model>& bench, const std::vector<std::uint32_t>& codes, std::size_t bus_bytes,
          std::uint32_t block_bytes, unsigned in, unsigned out,
          std::uint32_t capacity = 0xffffffff) {
  auto& unit = bench.unit;
  unit.rd_valid = 0;
  unit.references = static_cast<std::uint32_t>(codes.size());
  unit.leaf_codes = kLeafCodes;
  unit.leaf_rows = kRows;
  unit.leaf_capacity = capacity;
  unit.start = 1;
  bench.settle();
  EXPECT_TRUE(unit.done);
  bench.cycle();
  unit.start = 0;
  bench.settle();
  EXPECT_FALSE(unit.done);
  WriteMemory code_memory(block_bytes), row_memory(block_bytes);
  Table table;
  for (std::size_t at = 0; !unit.done; ++table.cycles) {
    if (table.cycles > 1000000) {
      ADD_FAILURE() << "not done";
      break;
    }
    if (!unit.rd_valid && bench.chance(in)) {
      // Beats behind the last one belong to nobody; the unit takes none.
      unit.rd_valid = 1;
      for (std::size_t i = 0; i < bus_bytes / 4; ++i) {
        set_word(unit.rd_data, i, at + i < codes.size() ? codes[at + i] : bench.random());
      }
    }
    unit.wr_code_ready = bench.chance(out);
    unit.wr_row_ready = bench.chance(out);
    bench.settle();
    code_memory.look(unit.wr_code_valid, unit.wr_code_ready, unit.wr_code_addr, unit.wr_code_bytes,
                     unit.wr_code_data);
    row_memory.look(unit.wr_row_valid, unit.wr_row_ready, unit.wr_row_addr, unit.wr_row_bytes,
                    unit.wr_row_data);
    EXPECT_GE(unit.activity, 1);
    EXPECT_LE(unit.activity, 3);
    ++(unit.activity == 1   ? table.busy
       : unit.activity == 2 ? table.stalled_reading
                            : table.stalled_writing);
    const bool taken = unit.rd_valid && unit.rd_ready;
    bench.cycle();
    if (taken) {
      at += bus_bytes / 4;
      unit.rd_valid = 0;
    }
    bench.settle();
    if (unit.done) {
      EXPECT_GE(at, codes.size());
      EXPECT_LT(at, codes.size() + bus_bytes / 4);
    }
  }
  EXPECT_EQ(unit.activity, 0);
  table.codes = code_memory.run_from(kLeafCodes);
  table.rows = row_memory.run_from(kRows);
  table.leaves = unit.leaves;
  table.overflow = unit.overflow;
  return table;
}

/// Runs of codes: a code in `percent` of a hundred is a new one.
template <typename Model>
std::vector<std::uint32_t> random_codes(Bench<Model>& bench, std::size_t count, unsigned percent) {
  std::vector<std::uint32_t> codes;
  std::uint32_t code = bench.random() % 3;
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0 && bench.chance(percent)) code += 1u << bench.random() % 12;
    codes.push_back(code);
  }
  return codes;
}

struct Expected {
  explicit Expected(const std::vector<std::uint32_t>& sorted, std::size_t most = SIZE_MAX) {
    reference::References references;
    references.codes = sorted;
    references.ids.resize(sorted.size());
    const reference::LeafTable table = reference::leaf_node(references);
    for (std::size_t j = 0; j < std::min(most, table.code.size()); ++j) {
      codes.push_back(table.code[j]);
      rows.insert(rows.end(), {table.first[j], table.count[j]});
    }
  }
  std::vector<std::uint32_t> codes, rows;
};

template <typename Model>
void makes_the_table(std::size_t bus_bytes, std::uint32_t block_bytes, std::size_t width) {
  Bench<Model> bench(static_cast<std::uint32_t>(bus_bytes + block_bytes));
  for (int i = 0; i < 1500; ++i) {
    // Often about whole blocks.
    std::size_t count = 1 + bench.random() % (10 * width);
    if (bench.chance(50)) count = (1 + bench.random() % 5) * width + bench.random() % 3 - 1;
    const unsigned densities[] = {0, 3, 30, 70, 100};
    const std::vector<std::uint32_t> codes =
        random_codes(bench, count, densities[bench.random() % 5]);
    const unsigned in = bench.chance(50) ? 100 : 40, out = bench.chance(50) ? 100 : 15;
    const Table table = run(bench, codes, bus_bytes, block_bytes, in, out);
    const Expected expected(codes);
    ASSERT_EQ(table.codes, expected.codes) << i;
    ASSERT_EQ(table.rows, expected.rows) << i;
    ASSERT_EQ(table.leaves, expected.codes.size());
    ASSERT_FALSE(table.overflow);
  }
  EXPECT_EQ(bench.failed_assertions(), 0);
}

TEST(RtlLeafNode, MakesTheReferencesTable) {
  makes_the_table<Vleaf_node_16>(16, 64, 32);
}
TEST(RtlLeafNode, MakesTheReferencesTableOnOtherBuses) {
  makes_the_table<Vleaf_node_8>(8, 64, 32);
  makes_the_table<Vleaf_node_64>(64, 64, 32);
}
TEST(RtlLeafNode, MakesTheReferencesTableWithFewCodesAndASmallPool) {
  makes_the_table<Vleaf_node_small>(16, 16, 8);
}

TEST(RtlLeafNode, GivesAnEmptySceneAnEmptyRow) {
  Bench<Vleaf_node_16> bench;
  const Table table = run(bench, {}, 16, 64, 100, 50);
  EXPECT_TRUE(table.codes.empty());
  EXPECT_EQ(table.rows, (std::vector<std::uint32_t>{0, 0}));
  EXPECT_EQ(table.leaves, 0u);
  EXPECT_FALSE(table.overflow);
}

TEST(RtlLeafNode, WritesNothingBeyondTheTableAndEnds) {
  Bench<Vleaf_node_16> bench(9);
  for (int i = 0; i < 400; ++i) {
    const std::vector<std::uint32_t> codes = random_codes(bench, 1 + bench.random() % 200, 60);
    const std::size_t leaves = Expected(codes).codes.size();
    const std::size_t capacity = bench.random() % (leaves + 3);
    const Table table = run(bench, codes, 16, 64, 80, 60, static_cast<std::uint32_t>(capacity));
    const Expected expected(codes, capacity);
    ASSERT_EQ(table.codes, expected.codes);
    ASSERT_EQ(table.rows, expected.rows);
    ASSERT_EQ(table.overflow, leaves > capacity);
    ASSERT_EQ(table.leaves, std::min(leaves, capacity));
  }
  const Table none = run(bench, {}, 16, 64, 100, 100, 0);
  EXPECT_TRUE(none.rows.empty());
  EXPECT_TRUE(none.overflow);
}

std::uint64_t model_cycles(const std::vector<std::uint32_t>& codes) {
  model::PaperConfig config;
  config.bus.duplex = true;  // rows do not take the codes' turns
  model::test::UnitBench bench(config);
  bench.put(model::Address(0), codes);
  model::LeafNodeUnit unit(config, bench.bus.add_port("read"), bench.bus.add_port("codes"),
                           bench.bus.add_port("rows"));
  unit.start(model::Address(0), codes.size(), model::Address(1 << 18), model::Address(1 << 19));
  return bench.run({&unit});
}

TEST(RtlLeafNode, TakesTheModelsCycles) {
  Bench<Vleaf_node_16> bench;
  for (const unsigned density : {0u, 5u, 15u, 25u, 40u, 70u, 100u}) {
    const std::vector<std::uint32_t> codes = random_codes(bench, 20000, density);
    const Table table = run(bench, codes, 16, 64, 100, 100);
    const auto model = static_cast<double>(model_cycles(codes));
    EXPECT_NEAR(static_cast<double>(table.cycles), model, 40 + 0.01 * model) << density;
  }
}

TEST(RtlLeafNode, SaysWhatItWaitsFor) {
  Bench<Vleaf_node_16> bench;
  const Table starved = run(bench, std::vector<std::uint32_t>(4000, 7), 16, 64, 10, 100);
  EXPECT_GT(starved.stalled_reading, 4 * starved.busy);
  EXPECT_LT(starved.stalled_writing, 10u);
  const Table blocked = run(bench, random_codes(bench, 4000, 100), 16, 64, 100, 2);
  EXPECT_GT(blocked.stalled_writing, blocked.busy);
  EXPECT_EQ(blocked.stalled_reading, 0u);
}

}  // namespace
}  // namespace fasttree::rtl
