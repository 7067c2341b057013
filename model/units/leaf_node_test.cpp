// SPDX-License-Identifier: Apache-2.0
#include "model/units/leaf_node.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "model/units/unit_bench.h"
#include "reference/leaf_node.h"

namespace fasttree::model {
namespace {

constexpr Address kCodes(0);
constexpr Address kLeafCodes(1 << 18);
constexpr Address kRows(1 << 19);

struct Table {
  std::vector<std::uint32_t> codes, first, count;
  std::uint64_t cycles = 0;
};

Table run(const PaperConfig& config, const std::vector<std::uint32_t>& codes) {
  test::UnitBench bench(config);
  bench.put(kCodes, codes);
  LeafNodeUnit unit(config, bench.bus.add_port("read"), bench.bus.add_port("codes"),
                    bench.bus.add_port("rows"));
  unit.start(kCodes, codes.size(), kLeafCodes, kRows);
  Table table;
  table.cycles = bench.run({&unit});
  table.codes = bench.words(kLeafCodes, unit.leaves());
  const std::vector<std::uint32_t> rows = bench.words(kRows, 2 * unit.leaves());
  for (std::size_t j = 0; j < unit.leaves(); ++j) {
    table.first.push_back(rows[2 * j]);
    table.count.push_back(rows[2 * j + 1]);
  }
  return table;
}

RC_GTEST_PROP(LeafNodeUnit, MakesTheReferencesTable, ()) {
  PaperConfig config;
  config.leaf_node.width = *rc::gen::inRange(1u, 70u);
  config.leaf_node.pool = *rc::gen::inRange(1u, 100u);
  config.leaf_node.rows_per_cycle = *rc::gen::inRange(1u, 5u);
  config.bus.bytes = 4u << *rc::gen::inRange(0, 5);
  const auto steps =
      *rc::gen::container<std::vector<std::uint8_t>>(rc::gen::weightedOneOf<std::uint8_t>(
          {{3, rc::gen::just<std::uint8_t>(0)}, {1, rc::gen::inRange<std::uint8_t>(1, 9)}}));
  reference::References sorted;
  std::uint32_t code = 0;
  for (const std::uint8_t step : steps) sorted.codes.push_back(code += step);
  sorted.ids.resize(sorted.codes.size());
  const reference::LeafTable expected = reference::leaf_node(sorted);
  const Table table = run(config, sorted.codes);
  RC_ASSERT(table.codes == expected.code);
  RC_ASSERT(table.first == expected.first);
  RC_ASSERT(table.count == expected.count);
}

TEST(LeafNodeUnit, ReadsABusWidthOfCodesACycle) {
  const std::vector<std::uint32_t> codes(40000, 7);
  const Table table = run({}, codes);
  EXPECT_EQ(table.count, std::vector<std::uint32_t>{40000});
  EXPECT_GE(table.cycles, 10000u);
  EXPECT_LE(table.cycles, 10100u);
}

TEST(LeafNodeUnit, GivesAnEmptySceneAnEmptyRow) {
  test::UnitBench bench;
  bench.put(kRows, {1, 2});
  LeafNodeUnit unit({}, bench.bus.add_port("read"), bench.bus.add_port("codes"),
                    bench.bus.add_port("rows"));
  unit.start(kCodes, 0, kLeafCodes, kRows);
  bench.run({&unit});
  EXPECT_EQ(unit.leaves(), 0u);
  EXPECT_EQ(bench.words(kRows, 2), (std::vector<std::uint32_t>{0, 0}));
}

}  // namespace
}  // namespace fasttree::model
