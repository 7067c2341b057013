// SPDX-License-Identifier: Apache-2.0
// LPDDR3-1600 against the figures of an independent public simulator (docs/memory_model.md):
// bandwidth within 5 per cent, latency without load within 10.
#include <gtest/gtest.h>

#include "model/memory/command_checker.h"
#include "model/memory/dram_memory.h"
#include "model/memory/measure.h"

namespace fasttree::model {
namespace {

MemoryMeasurement measure(const char* preset, Interleave interleave, AccessPattern pattern,
                          bool write, std::uint32_t bytes, std::uint32_t outstanding) {
  MemoryConfig config = memory_preset(preset).value();
  config.controller.interleave = interleave;
  DramMemory memory(config);
  CommandChecker checker(config.dram, config.controller);
  memory.observe(&checker);
  LoadOptions load;
  load.pattern = pattern;
  load.write = write;
  load.bytes = bytes;
  load.outstanding = outstanding;
  load.accesses = 50000;
  const MemoryMeasurement measured = measure_memory(memory, load).value();
  checker.finish(measured.time.value / config.dram.tck_ps);
  EXPECT_EQ(checker.violation_count(), 0u);
  return measured;
}

constexpr const char* kOne = "lpddr3-1600";
constexpr const char* kTwo = "lpddr3-1600-dual";
constexpr std::uint32_t kMany = 64;

void expect_gb_s(const MemoryMeasurement& measured, double theirs) {
  EXPECT_NEAR(measured.bandwidth_gb_s, theirs, 0.05 * theirs);
}

TEST(MemoryFigures, OneChannel) {
  using enum AccessPattern;
  const Interleave burst = Interleave::burst;
  expect_gb_s(measure(kOne, burst, sequential, false, 32, kMany), 6.23);
  expect_gb_s(measure(kOne, burst, sequential, true, 32, kMany), 6.22);
  expect_gb_s(measure(kOne, burst, copy, false, 32, kMany), 5.80);
  expect_gb_s(measure(kOne, burst, random, false, 64, kMany), 4.95);
}

TEST(MemoryFigures, OneChannelWithoutLoad) {
  const auto measured = measure(kOne, Interleave::burst, AccessPattern::random, false, 64, 1);
  EXPECT_NEAR(measured.latency_ns, 40, 4);
}

TEST(MemoryFigures, TwoChannels) {
  using enum AccessPattern;
  expect_gb_s(measure(kTwo, Interleave::burst, sequential, false, 32, kMany), 12.46);
  expect_gb_s(measure(kTwo, Interleave::burst, random, false, 64, kMany), 4.97);
  expect_gb_s(measure(kTwo, Interleave::row, sequential, false, 32, kMany), 6.47);
  expect_gb_s(measure(kTwo, Interleave::row, random, false, 64, kMany), 9.75);
}

TEST(MemoryFigures, Ddr3OfTheBoardComesNearItsPeak) {
  const auto measured =
      measure("ddr3-1600", Interleave::burst, AccessPattern::sequential, false, 64, kMany);
  EXPECT_GT(measured.bandwidth_gb_s, 0.95 * 12.8);
  EXPECT_LE(measured.bandwidth_gb_s, 12.8);
}

}  // namespace
}  // namespace fasttree::model
