// SPDX-License-Identifier: Apache-2.0
// The common pieces against queues and plain arithmetic, under random stimuli and back-pressure.
#include <gtest/gtest.h>

#include <deque>
#include <map>
#include <vector>

#include "Varbiter.h"
#include "Vblock_writer.h"
#include "Vfifo.h"
#include "Vskid.h"
#include "rtl/bench/bench.h"

namespace fasttree::rtl {
namespace {

// Everything comes out once, in order; what goes in comes out `latency` cycles later at the
// soonest.
template <typename Model>
void pass_through(unsigned in_percent, unsigned out_percent, std::size_t room) {
  Bench<Model> bench(in_percent * 101 + out_percent);
  std::deque<std::uint32_t> held;
  std::uint32_t passed = 0;
  std::size_t most = 0;
  for (int i = 0; i < 200000; ++i) {
    bench.unit.in_valid = bench.chance(in_percent);
    bench.unit.in_data = bench.random() & 0xffff;
    bench.unit.out_ready = bench.chance(out_percent);
    bench.settle();
    const bool in = bench.unit.in_valid && bench.unit.in_ready;
    if (bench.unit.out_valid && bench.unit.out_ready) {
      ASSERT_FALSE(held.empty());
      ASSERT_EQ(bench.unit.out_data, held.front());
      held.pop_front();
      ++passed;
    }
    if (in) held.push_back(bench.unit.in_data);
    ASSERT_LE(held.size(), room);
    most = std::max(most, held.size());
    bench.cycle();
  }
  EXPECT_GT(passed, 10000u);
  if (in_percent > out_percent) {
    EXPECT_EQ(most, room);
  }
  if (in_percent == 100 && out_percent == 100) {
    EXPECT_GE(passed, 199990u);
  }
  EXPECT_EQ(bench.failed_assertions(), 0);
}

TEST(RtlFifo, KeepsOrderAndLosesNothing) {
  for (const auto& [in, out] : {std::pair{100, 100}, {100, 30}, {30, 100}, {60, 60}, {95, 90}}) {
    pass_through<Vfifo>(static_cast<unsigned>(in), static_cast<unsigned>(out), 3);
  }
}

TEST(RtlSkid, KeepsOrderAndLosesNothing) {
  for (const auto& [in, out] : {std::pair{100, 100}, {100, 30}, {30, 100}, {60, 60}, {95, 90}}) {
    pass_through<Vskid>(static_cast<unsigned>(in), static_cast<unsigned>(out), 2);
  }
}

TEST(RtlArbiter, GivesOneOfThoseWhoAskAndLetsNobodyWaitLong) {
  Bench<Varbiter> bench;
  std::vector<int> waited(5);
  for (int i = 0; i < 100000; ++i) {
    // Who has asked goes on asking.
    std::uint32_t request = bench.random() & bench.random() & 31;
    for (int c = 0; c < 5; ++c) request |= waited[static_cast<std::size_t>(c)] > 0 ? 1u << c : 0;
    bench.unit.request = static_cast<std::uint8_t>(request);
    bench.unit.take = bench.chance(80);
    bench.settle();
    const std::uint32_t grant = bench.unit.grant;
    ASSERT_EQ(grant & ~request, 0u);
    ASSERT_EQ(grant & (grant - 1), 0u);
    ASSERT_EQ(grant == 0, request == 0);
    if (bench.unit.take) {
      for (std::size_t c = 0; c < 5; ++c) {
        waited[c] = (request >> c & 1) && !(grant >> c & 1) ? waited[c] + 1 : 0;
        ASSERT_LE(waited[c], 4);
      }
    }
    bench.cycle();
  }
  EXPECT_EQ(bench.failed_assertions(), 0);
}

TEST(RtlBlockWriter, WritesEveryByteOnceInAlignedBlocks) {
  Bench<Vblock_writer> bench;
  for (int run = 0; run < 2000; ++run) {
    const std::uint32_t begin = (bench.random() % 1000) * 8;
    const std::uint32_t items = bench.random() % 40;
    std::map<std::uint32_t, std::uint32_t> words, expected;
    const auto look = [&] {
      if (!bench.unit.wr_valid || !bench.unit.wr_ready) return;
      const std::uint32_t at = bench.unit.wr_addr;
      const std::uint32_t bytes = bench.unit.wr_bytes;
      ASSERT_EQ(at / 32, (at + bytes - 1) / 32);
      for (std::uint32_t b = 0; b < bytes; b += 4) {
        ASSERT_TRUE(words.emplace(at + b, get_word(bench.unit.wr_data, (at + b) % 32 / 4)).second);
      }
    };
    bench.unit.flush = 0;
    bench.unit.put_valid = 0;
    bench.unit.addr = begin;
    bench.unit.start = 1;
    bench.cycle();
    bench.unit.start = 0;
    for (std::uint32_t i = 0; i < items;) {
      bench.unit.put_valid = bench.chance(70);
      const std::uint64_t item = std::uint64_t{bench.random()} << 32 | bench.random();
      bench.unit.put_data = item;
      bench.unit.wr_ready = bench.chance(60);
      bench.settle();
      look();
      if (bench.unit.put_valid && bench.unit.put_ready) {
        expected[begin + i * 8] = static_cast<std::uint32_t>(item);
        expected[begin + i * 8 + 4] = static_cast<std::uint32_t>(item >> 32);
        ++i;
      }
      bench.cycle();
    }
    bench.unit.put_valid = 0;
    bench.unit.flush = 1;
    do {
      bench.unit.wr_ready = bench.chance(60);
      bench.settle();
      look();
      bench.cycle();
      bench.settle();
    } while (bench.unit.holds);
    ASSERT_EQ(words, expected);
  }
}

}  // namespace
}  // namespace fasttree::rtl
