// SPDX-License-Identifier: Apache-2.0
// Controllers that are broken on purpose: each keeps a specification with one rule too short, and
// the checker, which knows the true one, has to name that rule.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "model/memory/command_checker.h"
#include "model/memory/dram_memory.h"
#include "model/memory/measure.h"

namespace fasttree::model {
namespace {

struct Fault {
  const char* name;
  const char* rule;
  void (*breaks)(MemoryConfig&);
};

void PrintTo(const Fault& fault, std::ostream* out) {
  *out << fault.name;
}

class FaultInjection : public testing::TestWithParam<Fault> {};

MemoryConfig true_config() {
  MemoryConfig config = memory_preset("lpddr3-1600").value();
  // tRC is tRAS and tRP together in the preset, and would hide behind them.
  config.dram.trc = 60;
  return config;
}

/// All kinds of load, under the eyes of a checker that knows `truth`.
CommandChecker run(const MemoryConfig& used, const MemoryConfig& truth) {
  CommandChecker checker(truth.dram, truth.controller);
  DramMemory memory(used);
  memory.observe(&checker);
  Picoseconds now;
  std::uint64_t seed = 1;
  // Reads, then writes, then both, with long rows and short ones; in one run of time.
  for (const AccessPattern pattern :
       {AccessPattern::random, AccessPattern::mixed, AccessPattern::copy}) {
    for (const std::uint32_t bytes : {32u, 256u}) {
      std::uint64_t random = seed++;
      for (std::uint32_t i = 0; i < 20000;) {
        memory.advance(now);
        for (MemoryCompletion completion; memory.take(completion);) {
        }
        MemoryRequest request;
        request.bytes = 32;
        const std::uint64_t access = i / (bytes / 32);
        random = (access + seed * 1000003) * 0x9e3779b97f4a7c15u;
        request.write = pattern == AccessPattern::mixed ? (random >> 60) % 2 == 0
                                                        : pattern == AccessPattern::copy && i % 2;
        const std::uint64_t base = pattern == AccessPattern::copy
                                       ? access * bytes + (request.write ? 1 << 24 : 0)
                                       : (random >> 20) % (1 << 28) / bytes * bytes;
        request.address = Address(base + i % (bytes / 32) * 32);
        if (memory.ready(request.address, request.write)) {
          memory.accept(request, now);
          ++i;
        } else {
          now += Picoseconds(1250);
        }
      }
    }
  }
  while (!memory.idle()) {
    now += Picoseconds(1250);
    memory.advance(now);
    for (MemoryCompletion completion; memory.take(completion);) {
    }
  }
  checker.finish(now.value / truth.dram.tck_ps);
  return checker;
}

TEST(FaultInjectionTest, ASoundControllerIsNotAccused) {
  const CommandChecker checker = run(true_config(), true_config());
  EXPECT_GT(checker.commands(), 100000u);
  EXPECT_EQ(checker.violation_count(), 0u) << checker.violations()[0].text;
}

TEST_P(FaultInjection, IsCaught) {
  MemoryConfig broken = true_config();
  GetParam().breaks(broken);
  const CommandChecker checker = run(broken, true_config());
  EXPECT_GT(checker.violation_count(), 0u);
  EXPECT_TRUE(std::any_of(checker.violations().begin(), checker.violations().end(),
                          [](const CommandViolation& v) { return v.rule == GetParam().rule; }));
}

INSTANTIATE_TEST_SUITE_P(
    Lpddr3, FaultInjection,
    testing::Values(
        Fault{"EarlyRead", "tRCD", [](MemoryConfig& c) { --c.dram.trcd; }},
        Fault{"EarlyPrecharge", "tRAS", [](MemoryConfig& c) { --c.dram.tras; }},
        Fault{"EarlyActivate", "tRP", [](MemoryConfig& c) { --c.dram.trp; }},
        Fault{"ShortRowCycle", "tRC", [](MemoryConfig& c) { --c.dram.trc; }},
        Fault{"ActivatesTooClose", "tRRD", [](MemoryConfig& c) { --c.dram.trrd; }},
        Fault{"NoWindowOfActivates", "tFAW", [](MemoryConfig& c) { c.dram.tfaw = 1; }},
        Fault{"ReadTooSoonAfterWrite", "tWTR", [](MemoryConfig& c) { --c.dram.twtr; }},
        Fault{"WriteTooSoonAfterRead", "read to write", [](MemoryConfig& c) { --c.dram.trtw_gap; }},
        Fault{"NoWriteRecovery", "tWR", [](MemoryConfig& c) { --c.dram.twr; }},
        Fault{"PrechargeTooSoonAfterRead", "tRTP", [](MemoryConfig& c) { --c.dram.trtp; }},
        Fault{"BurstsOverlap", "data bus", [](MemoryConfig& c) { --c.dram.tccd; }},
        Fault{"ShortRefresh", "tRFCpb", [](MemoryConfig& c) { --c.dram.trfc_pb; }},
        Fault{"RareRefresh", "tREFI", [](MemoryConfig& c) { c.dram.trefi *= 2; }},
        Fault{"NoRefresh", "tREFI",
              [](MemoryConfig& c) { c.controller.refresh = RefreshPolicy::none; }}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace fasttree::model
