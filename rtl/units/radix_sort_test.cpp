// SPDX-License-Identifier: Apache-2.0
// The sorter, which is the radix sort unit with its prefix sum units: against a stable sort under
// random delays and back-pressure, and cycle for cycle against the model's units on the model's
// bus.
#include "reference/radix_sort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "Vsorter.h"
#include "Vsorter_32.h"
#include "Vsorter_64.h"
#include "Vsorter_8.h"
#include "model/units/unit_bench.h"
#include "rtl/bench/bench.h"

namespace fasttree::rtl {
namespace {

using model::Address;
using model::test::PipeSettings;
using reference::References;

constexpr std::uint32_t kPairs[2] = {0x40000, 0x80000};
constexpr std::uint32_t kCodes = 0xc0000;
constexpr std::uint32_t kIds = 0xe0000;

enum class Kind { uniform, equal, sorted, reversed, few };
constexpr Kind kKinds[] = {Kind::uniform, Kind::equal, Kind::sorted, Kind::reversed, Kind::few};

References references(Kind kind, std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  References list;
  for (std::size_t i = 0; i < count; ++i) {
    const auto n = static_cast<std::uint32_t>(i);
    const std::uint32_t any = random();
    const std::uint32_t codes[] = {any, seed, n * 1000, (1u << 30) - n, any & 0x01010101};
    list.codes.push_back(codes[static_cast<std::size_t>(kind)]);
    list.ids.push_back(n);
  }
  return list;
}

std::array<std::uint32_t, 16> digit_counts(const References& list, std::uint32_t round) {
  std::array<std::uint32_t, 16> counts{};
  for (const std::uint32_t code : list.codes) ++counts[code >> 4 * round & 15];
  return counts;
}

template <typename Model>
class Sorter {
 public:
  Sorter(std::uint32_t bus_bytes, std::uint32_t block, std::uint32_t seed = 1)
      : bench(seed), bus_bytes_(bus_bytes), block_(block) {
    bench.unit.start = bench.unit.rd_valid = bench.unit.wr_ready = 0;
    bench.settle();
  }

  /// The first cycle of a round.
  void start(const References& list, std::uint32_t round, bool last, bool use_counts = true) {
    EXPECT_TRUE(bench.unit.done);
    bench.unit.start = 1;
    bench.unit.round = static_cast<std::uint8_t>(round);
    bench.unit.last = last;
    bench.unit.pairs = static_cast<std::uint32_t>(list.size());
    bench.unit.to = last ? kCodes : kPairs[1 - round % 2];
    bench.unit.to_ids = kIds;
    bench.unit.use_counts_in = use_counts;
    const auto counts = digit_counts(list, round);
    for (std::size_t d = 0; d < 16; ++d) {
      set_word(bench.unit.counts_in, d, use_counts ? counts[d] : bench.random());
    }
    bench.unit.rd_valid = bench.unit.wr_ready = 0;
    bench.cycle();
    bench.unit.start = 0;
    bench.settle();
    EXPECT_FALSE(bench.unit.done);
  }

  /// A beat, of which only `bytes` mean something.
  void show_beat(const std::uint8_t* from, std::size_t bytes) {
    for (std::size_t w = 0; w < bus_bytes_ / 4; ++w) {
      std::uint32_t word = bench.random();
      if (4 * w < bytes) std::memcpy(&word, from + 4 * w, 4);
      set_word(bench.unit.rd_data, w, word);
    }
    bench.unit.rd_valid = 1;
  }

  /// The request that the unit shows now.
  model::BusRequest request() const {
    model::BusRequest request;
    request.address = Address(bench.unit.wr_addr);
    request.bytes = bench.unit.wr_bytes;
    request.write = true;
    EXPECT_GT(request.bytes, 0u);
    EXPECT_EQ(bench.unit.wr_addr / block_, (bench.unit.wr_addr + request.bytes - 1) / block_);
    for (std::uint32_t b = 0; b < request.bytes; ++b) {
      const std::uint32_t at = (bench.unit.wr_addr + b) % block_;
      request.data[b] =
          static_cast<std::uint8_t>(get_word(bench.unit.wr_data, at / 4) >> at % 4 * 8);
    }
    return request;
  }

  Bench<Model> bench;

 protected:
  std::uint32_t bus_bytes_;
  std::uint32_t block_;
};

std::vector<std::uint8_t> bytes_of(const References& list) {
  std::vector<std::uint8_t> bytes(list.size() * 8);
  for (std::size_t i = 0; i < list.size(); ++i) {
    std::memcpy(&bytes[8 * i], &list.codes[i], 4);
    std::memcpy(&bytes[8 * i + 4], &list.ids[i], 4);
  }
  return bytes;
}

/// A round of the unit; the stream and the port have time in so many of a hundred cycles. Every
/// byte is to be written once.
template <typename Model>
References random_round(Sorter<Model>& sorter, const References& list, std::uint32_t round,
                        bool last, unsigned read_percent, unsigned write_percent) {
  auto& unit = sorter.bench.unit;
  const std::size_t bus_bytes = sizeof unit.rd_data;
  const std::vector<std::uint8_t> from = bytes_of(list);
  std::vector<std::uint8_t> main(from.size()), ids(from.size());
  std::vector<std::uint8_t> main_writes(from.size()), ids_writes(from.size());
  sorter.start(list, round, last, round == 0);
  std::size_t at = 0;
  model::BusRequest waiting;
  for (int cycle = 0; !unit.done; ++cycle) {
    if (cycle > 2000000) {
      ADD_FAILURE() << "does not end";
      break;
    }
    if (!unit.rd_valid && at < from.size() && sorter.bench.chance(read_percent)) {
      sorter.show_beat(&from[at], from.size() - at);
    }
    unit.wr_ready = sorter.bench.chance(write_percent);
    sorter.bench.settle();
    const bool read = unit.rd_valid && unit.rd_ready;
    if (waiting.bytes > 0) {
      // What was shown and not taken stays.
      EXPECT_TRUE(unit.wr_valid);
      const model::BusRequest still = sorter.request();
      EXPECT_EQ(still.address, waiting.address);
      EXPECT_EQ(still.bytes, waiting.bytes);
      EXPECT_TRUE(
          std::equal(still.data.begin(), still.data.begin() + still.bytes, waiting.data.begin()));
    }
    waiting.bytes = 0;
    if (unit.wr_valid && !unit.wr_ready) waiting = sorter.request();
    if (unit.wr_valid && unit.wr_ready) {
      const model::BusRequest request = sorter.request();
      const bool to_ids = last && request.address.value >= kIds;
      const std::size_t place = request.address.value - (to_ids ? kIds : unit.to);
      std::vector<std::uint8_t>& into = to_ids ? ids : main;
      EXPECT_LE(place + request.bytes, from.size() / (last ? 2 : 1));
      if (place + request.bytes > from.size()) break;
      for (std::uint32_t b = 0; b < request.bytes; ++b) {
        into[place + b] = request.data[b];
        EXPECT_EQ((to_ids ? ids_writes : main_writes)[place + b]++, 0);
      }
    }
    sorter.bench.cycle();
    if (read) {
      at += bus_bytes;
      unit.rd_valid = 0;
    }
  }
  EXPECT_GE(at, from.size());
  References out = list;
  for (std::size_t i = 0; i < list.size(); ++i) {
    std::memcpy(&out.codes[i], &main[last ? 4 * i : 8 * i], 4);
    std::memcpy(&out.ids[i], last ? &ids[4 * i] : &main[8 * i + 4], 4);
  }
  return out;
}

template <typename Model>
void sorts(Sorter<Model>& sorter, const References& list, unsigned read_percent,
           unsigned write_percent) {
  std::vector<std::uint32_t> order = list.ids;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return list.codes[a] < list.codes[b]; });
  References now = list;
  for (std::uint32_t round = 0; round < 8; ++round) {
    References expected = now;
    reference::radix_sort_round(now, expected, static_cast<int>(round));
    now = random_round(sorter, now, round, round == 7, read_percent, write_percent);
    ASSERT_EQ(now.codes, expected.codes) << "round " << round << " of " << list.size();
    ASSERT_EQ(now.ids, expected.ids) << "round " << round << " of " << list.size();
  }
  EXPECT_EQ(now.ids, order);
  EXPECT_EQ(sorter.bench.failed_assertions(), 0);
}

constexpr std::pair<unsigned, unsigned> kPressures[] = {{100, 100}, {100, 20}, {30, 100}, {50, 50}};

template <typename Model>
void sorts_everything(std::uint32_t bus_bytes, std::uint32_t block, std::size_t step,
                      std::size_t large) {
  Sorter<Model> sorter(bus_bytes, block);
  std::uint32_t run = 0;
  for (std::size_t count = 0; count <= 1000; count += count < 10 ? 1 : step) {
    const auto [read, write] = kPressures[run % 4];
    sorts(sorter, references(kKinds[run % 5], count, run), read, write);
    if (testing::Test::HasFatalFailure()) return;
    ++run;
  }
  for (const Kind kind : kKinds) {
    const auto [read, write] = kPressures[run++ % 4];
    sorts(sorter, references(kind, large, run), read, write);
    if (testing::Test::HasFatalFailure()) return;
  }
}

TEST(RtlRadixSort, IsAStableSort) {
  sorts_everything<Vsorter>(16, 32, 23, 3000);
}

TEST(RtlRadixSort, IsAStableSortOnANarrowBusWithSmallSectionsAndBlocks) {
  sorts_everything<Vsorter_8>(8, 16, 97, 1000);
}

TEST(RtlRadixSort, IsAStableSortOnWideBuses) {
  sorts_everything<Vsorter_32>(32, 32, 97, 1000);
  sorts_everything<Vsorter_64>(64, 64, 97, 1000);
}

TEST(RtlRadixSort, SortsTenThousand) {
  Sorter<Vsorter> sorter(16, 32);
  sorts(sorter, references(Kind::uniform, 10007, 5), 90, 70);
}

// ---- Against the model.

struct Account {
  std::uint64_t cycles = 0;
  std::uint64_t busy = 0;
  std::array<std::uint64_t, 3> stalled{};
  bool operator==(const Account&) const = default;
};
void PrintTo(const Account& a, std::ostream* out) {
  *out << a.cycles << " cycles, busy " << a.busy << ", stalled " << a.stalled[0] << " + "
       << a.stalled[1] << " + " << a.stalled[2];
}

model::PaperConfig config_of(std::uint32_t units, std::uint32_t section, std::uint32_t stages,
                             std::uint32_t bus_bytes, std::uint32_t block) {
  model::PaperConfig config;
  config.prefix_sum.units = units;
  config.prefix_sum.section = section;
  config.prefix_sum.stages = stages;
  config.bus.bytes = bus_bytes;
  config.radix_sort.combine_bytes = block;
  return config;
}

PipeSettings pipe_of(std::uint64_t latency) {
  PipeSettings pipe;
  pipe.latency_ps = latency;
  return pipe;
}

Account model_round(const model::PaperConfig& config, const PipeSettings& pipe,
                    const References& list, std::uint32_t round, bool last) {
  model::test::UnitBench bench(config, pipe);
  model::BusPort& port = bench.bus.add_port("sort");
  std::vector<std::unique_ptr<model::PrefixSumUnit>> psus;
  std::vector<model::PrefixSumUnit*> pointers;
  model::Clocks clocks;
  for (std::uint32_t i = 0; i < config.prefix_sum.units; ++i) {
    psus.push_back(std::make_unique<model::PrefixSumUnit>("psu", config.prefix_sum));
    pointers.push_back(psus.back().get());
    clocks.add(*psus.back());
  }
  model::RadixSortUnit rsu(config, port, port, pointers);
  std::vector<model::Unit*> units{&rsu};
  units.insert(units.end(), pointers.begin(), pointers.end());
  const std::vector<std::uint8_t> bytes = bytes_of(list);
  const std::uint32_t from = kPairs[round % 2];
  bench.store.write(Address(from), bytes.data(), bytes.size());
  const auto counts = digit_counts(list, round);
  rsu.start({round, last, list.size(), Address(from),
             Address(last ? kCodes : kPairs[1 - round % 2]), Address(kIds)},
            {counts.begin(), counts.end()});
  Account account;
  account.cycles = bench.run(units, clocks);
  account.busy = rsu.activity().back().busy_cycles;
  for (std::size_t r = 0; r < 3; ++r) {
    account.stalled[r] = rsu.activity().back().stalled_cycles[r];
  }
  return account;
}

/// The same, of the RTL at the same bus.
template <typename Model>
Account rtl_round(const model::PaperConfig& config, const PipeSettings& pipe,
                  const References& list, std::uint32_t round, bool last) {
  model::test::UnitBench memory(config, pipe);
  model::BusPort& port = memory.bus.add_port("sort");
  model::StreamReader reader(port, config.bus.burst_bytes);
  Sorter<Model> sorter(config.bus.bytes, config.radix_sort.combine_bytes);
  const std::vector<std::uint8_t> bytes = bytes_of(list);
  memory.store.write(Address(kPairs[round % 2]), bytes.data(), bytes.size());
  reader.start(Address(kPairs[round % 2]), bytes.size(), model::Purpose::pairs);
  sorter.start(list, round, last);
  auto& unit = sorter.bench.unit;
  Account account;
  std::array<std::uint8_t, 64> beat{};
  std::size_t at = 0;
  while (!unit.done || !memory.bus.done()) {
    reader.tick();
    const std::size_t want = std::min<std::uint64_t>(config.bus.bytes, reader.left());
    if (!unit.rd_valid && want > 0 && reader.available() >= want) {
      sorter.show_beat(&bytes[at], want);
    }
    unit.wr_ready = port.requests.ready();
    sorter.bench.settle();
    if (unit.wr_valid && unit.wr_ready) port.requests.push(sorter.request());
    const bool read = unit.rd_valid && unit.rd_ready;
    if (unit.activity == 1) ++account.busy;
    if (unit.activity >= 2) ++account.stalled.at(unit.activity - 2u);
    if (read) {
      // Its room is free only now, though the beat has been known from the input.
      reader.take(beat.data(), want);
      EXPECT_TRUE(std::equal(beat.begin(), beat.begin() + static_cast<std::ptrdiff_t>(want),
                             bytes.begin() + static_cast<std::ptrdiff_t>(at)));
      at += want;
    }
    sorter.bench.cycle();
    memory.step({});
    if (read) unit.rd_valid = 0;
    if (++account.cycles > 1000000) {
      ADD_FAILURE() << "does not end";
      break;
    }
  }
  EXPECT_EQ(sorter.bench.failed_assertions(), 0);
  return account;
}

template <typename Model>
void like_the_model(const model::PaperConfig& config) {
  std::uint32_t run = 0;
  for (const std::size_t count : {0u, 1u, 2u, 127u, 128u, 129u, 1000u, 3001u}) {
    for (const Kind kind : kKinds) {
      const References list = references(kind, count, run);
      const std::uint32_t round = run % 8;
      const PipeSettings pipe = pipe_of(run % 3 == 0 ? 200000 : 10000);
      EXPECT_EQ((rtl_round<Model>(config, pipe, list, round, round == 7)),
                (model_round(config, pipe, list, round, round == 7)))
          << count << " pairs, kind " << static_cast<int>(kind) << ", round " << round;
      ++run;
    }
  }
}

TEST(RtlRadixSort, TakesTheModelsCycles) {
  like_the_model<Vsorter>(config_of(4, 32, 2, 16, 32));
}

TEST(RtlRadixSort, TakesTheModelsCyclesInOtherShapes) {
  like_the_model<Vsorter_8>(config_of(2, 16, 3, 8, 16));
  like_the_model<Vsorter_32>(config_of(4, 32, 4, 32, 32));
  like_the_model<Vsorter_64>(config_of(4, 32, 2, 64, 64));
}

/// 64 beats to fetch; flags of 16 digits through a register and a unit's stages; 64 cycles to
/// scatter.
TEST(RtlRadixSort, TakesFetchScanAndScatterASection) {
  const model::PaperConfig config = config_of(4, 32, 2, 16, 32);
  const auto cycles = [&](std::size_t sections) {
    return rtl_round<Vsorter>(config, pipe_of(10000), references(Kind::uniform, 128 * sections, 1),
                              0, false)
        .cycles;
  };
  EXPECT_NEAR(static_cast<double>(cycles(40) - cycles(20)) / 20, 64 + 1 + 16 + 2 + 64, 2);
}

TEST(RtlRadixSort, AStartDuringWorkIsNoticed) {
  Sorter<Vsorter> sorter(16, 32);
  sorter.start(references(Kind::uniform, 10, 1), 0, false);
  sorter.bench.unit.start = 1;
  sorter.bench.cycle();
  EXPECT_GT(sorter.bench.failed_assertions(), 0);
}

TEST(RtlRadixSort, AnArrayThatIsNotAlignedToBlocksIsNoticed) {
  Sorter<Vsorter> sorter(16, 32);
  sorter.bench.unit.start = 1;
  sorter.bench.unit.to = 8;
  sorter.bench.unit.to_ids = 0;
  sorter.bench.cycle();
  EXPECT_GT(sorter.bench.failed_assertions(), 0);
}

}  // namespace
}  // namespace fasttree::rtl
