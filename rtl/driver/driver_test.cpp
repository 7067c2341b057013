// SPDX-License-Identifier: Apache-2.0
// The driver in C against registers that take everything down: what it writes, in which order, and
// what it plans.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "rtl/driver/example.h"
#include "tests/support/meshes.h"

namespace fasttree {
namespace {

/// Registers that are memory, but for CONTROL.
struct Registers {
  std::map<std::uint32_t, std::uint32_t> words{{FT_ACCEL_ID, FT_ACCEL_ID_VALUE},
                                               {FT_ACCEL_VERSION, 1}};
  std::vector<std::pair<std::uint32_t, std::uint32_t>> writes;
  std::vector<std::uint32_t> errors;  ///< of the builds to come
  std::uint32_t busy_reads = 0;       ///< so often STATUS says busy after a start
  int waits = 0;

  ft_accel driver() {
    return {this, [](void* r, std::uint32_t reg) { return static_cast<Registers*>(r)->read(reg); },
            [](void* r, std::uint32_t reg, std::uint32_t value) {
              static_cast<Registers*>(r)->write(reg, value);
            }};
  }
  std::uint32_t read(std::uint32_t reg) {
    if (reg == FT_ACCEL_STATUS && busy_reads > 0) {
      --busy_reads;
      return 1;
    }
    return words[reg];
  }
  void write(std::uint32_t reg, std::uint32_t value) {
    writes.emplace_back(reg, value);
    if (reg != FT_ACCEL_CONTROL) {
      words[reg] = value;
    } else if (value == FT_ACCEL_START) {
      busy_reads = 3;
      std::uint32_t error = FT_ACCEL_OK;
      if (!errors.empty()) {
        error = errors.front();
        errors.erase(errors.begin());
      }
      words[FT_ACCEL_STATUS] = (error != FT_ACCEL_OK ? 4 : 2) | error << 8;
    }
  }
};

TEST(Driver, KnowsTheAccelerator) {
  Registers registers;
  const ft_accel device = registers.driver();
  EXPECT_EQ(ft_accel_probe(&device), 0);
  registers.words[FT_ACCEL_VERSION] = 2;
  EXPECT_NE(ft_accel_probe(&device), 0);
  registers.words[FT_ACCEL_VERSION] = 1;
  registers.words[FT_ACCEL_ID] = 0;
  EXPECT_NE(ft_accel_probe(&device), 0);
  EXPECT_TRUE(registers.writes.empty());
}

TEST(Driver, WritesTheOrderThenClearsTheInterruptThenStarts) {
  Registers registers;
  const ft_accel device = registers.driver();
  ft_accel_order order;
  ASSERT_NE(ft_accel_plan(&order, 0x10000000, 100, 600, 8), 0u);
  ft_accel_start(&device, &order);
  // The map of docs/accelerator/integration.md, from TRIANGLES at 0x020 to WATCHDOG at 0x068.
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> expected{{0x020, 100},
                                                                      {0x024, 8},
                                                                      {0x028, 4096},
                                                                      {0x02c, order.scene},
                                                                      {0x030, order.pairs0},
                                                                      {0x034, order.pairs1},
                                                                      {0x038, order.sorted_codes},
                                                                      {0x03c, order.sorted_ids},
                                                                      {0x040, order.leaf_codes},
                                                                      {0x044, order.leaf_rows},
                                                                      {0x048, order.marks},
                                                                      {0x04c, order.nodes},
                                                                      {0x050, 600},
                                                                      {0x054, 256},
                                                                      {0x058, 64},
                                                                      {0x05c, 8},
                                                                      {0x060, 0x10000000},
                                                                      {0x064, order.window_end},
                                                                      {0x068, 1u << 20},
                                                                      {0x01c, 1},
                                                                      {0x010, 1}};
  EXPECT_EQ(registers.writes, expected);
}

TEST(Driver, ReadsWhatStandsInTheMap) {
  Registers registers;
  const ft_accel device = registers.driver();
  for (std::uint32_t i = 0; i < 27; ++i) registers.words[0x080 + 4 * i] = 1000 + i;
  ft_accel_result result;
  ft_accel_read_result(&device, &result);
  EXPECT_EQ(result.references, 1000u);
  EXPECT_EQ(result.root, 1002u);              // 0x088
  EXPECT_EQ(result.lower[0], 1004u);          // 0x090
  EXPECT_EQ(result.error_detail, 1010u);      // 0x0a8
  EXPECT_EQ(result.stage_cycles[0], 1013u);   // 0x0b4
  EXPECT_EQ(result.read_beats, 1019u);        // 0x0cc
  EXPECT_EQ(result.climb_steps, 1021u);       // 0x0d4
  EXPECT_EQ(result.mark_write_backs, 1026u);  // 0x0e8
  registers.words[FT_ACCEL_STATUS] = 0x354;
  EXPECT_EQ(ft_accel_busy(&device), 0);
  EXPECT_EQ(ft_accel_stage(&device), 5u);
  EXPECT_EQ(ft_accel_error(&device), 3u);
  ft_accel_cancel(&device);
  ft_accel_flush(&device);
  EXPECT_EQ(registers.writes,
            (std::vector<std::pair<std::uint32_t, std::uint32_t>>{{0x010, 2}, {0x010, 4}}));
}

TEST(Driver, PlansRegionsBehindEachOther) {
  test::Random random(3);
  int planned = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::uint32_t base = random.below(1u << 20) << 12;
    const std::uint32_t triangles = random.below(1u << random.below(29));
    const std::uint32_t references = random.below(1u << random.below(30));
    const std::uint32_t depth = random.below(5) > 0 ? random.below(32) : random.below(256);
    ft_accel_order order;
    const std::uint64_t bytes = ft_accel_plan(&order, base, triangles, references, depth);
    if (bytes == 0) continue;
    ++planned;
    ASSERT_LE(depth, 30u);
    ASSERT_LE(base + bytes, std::uint64_t{1} << 32);
    const std::uint64_t leaves =
        std::max<std::uint64_t>(1, std::min<std::uint64_t>(references, std::uint64_t{1} << depth));
    const std::pair<std::uint32_t, std::uint64_t> regions[] = {
        {order.scene, 36 * std::uint64_t{triangles}},
        {order.pairs0, 8 * std::uint64_t{references}},
        {order.pairs1, 8 * std::uint64_t{references}},
        {order.sorted_codes, 4 * std::uint64_t{references}},
        {order.sorted_ids, 4 * std::uint64_t{references}},
        {order.leaf_codes, 4 * leaves},
        {order.leaf_rows, 8 * leaves},
        {order.marks, (std::uint64_t{2} << depth) / 8},
        {order.nodes, 16 * leaves}};
    std::uint64_t end = base;
    for (const auto& [at, size] : regions) {
      ASSERT_EQ(at, end) << i;
      ASSERT_EQ(at % 4096, 0u);
      end += (std::max<std::uint64_t>(size, 1) + 4095) / 4096 * 4096;
    }
    ASSERT_EQ(end, base + bytes);
    ASSERT_EQ(order.window_begin, base);
    ASSERT_EQ(order.window_end, static_cast<std::uint32_t>(end));
    ASSERT_EQ(order.reference_capacity, references);
    ASSERT_EQ(order.leaf_capacity, leaves);
    ASSERT_GE(order.scene_bytes, 36 * std::uint64_t{triangles});
    ASSERT_GE(order.mark_bytes, std::max<std::uint64_t>(64, (std::uint64_t{2} << depth) / 8));
    ASSERT_GE(4 * order.rounds, depth);
  }
  EXPECT_GT(planned, 5000);
}

TEST(Driver, RefusesPlansThatCannotBe) {
  ft_accel_order order;
  EXPECT_EQ(ft_accel_plan(&order, 4, 1, 6, 2), 0u);
  EXPECT_EQ(ft_accel_plan(&order, 0, 1, 6, 31), 0u);
  EXPECT_EQ(ft_accel_plan(&order, 0, 1, 1u << 29, 2), 0u);
  EXPECT_EQ(ft_accel_plan(&order, 0, 200000000, 6, 2), 0u);
  EXPECT_EQ(ft_accel_plan(&order, 0xfffff000, 1, 6, 2), 0u);
  // To the last byte of the addresses, whose end is written as 0.
  const std::uint64_t bytes = ft_accel_plan(&order, 0, 1, 6, 2);
  ASSERT_NE(bytes, 0u);
  const auto last = static_cast<std::uint32_t>((std::uint64_t{1} << 32) - bytes);
  EXPECT_EQ(ft_accel_plan(&order, last, 1, 6, 2), bytes);
  EXPECT_EQ(order.window_end, 0u);
  EXPECT_EQ(ft_accel_plan(&order, last + 4096, 1, 6, 2), 0u);
}

/// The example's board over the registers above.
ft_board board_of(Registers& registers, std::uint32_t memory_bytes) {
  return {registers.driver(),
          0x1000,
          memory_bytes,
          &registers,
          [](void*, std::uint32_t, const void*, std::size_t) {},
          [](void*, std::uint32_t, void*, std::size_t) {},
          [](void* r) { ++static_cast<Registers*>(r)->waits; }};
}

TEST(DriverExample, LowersTheDepthWhereThereAreTooManyReferences) {
  Registers registers;
  registers.errors = {FT_ACCEL_REFERENCES, FT_ACCEL_REFERENCES};
  const ft_board board = board_of(registers, 1u << 20);
  const std::vector<float> corners(90);
  ft_accel_order order;
  ft_accel_result result;
  EXPECT_EQ(ft_board_build(&board, corners.data(), 10, 9, &order, &result), 0);
  EXPECT_EQ(order.shape, 7u);
  EXPECT_EQ(registers.waits, 9) << "three busy reads a build";
  EXPECT_EQ(std::count(registers.writes.begin(), registers.writes.end(),
                       std::pair<std::uint32_t, std::uint32_t>(FT_ACCEL_CONTROL, FT_ACCEL_START)),
            3);
}

TEST(DriverExample, HandsErrorsOn) {
  Registers registers;
  const ft_board board = board_of(registers, 1u << 20);
  const std::vector<float> corners(90);
  ft_accel_order order;
  ft_accel_result result;
  registers.errors = {FT_ACCEL_NOT_FINITE};
  EXPECT_EQ(ft_board_build(&board, corners.data(), 10, 9, &order, &result), FT_ACCEL_NOT_FINITE);
  const ft_board small = board_of(registers, 4096);
  EXPECT_EQ(ft_board_build(&small, corners.data(), 10, 9, &order, &result), -1);
  registers.words[FT_ACCEL_ID] = 0;
  EXPECT_EQ(ft_board_build(&board, corners.data(), 10, 9, &order, &result), -1);
}

std::string text_of(const std::string& path) {
  std::ifstream file(std::string(FASTTREE_SOURCES) + "/" + path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(DriverExample, IsTheOneOfTheDocumentation) {
  const std::string page = text_of("docs/accelerator/integration.md");
  const std::string mark = "```c\n";
  const std::size_t begin = page.find(mark) + mark.size();
  ASSERT_GT(begin, mark.size());
  const std::string shown = page.substr(begin, page.find("```", begin) - begin);
  EXPECT_NE(shown.find("ft_board_build"), std::string::npos);
  EXPECT_NE(text_of("rtl/driver/example.c").find(shown), std::string::npos) << shown;
}

}  // namespace
}  // namespace fasttree
