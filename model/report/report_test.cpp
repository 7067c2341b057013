// SPDX-License-Identifier: Apache-2.0
// Reports of runs: what is compared, what is counted, what is escaped.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "model/report/account.h"
#include "model/report/first_difference.h"
#include "model/report/html_report.h"
#include "model/report/simulate.h"
#include "model/report/text.h"
#include "model/report/timeline_json.h"

namespace fasttree::model {
namespace {

struct Soup {
  std::vector<Vec3> points;  ///< three a triangle

  MeshView view() const {
    MeshView mesh;
    mesh.positions = points.data();
    mesh.vertex_count = static_cast<std::uint32_t>(points.size());
    mesh.triangle_count = mesh.vertex_count / 3;
    return mesh;
  }
};

/// A staircase: every triangle in cells of its own.
Soup staircase(std::uint32_t triangles) {
  Soup soup;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const auto x = static_cast<float>(i);
    soup.points.insert(soup.points.end(), {{x, x, 0}, {x + 0.5f, x, 1}, {x, x + 0.5f, 2}});
  }
  return soup;
}

MachineConfig machine(const std::string& name) {
  return load_config(name).value();
}

SimulationResult simulated(const Soup& soup, const MachineConfig& config) {
  SimulationOptions options;
  options.keep_arrays = true;
  Result<SimulationResult> result = simulate(soup.view(), config, options);
  EXPECT_TRUE(result.ok()) << result.status().message();
  return std::move(result).value();
}

TEST(FirstDifference, FindsNoneInARun) {
  const Soup soup = staircase(40);
  for (const char* name : {"paper-asic65", "fasttree-2"}) {
    const MachineConfig config = machine(name);
    EXPECT_EQ(first_difference(soup.view(), config, simulated(soup, config)).value(), "") << name;
  }
}

TEST(FirstDifference, NamesTheArrayAndTheIndex) {
  const Soup soup = staircase(40);
  const MachineConfig config = machine("paper-asic65");
  const SimulationResult good = simulated(soup, config);
  using Array = std::vector<std::uint32_t> IntermediateArrays::*;
  const std::vector<std::pair<const char*, Array>> arrays = {
      {"unsorted_codes", &IntermediateArrays::unsorted_codes},
      {"unsorted_ids", &IntermediateArrays::unsorted_ids},
      {"sorted_codes", &IntermediateArrays::sorted_codes},
      {"sorted_ids", &IntermediateArrays::sorted_ids},
      {"leaf_codes", &IntermediateArrays::leaf_codes},
      {"leaf_first", &IntermediateArrays::leaf_first},
      {"leaf_count", &IntermediateArrays::leaf_count},
      {"mark_words", &IntermediateArrays::mark_words}};
  for (const auto& [name, array] : arrays) {
    SimulationResult bad = good;
    const std::size_t last = (bad.arrays.*array).size() - 1;
    (bad.arrays.*array)[last] ^= 1;
    const std::string found = first_difference(soup.view(), config, bad).value();
    EXPECT_EQ(found.rfind(std::string(name) + "[" + std::to_string(last) + "] ", 0), 0u) << found;
    bad = good;
    (bad.arrays.*array).pop_back();
    EXPECT_NE(first_difference(soup.view(), config, bad).value().find(name), std::string::npos);
    // Without the array there is nothing that could have been compared.
    bad = good;
    (bad.arrays.*array).clear();
    EXPECT_NE(first_difference(soup.view(), config, bad).value(), "") << name;
  }
}

TEST(FirstDifference, LooksAtTheTree) {
  const Soup soup = staircase(40);
  for (const char* name : {"paper-asic65", "fasttree-2"}) {
    const MachineConfig config = machine(name);
    SimulationResult bad = simulated(soup, config);
    std::vector<Node> nodes(bad.tree.nodes().begin(), bad.tree.nodes().end());
    const std::vector<std::uint32_t> ids(bad.tree.ids().begin(), bad.tree.ids().end());
    nodes[2].word1 ^= 1;
    bad.tree = Tree(bad.tree.info(), nodes, ids);
    const std::string found = first_difference(soup.view(), config, bad).value();
    EXPECT_EQ(found.rfind("tree_nodes[2] ", 0), 0u) << name << found;
  }
}

TEST(Account, LatencyPercentilesAreBucketEnds) {
  MemoryStatistics memory;
  EXPECT_FALSE(read_latency_percentile_ns(memory, 0.5).has_value());
  memory.read_latency_8ns = {0, 50, 49, 0, 1};
  EXPECT_EQ(read_latency_percentile_ns(memory, 0.5), 16);
  EXPECT_EQ(read_latency_percentile_ns(memory, 0.51), 24);
  EXPECT_EQ(read_latency_percentile_ns(memory, 0.99), 24);
  EXPECT_FALSE(read_latency_percentile_ns(memory, 1.0).has_value());
}

TEST(Account, WaitsAreSortedAndComplete) {
  UnitRecord unit;
  unit.stall_reasons = {"bus", "cache", "psu"};
  Activity activity;
  activity.stalled_cycles = {3, 0, 7};
  const std::vector<Wait> list = waits(unit, activity);
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0].on, "psu");
  EXPECT_EQ(list[0].cycles, 7u);
  EXPECT_EQ(list[1].on, "bus");
}

TEST(Account, BandwidthIsBytesOverTime) {
  SimulationResult result;
  result.clock_mhz = 500;
  // 25.6 bytes a cycle of 2 ns.
  EXPECT_DOUBLE_EQ(gb_per_s(result, 256, 10), 12.8);
  EXPECT_EQ(gb_per_s(result, 256, 0), 0);
}

RC_GTEST_PROP(ReportText, EscapedTextHasNoMarkup, (const std::string& text)) {
  const std::string escaped = escaped_html(text);
  RC_ASSERT(escaped.find_first_of("<>\"") == std::string::npos);
  for (const char c : escaped) RC_ASSERT(static_cast<unsigned char>(c) >= 0x20);
}

TEST(ReportText, NumbersAreGrouped) {
  EXPECT_EQ(grouped(0), "0");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(1234567), "1,234,567");
  EXPECT_EQ(csv_cell("a,\"b\""), "\"a,\"\"b\"\"\"");
  EXPECT_EQ(percent(1, 0), "-");
}

// A run without timeline, stages or memory traffic has pages and traces all the same.
TEST(Reports, OfNothing) {
  SimulationReport report;
  report.config = machine("paper-asic65");
  report.result.clock_mhz = 500;
  EXPECT_NE(html_report(report).find("</html>"), std::string::npos);
  EXPECT_NE(timeline_json(report).find("traceEvents"), std::string::npos);
}

}  // namespace
}  // namespace fasttree::model
