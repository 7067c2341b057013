// SPDX-License-Identifier: Apache-2.0
// The bus against a plain array of bytes: random clients, memories that keep little order, errors,
// requests outside the window, and ends before the end.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "Vbus.h"
#include "Vbus_duplex.h"
#include "Vbus_narrow.h"
#include "Vbus_wide.h"
#include "rtl/system/bus_bench.h"

namespace fasttree::rtl {
namespace {

std::unique_ptr<model::Memory> pipe(std::uint64_t latency_ns, std::uint64_t jitter_ns,
                                    std::size_t queue = 64, std::uint32_t access_bytes = 32) {
  model::test::PipeSettings settings;
  settings.latency_ps = latency_ns * 1000;
  settings.jitter_ps = jitter_ns * 1000;
  settings.queue = queue;
  settings.access_bytes = access_bytes;
  return std::make_unique<model::test::PipeMemory>(settings);
}

/// How willing the sides are, in percent.
struct Mood {
  unsigned clients = 50;
  unsigned stream = 70;
  unsigned cache = 50;
};

/// All clients in one half of the memory, the stream in the other; each client has a region of its
/// own. The cache's is small, so that reads often follow writes to the same place closely.
template <typename Unit>
struct Stage {
  BusBench<Unit>& bus;
  Mood mood;
  std::uint32_t half;

  std::uint32_t region(std::size_t c) const {
    return half + static_cast<std::uint32_t>(c) * (kStoreBytes / 16);
  }
  bool read_under_way(std::uint32_t address) const {
    if (bus.read && *bus.read / 8 == address / 8) return true;
    for (const auto& word : bus.words_to_come) {
      if (word.address / 8 == address / 8) return true;
    }
    return false;
  }
  void cycle() {
    auto& bench = bus.bench;
    for (std::size_t c = 0; c < bus.writes.size(); ++c) {
      if (bus.writes[c] || !bench.chance(mood.clients)) continue;
      const WriteRequest request = bus.random_write(c, region(c), c == kCache ? 128 : 4096);
      if (c != kCache || !read_under_way(request.address)) bus.writes[c] = request;
    }
    if (!bus.read && bench.chance(mood.cache)) {
      const std::uint32_t address = region(kCache) + bench.random() % 16 * 8;
      if (!bus.writes[kCache] || bus.writes[kCache]->address / 8 != address / 8) bus.read = address;
    }
    bench.unit.rd_ready = bench.chance(mood.stream);
    bench.unit.rdd_ready = bench.chance(mood.stream);
    bus.step();
  }
};

template <typename Unit>
void run_stages(std::unique_ptr<model::Memory> memory, const AxiMemoryOptions& options,
                int stages = 24) {
  BusBench<Unit> bus(std::move(memory), options);
  const Mood moods[] = {{50, 70, 50}, {100, 100, 100}, {5, 30, 20}, {30, 100, 0}, {2, 90, 90}};
  for (int s = 0; s < stages; ++s) {
    const std::uint32_t half = s % 2 ? kStoreBytes / 2 : 0;
    Stage<Unit> stage{bus, moods[s % 5], half};
    const std::uint32_t from = (kStoreBytes / 2 - half) + bus.bench.random() % 4 * 4096;
    const std::uint32_t bytes =
        s % 6 == 5 ? 4 * (bus.bench.random() % 40) : 4 * (bus.bench.random() % 4000);
    bus.start_stream(from, bytes);
    for (int i = 0; i < 1500; ++i) stage.cycle();
    bus.bench.unit.rd_ready = bus.bench.unit.rdd_ready = 1;
    ASSERT_TRUE(bus.settle()) << "stage " << s;
    ASSERT_TRUE(bus.axi.idle());
    ASSERT_EQ(bus.wrong, 0) << "stage " << s;
    ASSERT_EQ(bus.stream_left, 0u);
    ASSERT_TRUE(bus.words_to_come.empty());
    ASSERT_TRUE(bus.bench.unit.stream_done);
    ASSERT_TRUE(bus.store_is_as_expected()) << "stage " << s;
  }
  EXPECT_GT(bus.taken_writes, 1000u);
  EXPECT_FALSE(bus.bench.unit.stray);
  EXPECT_FALSE(bus.bench.unit.axi_error);
  EXPECT_EQ(bus.axi.violation(), "");
  EXPECT_EQ(bus.bench.failed_assertions(), 0);
}

template <typename Unit>
void run_memories(std::uint32_t bus_bytes) {
  AxiMemoryOptions options;
  options.bus_bytes = bus_bytes;
  options.clock_mhz = 163;
  for (const char* preset : {"ideal", "fixed", "lpddr3-1600", "lpddr3-1600-dual"}) {
    SCOPED_TRACE(preset);
    run_stages<Unit>(memory_of(preset), options, 10);
  }
  SCOPED_TRACE("pipes");
  run_stages<Unit>(pipe(60, 200), options, 10);
  run_stages<Unit>(pipe(10, 10, 2, 8), options, 10);
  options.wild = true;
  for (options.seed = 1; options.seed < 4; ++options.seed) {
    SCOPED_TRACE("wild");
    run_stages<Unit>(memory_of("ideal"), options);
    run_stages<Unit>(pipe(60, 200), options);
  }
}

TEST(RtlBus, KeepsEveryByte) {
  run_memories<Vbus>(16);
}
TEST(RtlBus, KeepsEveryByteDuplex) {
  run_memories<Vbus_duplex>(16);
}
TEST(RtlBus, KeepsEveryByteNarrow) {
  run_memories<Vbus_narrow>(8);
}
TEST(RtlBus, KeepsEveryByteWide) {
  run_memories<Vbus_wide>(64);
}

TEST(RtlBus, DoesNothingForAnEmptyStream) {
  BusBench<Vbus> bus(memory_of("ideal"), {});
  bus.start_stream(4096, 0);
  for (int i = 0; i < 20; ++i) bus.step();
  EXPECT_TRUE(bus.bench.unit.stream_done);
  EXPECT_TRUE(bus.bench.unit.quiet);
  EXPECT_EQ(bus.bench.unit.read_beats, 0u);
}

TEST(RtlBus, CountsBeats) {
  BusBench<Vbus> bus(memory_of("ideal"), {});
  bus.start_stream(4096, 100);
  bus.writes[2] = bus.random_write(2, 0, 64);
  bus.writes[2]->address = 12;
  bus.writes[2]->bytes = 28;  // of three beats: 4, 16 and 8 bytes
  ASSERT_TRUE(bus.settle());
  EXPECT_EQ(bus.bench.unit.read_beats, 7u);
  EXPECT_EQ(bus.bench.unit.write_beats, 3u);
  bus.bench.unit.clear = 1;
  bus.step();
  EXPECT_EQ(bus.bench.unit.read_beats, 0u);
  EXPECT_EQ(bus.bench.unit.write_beats, 0u);
}

// Whatever is answered with an error, all ends, and the first one is kept.
TEST(RtlBus, EndsAndTellsOfErrors) {
  for (int way = 0; way < 4; ++way) {
    AxiMemoryOptions options;
    options.seed = static_cast<std::uint32_t>(way) + 7;
    options.wild = way % 2 == 1;
    BusBench<Vbus> bus(pipe(20, 50), options);
    Stage<Vbus> stage{bus, {30, 90, 30}, 0};
    if (way == 0) bus.axi.fail_read(9);
    if (way == 1) bus.axi.fail_write(40);
    if (way == 2) bus.axi.refuse(stage.region(3), stage.region(4));
    if (way == 3) bus.axi.refuse(stage.region(kCache), stage.region(7));
    bus.start_stream(kStoreBytes / 2, 8000);
    for (int i = 0; i < 1500; ++i) stage.cycle();
    bus.bench.unit.rd_ready = bus.bench.unit.rdd_ready = 1;
    ASSERT_TRUE(bus.settle());
    EXPECT_TRUE(bus.bench.unit.axi_error);
    if (way == 0) {
      EXPECT_LE(bus.bench.unit.axi_error_id, 1u);
    }
    if (way == 1) {
      EXPECT_GE(bus.bench.unit.axi_error_id, 16u);
    }
    if (way == 2) {
      EXPECT_EQ(bus.bench.unit.axi_error_id, 16u + 3);
    }
    EXPECT_EQ(bus.bench.failed_assertions(), 0);
    bus.bench.unit.clear = 1;
    bus.step();
    EXPECT_FALSE(bus.bench.unit.axi_error);
  }
}

// Notes bursts outside the window.
struct Guard : AxiObserver {
  std::uint32_t begin = 0, end = 0;
  int outside = 0, inside = 0;
  void burst(std::uint32_t address, std::uint32_t bytes, bool, std::uint32_t) override {
    (address >= begin && address + bytes <= end ? inside : outside)++;
  }
};

TEST(RtlBus, KeepsToTheWindow) {
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    AxiMemoryOptions options;
    options.seed = seed;
    options.wild = seed % 2 == 0;
    BusBench<Vbus> bus(pipe(20, 50), options);
    Guard guard;
    guard.begin = 5 * 4096 + 64;                  // in the region of client 2
    guard.end = kStoreBytes / 2 + 3 * 4096 + 64;  // in the stream
    bus.axi.observe(&guard);
    bus.bench.unit.window_begin = guard.begin;
    bus.bench.unit.window_end = guard.end;
    Stage<Vbus> stage{bus, {30, 90, 30}, 0};
    if (seed >= 5) {  // half of the cache's is outside, or all
      guard.begin = stage.region(kCache) + (seed >= 7 ? 128 : 64);
      bus.bench.unit.window_begin = guard.begin;
    }
    bus.start_stream(kStoreBytes / 2, 16000);
    for (int i = 0; i < 3000; ++i) stage.cycle();
    bus.bench.unit.rd_ready = bus.bench.unit.rdd_ready = 1;
    ASSERT_TRUE(bus.settle());
    EXPECT_TRUE(bus.bench.unit.stray);
    EXPECT_TRUE(bus.outside(bus.bench.unit.stray_addr));
    EXPECT_EQ(bus.wrong, 0);
    EXPECT_EQ(bus.stream_left, 0u);
    EXPECT_TRUE(bus.store_is_as_expected());
    EXPECT_EQ(guard.outside, 0);
    EXPECT_GT(guard.inside, 100);
    EXPECT_EQ(bus.bench.failed_assertions(), 0);
  }
}

TEST(RtlBus, AWindowMayReachToTheEndOfAddresses) {
  BusBench<Vbus> bus(memory_of("ideal"), {});
  bus.bench.unit.window_end = 0;
  bus.start_stream(4096, 4096);
  ASSERT_TRUE(bus.settle());
  EXPECT_FALSE(bus.bench.unit.stray);
  EXPECT_EQ(bus.wrong, 0);
}

// After a cancel, at any moment, the bus comes to rest by itself, and works as before.
TEST(RtlBus, ComesToRestWhenCancelled) {
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    AxiMemoryOptions options;
    options.seed = seed;
    options.wild = seed % 2 == 0;
    BusBench<Vbus> bus(seed % 3 == 0 ? memory_of("ideal") : pipe(20, 50), options);
    auto& unit = bus.bench.unit;
    for (int round = 0; round < 8; ++round) {
      Stage<Vbus> stage{bus, {60, round % 2 ? 20u : 90u, 60}, 0};
      bus.start_stream(kStoreBytes / 2, 20000);
      const auto cycles = static_cast<int>(bus.bench.random() % 900);
      for (int i = 0; i < cycles; ++i) stage.cycle();
      // The units are stopped with the bus.
      unit.cancel = 1;
      for (auto& write : bus.writes) write.reset();
      unit.wr_valid = 0;
      bus.read.reset();
      unit.rd_ready = unit.rdd_ready = 0;
      ASSERT_TRUE(bus.settle(2000)) << "seed " << seed << " round " << round;
      ASSERT_TRUE(bus.axi.idle());
      unit.cancel = 0;
      bus.words_to_come.clear();
      // Some writes were dropped: what is in memory counts from now on.
      bus.store.read(model::Address(0), bus.expected.data(), kStoreBytes);
      unit.rd_ready = unit.rdd_ready = 1;
      bus.start_stream(kStoreBytes / 2, 3000);
      for (int i = 0; i < 300; ++i) stage.cycle();
      unit.rd_ready = unit.rdd_ready = 1;
      ASSERT_TRUE(bus.settle());
      ASSERT_EQ(bus.wrong, 0);
      ASSERT_TRUE(bus.store_is_as_expected());
    }
    EXPECT_FALSE(unit.stray);
    EXPECT_EQ(bus.axi.violation(), "");
    EXPECT_EQ(bus.bench.failed_assertions(), 0);
  }
}

// A memory may take the data of many writes before it takes the first one's address.
TEST(RtlBus, KeepsAddressesThatAreTakenLate) {
  constexpr std::uint32_t kBlockBytes = 64, kWrites = 40, kClient = 2;
  Bench<Vbus> bench;
  auto& unit = bench.unit;
  unit.cancel = unit.clear = unit.stream_start = unit.rdq_valid = 0;
  unit.window_begin = unit.window_end = 0;
  unit.m_axi_arready = unit.m_axi_rvalid = unit.m_axi_bvalid = 0;
  unit.m_axi_wready = 1;
  std::uint32_t offered = 0, addresses = 0, data = 0, answers = 0;
  for (int cycle = 0; cycle < 2000 && answers < kWrites; ++cycle) {
    unit.wr_valid = offered < kWrites ? 1u << kClient : 0;
    unit.wr_bytes = std::uint64_t{kBlockBytes} << (7 * kClient);
    set_word(unit.wr_addr, kClient, offered * kBlockBytes);
    for (std::size_t i = 0; i < 16; ++i) set_word(unit.wr_data, 16 * kClient + i, offered);
    unit.m_axi_awready = cycle > 200 && bench.chance(20);
    unit.m_axi_bvalid = answers < std::min(addresses, data);
    unit.m_axi_bid = kClient;
    unit.m_axi_bresp = 0;
    bench.settle();
    offered += unit.wr_valid && (unit.wr_ready >> kClient & 1);
    if (unit.m_axi_awvalid && unit.m_axi_awready) {
      EXPECT_EQ(unit.m_axi_awaddr, kBlockBytes * addresses++);
    }
    if (unit.m_axi_wvalid) {
      EXPECT_EQ(get_word(unit.m_axi_wdata, 0), data);
      data += unit.m_axi_wlast;
    }
    answers += unit.m_axi_bvalid;
    bench.cycle();
    if (cycle == 200) EXPECT_GT(data, 2u) << "data did not go ahead";
  }
  EXPECT_EQ(answers, kWrites);
  EXPECT_EQ(bench.failed_assertions(), 0);
}

// The tests would see a byte that went astray.
TEST(RtlBus, ALostBeatIsSeen) {
  BusBench<Vbus> writing(memory_of("ideal"), {});
  writing.axi.lose_beat(1);
  writing.writes[4] = writing.random_write(4, 0, 64);
  ASSERT_TRUE(writing.settle());
  EXPECT_FALSE(writing.store_is_as_expected());
  BusBench<Vbus> reading(memory_of("ideal"), {});
  reading.axi.lose_beat(5);
  reading.start_stream(0, 4096);
  EXPECT_FALSE(reading.settle());
  EXPECT_GT(reading.wrong, 0);
}

TEST(RtlBus, AssertionsSeeMisuse) {
  BusBench<Vbus> twice(memory_of("fixed"), {});
  twice.start_stream(0, 4096);
  twice.step();
  twice.start_stream(0, 4096);
  twice.step();
  EXPECT_GT(twice.bench.failed_assertions(), 0);
  BusBench<Vbus> crossing(memory_of("ideal"), {});
  crossing.writes[0] = crossing.random_write(0, 0, 32);
  crossing.writes[0]->address = 16;
  crossing.writes[0]->bytes = 32;
  crossing.step();
  EXPECT_GT(crossing.bench.failed_assertions(), 0);
  BusBench<Vbus> unasked(memory_of("ideal"), {});
  unasked.bench.unit.m_axi_bvalid = 1;
  unasked.bench.cycle();
  EXPECT_GT(unasked.bench.failed_assertions(), 0);
}

}  // namespace
}  // namespace fasttree::rtl
