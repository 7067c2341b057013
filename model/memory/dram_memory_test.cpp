// SPDX-License-Identifier: Apache-2.0
#include "model/memory/dram_memory.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "model/memory/command_checker.h"
#include "model/memory/command_trace.h"

namespace fasttree::model {
namespace {

constexpr std::uint64_t kTck = 1250;

MemoryConfig lpddr3(const char* preset = "lpddr3-1600") {
  return memory_preset(preset).value();
}

/// Takes what is there; advances until nothing is left.
std::vector<MemoryCompletion> drain(Memory& memory, Picoseconds now) {
  std::vector<MemoryCompletion> all;
  for (std::uint64_t i = 0; !memory.idle(); ++i) {
    EXPECT_LT(i, 1000000u) << memory.waits_for();
    if (i >= 1000000) break;
    memory.advance(now);
    for (MemoryCompletion completion; memory.take(completion);) all.push_back(completion);
    now += Picoseconds(kTck);
  }
  return all;
}

TEST(DramMemory, ReadOfAClosedBankTakesActivateLatencyAndBurst) {
  DramMemory memory(lpddr3());
  memory.advance(Picoseconds(0));
  memory.accept({Address(0), 32, false, 7}, Picoseconds(0));
  EXPECT_NE(memory.waits_for().find("bank 0"), std::string::npos);
  const auto done = drain(memory, Picoseconds(0));
  ASSERT_EQ(done.size(), 1u);
  EXPECT_EQ(done[0].tag, 7u);
  // The clock after acceptance, tRCD, CL, four clocks of data.
  EXPECT_EQ(done[0].at.value, (1 + 15 + 12 + 4) * kTck);
  EXPECT_EQ(memory.statistics().row_misses, 1u);
  EXPECT_EQ(memory.waits_for(), "");
}

TEST(DramMemory, HitMissAndConflictAreTold) {
  DramMemory memory(lpddr3());
  Picoseconds now;
  // Same row, then the bank's next row: with the hash, row 1 of bank 0 is where row 0 of bank 1
  // would be next.
  const AddressMap map(lpddr3().dram, lpddr3().controller);
  std::uint64_t other = 0;
  while (map.locate(Address(other)).bank != 0 || map.locate(Address(other)).row != 1) other += 32;
  for (const std::uint64_t address : {std::uint64_t{0}, std::uint64_t{32}, other}) {
    memory.accept({Address(address), 32, false, 0}, now);
    drain(memory, now);
    now += Picoseconds(100 * kTck);
    memory.advance(now);
  }
  EXPECT_EQ(memory.statistics().row_misses, 1u);
  EXPECT_EQ(memory.statistics().row_hits, 1u);
  EXPECT_EQ(memory.statistics().row_conflicts, 1u);
}

TEST(DramMemory, QueueHasItsDepthByDirection) {
  MemoryConfig config = lpddr3();
  config.controller.read_queue = 3;
  config.controller.write_queue = 2;
  config.controller.write_drain_high = 2;
  config.controller.write_drain_low = 0;
  DramMemory memory(config);
  for (std::uint32_t i = 0; i < 3; ++i) {
    ASSERT_TRUE(memory.ready(Address(0), false));
    memory.accept({Address(32 * i), 32, false, 0}, Picoseconds(0));
  }
  EXPECT_FALSE(memory.ready(Address(0), false));
  for (std::uint32_t i = 0; i < 2; ++i) {
    ASSERT_TRUE(memory.ready(Address(0), true));
    memory.accept({Address(4096 + 32 * i), 32, true, 0}, Picoseconds(0));
  }
  EXPECT_FALSE(memory.ready(Address(0), true));
  EXPECT_EQ(drain(memory, Picoseconds(0)).size(), 5u);
}

TEST(DramMemory, IdleDeviceIsRefreshed) {
  for (const RefreshPolicy policy :
       {RefreshPolicy::none, RefreshPolicy::all_bank, RefreshPolicy::per_bank}) {
    MemoryConfig config = lpddr3();
    config.controller.refresh = policy;
    CommandChecker checker(config.dram, config.controller);
    DramMemory memory(config);
    memory.observe(&checker);
    memory.advance(Picoseconds(3120 * 100 * kTck));
    checker.finish(3120 * 100);
    EXPECT_EQ(checker.violation_count(), 0u);
    const std::uint64_t expected = policy == RefreshPolicy::none       ? 0
                                   : policy == RefreshPolicy::all_bank ? 100
                                                                       : 800;
    EXPECT_EQ(memory.statistics().refreshes, expected);
  }
}

/// A stream of row hits that never ends, and one request for another row of the same bank: how long
/// the latter takes, in clocks.
std::uint64_t wait_beside_hits(std::uint32_t starvation_clocks) {
  MemoryConfig config = lpddr3();
  config.controller.starvation_clocks = starvation_clocks;
  config.controller.bank_hash = false;
  config.controller.refresh = RefreshPolicy::none;
  DramMemory memory(config);
  Picoseconds now;
  std::uint64_t hits = 0;
  const auto stream = [&] {
    while (memory.ready(Address(0), false)) {
      memory.accept({Address(hits++ * 32 % 4096), 32, false, 0}, now);
    }
  };
  memory.accept({Address(0), 32, false, 0}, now);
  for (int i = 0; i < 40; ++i) {  // the row is open, then the other request comes
    now += Picoseconds(kTck);
    memory.advance(now);
  }
  memory.accept({Address(32768), 32, false, 1}, now);
  const Picoseconds begin = now;
  for (std::uint64_t clock = 0; clock < 20000; ++clock) {
    memory.advance(now);
    for (MemoryCompletion completion; memory.take(completion);) {
      if (completion.tag == 1) return (completion.at - begin).value / kTck;
    }
    stream();
    now += Picoseconds(kTck);
  }
  return 20000;
}

TEST(DramMemory, RowHitsOvertakeNoLongerThanTheBound) {
  // What comes after the bound: precharge, activate, read, data.
  constexpr std::uint64_t kService = 15 + 15 + 12 + 4 + 8;
  const std::uint64_t short_wait = wait_beside_hits(200);
  EXPECT_GT(short_wait, 200u);
  EXPECT_LE(short_wait, 200 + kService);
  const std::uint64_t long_wait = wait_beside_hits(5000);
  EXPECT_GT(long_wait, 5000u);
  EXPECT_LE(long_wait, 5000 + kService);
}

TEST(DramMemory, WritesAreNotHeldBackByReadsForEver) {
  MemoryConfig config = lpddr3();
  config.controller.starvation_clocks = 300;
  DramMemory memory(config);
  CommandRecorder trace(100000);
  memory.observe(&trace);
  Picoseconds now;
  memory.accept({Address(1 << 20), 32, true, 0}, now);  // one: far below the watermark
  std::uint64_t next = 0;
  for (int clock = 0; clock < 1000; ++clock) {
    memory.advance(now);
    for (MemoryCompletion completion; memory.take(completion);) {
    }
    while (memory.ready(Address(0), false)) {
      memory.accept({Address(next++ * 32), 32, false, 0}, now);
    }
    now += Picoseconds(kTck);
  }
  std::uint64_t written = 0;
  for (const DramCommand& command : trace.commands()) {
    if (command.kind == DramCommandKind::write) written = command.clock;
  }
  EXPECT_GT(written, 300u);
  EXPECT_LT(written, 400u);
}

/// A random memory that validate() accepts.
MemoryConfig random_config() {
  MemoryConfig config = lpddr3();
  DramSpec& d = config.dram;
  const auto number = [](std::uint32_t least, std::uint32_t most) {
    return *rc::gen::inRange<std::uint32_t>(least, most + 1);
  };
  d.channels = 1u << number(0, 2);
  d.banks = 1u << number(0, 4);
  d.cl = number(5, 20);
  d.cwl = number(2, 12);
  d.trcd = number(1, 20);
  d.trp = number(1, 20);
  d.tras = number(d.trcd, 50);
  d.trc = number(d.tras, 80);
  d.trrd = number(1, 12);
  d.tfaw = number(1, 60);
  d.twtr = number(1, 12);
  d.twr = number(1, 20);
  d.trtp = number(1, 10);
  d.tccd = number(4, 8);
  d.trtw_gap = number(2, 4);
  ControllerConfig& c = config.controller;
  c.read_queue = number(1, 64);
  c.write_queue = number(1, 64);
  c.write_drain_high = number(1, c.write_queue);
  c.write_drain_low = number(0, c.write_drain_high - 1);
  c.write_idle_clocks = number(0, 50);
  c.starvation_clocks = number(1, 2000);
  c.refresh =
      *rc::gen::element(RefreshPolicy::none, RefreshPolicy::all_bank, RefreshPolicy::per_bank);
  d.trefi = 3200;
  d.trfc_pb = number(10, 90);
  c.refresh_postpone = number(0, 8);
  c.bank_hash = *rc::gen::arbitrary<bool>();
  c.interleave = *rc::gen::element(Interleave::burst, Interleave::row);
  c.address_order = *rc::gen::element(AddressOrder::row_bank_column, AddressOrder::bank_row_column);
  RC_PRE(validate(config).ok());
  return config;
}

struct Timed {
  MemoryRequest request;
  std::uint64_t gap_ps;  ///< after the request before
};

/// Requests that often meet: few rows, few bursts of each.
std::vector<Timed> random_requests() {
  const auto count = *rc::gen::inRange(1, 600);
  const auto most_gap = *rc::gen::element<std::uint64_t>(1, 3000, 100000);
  const auto spread = *rc::gen::element<std::uint64_t>(4, 64, 4096);
  std::vector<Timed> requests;
  std::uint64_t state = *rc::gen::arbitrary<std::uint64_t>();
  const auto number = [&state](std::uint64_t below) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (state >> 33) % below;
  };
  for (int i = 0; i < count; ++i) {
    const std::uint64_t burst = number(spread) * 32 + number(4) * 65536;
    requests.push_back(
        {{Address(burst), 32, number(2) == 0, static_cast<std::uint32_t>(i)}, number(most_gap)});
  }
  return requests;
}

struct Outcome {
  std::vector<std::tuple<std::uint32_t, bool, std::uint64_t>> completions;
  std::vector<DramCommand> commands;
  std::uint64_t end_clock = 0;
};

/// Between acceptances the time moves by `step_ps` at most.
Outcome run(DramMemory& memory, const std::vector<Timed>& requests, std::uint64_t step_ps) {
  Outcome outcome;
  CommandRecorder recorder(1000000);
  memory.observe(&recorder);
  Picoseconds now;
  const auto advance_to = [&](Picoseconds then) {
    do {
      now = std::min(then, now + Picoseconds(step_ps));
      memory.advance(now);
      for (MemoryCompletion c; memory.take(c);) {
        RC_ASSERT(c.at <= now);
        outcome.completions.emplace_back(c.tag, c.write, c.at.value);
      }
    } while (now < then);
  };
  for (const Timed& timed : requests) {
    advance_to(now + Picoseconds(timed.gap_ps));
    for (int i = 0; !memory.ready(timed.request.address, timed.request.write); ++i) {
      RC_ASSERT(i < 100000);
      advance_to(Picoseconds((now.value / kTck + 1) * kTck));
    }
    memory.accept(timed.request, now);
  }
  for (int i = 0; !memory.idle(); ++i) {
    RC_ASSERT(i < 100000);
    advance_to(Picoseconds((now.value / kTck + 1) * kTck));
  }
  memory.observe(nullptr);
  outcome.commands = recorder.commands();
  outcome.end_clock = now.value / kTck;
  return outcome;
}

RC_GTEST_PROP(DramMemory, KeepsEveryRuleAndCompletesEveryRequestOnce, ()) {
  const MemoryConfig config = random_config();
  const std::vector<Timed> requests = random_requests();
  DramMemory memory(config);
  const Outcome outcome = run(memory, requests, 1 << 30);

  CommandChecker checker(config.dram, config.controller);
  for (const DramCommand& command : outcome.commands) checker.on_command(command);
  checker.finish(outcome.end_clock);
  if (checker.violation_count() > 0) RC_FAIL(checker.violations()[0].text);

  std::set<std::uint32_t> tags;
  for (const auto& [tag, write, at] : outcome.completions) {
    RC_ASSERT(tags.insert(tag).second);
    RC_ASSERT(requests[tag].request.write == write);
  }
  RC_ASSERT(tags.size() == requests.size());
  const MemoryStatistics& s = memory.statistics();
  RC_ASSERT(s.reads + s.writes == requests.size());
  RC_ASSERT(s.row_hits + s.row_misses + s.row_conflicts == requests.size());
}

RC_GTEST_PROP(DramMemory, SameBytesInTheOrderOfAcceptance, ()) {
  const MemoryConfig config = random_config();
  const std::vector<Timed> requests = random_requests();
  DramMemory memory(config);
  const Outcome outcome = run(memory, requests, 1 << 30);

  // By burst of memory, the string of reads and writes; reads in a row may change places.
  using Place = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>;
  std::map<Place, std::string> asked, issued;
  const AddressMap map(config.dram, config.controller);
  for (const Timed& timed : requests) {
    const DramLocation at = map.locate(timed.request.address);
    asked[{at.channel, at.bank, at.row, at.column}] += timed.request.write ? 'w' : 'r';
  }
  for (const DramCommand& command : outcome.commands) {
    if (command.kind != DramCommandKind::read && command.kind != DramCommandKind::write) continue;
    issued[{command.channel, command.bank, command.row, command.column}] +=
        command.kind == DramCommandKind::write ? 'w' : 'r';
  }
  RC_ASSERT(asked == issued);
}

RC_GTEST_PROP(DramMemory, ResultDoesNotDependOnHowOftenItIsAdvanced, ()) {
  const MemoryConfig config = random_config();
  const std::vector<Timed> requests = random_requests();
  DramMemory leaping(config);
  DramMemory walking(config);
  const Outcome a = run(leaping, requests, 1 << 30);
  const Outcome b = run(walking, requests, 311);
  RC_ASSERT(a.commands.size() == b.commands.size());
  for (std::size_t i = 0; i < a.commands.size(); ++i) {
    // Channels are carried out one after the other, so only their own order is fixed.
    if (config.dram.channels > 1) break;
    RC_ASSERT(to_line(a.commands[i]) == to_line(b.commands[i]));
  }
  std::set<std::tuple<std::uint32_t, bool, std::uint64_t>> sa(a.completions.begin(),
                                                              a.completions.end());
  std::set<std::tuple<std::uint32_t, bool, std::uint64_t>> sb(b.completions.begin(),
                                                              b.completions.end());
  RC_ASSERT(sa == sb);
}

TEST(CommandTraceTest, WritesALineACommand) {
  std::string text;
  CommandTrace trace([&text](std::string_view piece) { text += piece; });
  trace.on_command({12, DramCommandKind::read, 1, 3, 77, 8});
  trace.finish();
  EXPECT_EQ(text, "# clock channel command bank row column\n12 1 RD 3 77 8\n");
}

}  // namespace
}  // namespace fasttree::model
