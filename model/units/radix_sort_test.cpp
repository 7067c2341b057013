// SPDX-License-Identifier: Apache-2.0
#include "model/units/radix_sort.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "model/units/unit_bench.h"
#include "reference/radix_sort.h"
#include "tests/support/meshes.h"

namespace fasttree::model {
namespace {

constexpr Address kFrom(0);
constexpr Address kTo(1 << 18);
constexpr Address kIds(1 << 19);

struct Sorter {
  explicit Sorter(const PaperConfig& config)
      : bench(config),
        port(bench.bus.add_port("sort")),
        psus(make(config)),
        rsu(config, port, port, [&] {
          std::vector<PrefixSumUnit*> list;
          for (auto& psu : psus) list.push_back(psu.get());
          return list;
        }()) {
    units.push_back(&rsu);
    for (auto& psu : psus) {
      units.push_back(psu.get());
      clocks.add(*psu);
    }
  }
  static std::vector<std::unique_ptr<PrefixSumUnit>> make(const PaperConfig& config) {
    std::vector<std::unique_ptr<PrefixSumUnit>> list;
    for (std::uint32_t i = 0; i < config.prefix_sum.units; ++i) {
      list.push_back(std::make_unique<PrefixSumUnit>("psu", config.prefix_sum));
    }
    return list;
  }
  /// One round; the cycles.
  std::uint64_t round(const reference::References& in, std::uint32_t number, bool last) {
    const std::uint32_t radix_bits = bench.config.radix_sort.radix_bits;
    std::vector<std::uint32_t> words;
    std::vector<std::uint32_t> counts(std::size_t{1} << radix_bits);
    for (std::size_t i = 0; i < in.size(); ++i) {
      words.push_back(in.codes[i]);
      words.push_back(in.ids[i]);
      ++counts[in.codes[i] >> number * radix_bits & (counts.size() - 1)];
    }
    bench.put(kFrom, words);
    rsu.start({number, last, in.size(), kFrom, kTo, kIds}, counts);
    return bench.run(units, clocks);
  }

  test::UnitBench bench;
  BusPort& port;
  std::vector<std::unique_ptr<PrefixSumUnit>> psus;
  RadixSortUnit rsu;
  std::vector<Unit*> units;
  Clocks clocks;
};

reference::References random_references(std::size_t count, std::uint64_t seed) {
  fasttree::test::Random random(seed);
  reference::References list;
  for (std::size_t i = 0; i < count; ++i) {
    list.codes.push_back(random.below(1u << 30));
    list.ids.push_back(static_cast<std::uint32_t>(i));
  }
  return list;
}

TEST(RadixSortUnit, EachRoundEqualsTheReferences) {
  for (const std::size_t count : {0u, 1u, 31u, 128u, 129u, 5000u}) {
    reference::References list = random_references(count, count + 1);
    for (const std::uint32_t number : {0u, 1u, 7u}) {
      for (const bool last : {false, true}) {
        Sorter sorter{PaperConfig{}};
        sorter.round(list, number, last);
        reference::References expected = list;
        reference::radix_sort_round(list, expected, static_cast<int>(number));
        if (last) {
          EXPECT_EQ(sorter.bench.words(kTo, count), expected.codes);
          EXPECT_EQ(sorter.bench.words(kIds, count), expected.ids);
        } else {
          const std::vector<std::uint32_t> words = sorter.bench.words(kTo, 2 * count);
          for (std::size_t i = 0; i < count; ++i) {
            ASSERT_EQ(words[2 * i], expected.codes[i]);
            ASSERT_EQ(words[2 * i + 1], expected.ids[i]);
          }
        }
        std::vector<std::uint32_t> next(16);
        for (const std::uint32_t code : list.codes) {
          ++next[number == 7 ? 0 : code >> 4 * (number + 1) & 15];
        }
        EXPECT_EQ(sorter.rsu.next_counts(), next);
      }
    }
  }
}

/// 128 pairs of 8 bytes over 16 bytes a cycle, in and out, and sixteen scans between.
TEST(RadixSortUnit, TakesFetchScanAndScatterASection) {
  const reference::References list = random_references(128 * 50, 3);
  Sorter sorter{PaperConfig{}};
  const std::uint64_t cycles = sorter.round(list, 0, false) / 50;
  EXPECT_GE(cycles, 64 + 16 + 64u);
  EXPECT_LE(cycles, 64 + 16 + 64 + 8u);

  PaperConfig overlapped;
  overlapped.radix_sort.double_buffer = true;
  Sorter other(overlapped);
  EXPECT_LT(other.round(list, 0, false) / 50, cycles - 5) << "the scan hides behind a fetch";

  PaperConfig counting;
  counting.radix_sort.digit_count = DigitCount::own_pass;
  Sorter third(counting);
  EXPECT_NEAR(static_cast<double>(third.round(list, 0, false) / 50),
              static_cast<double>(cycles + 64), 8);
}

RC_GTEST_PROP(RadixSortUnit, IsTheSameForEveryShape, ()) {
  PaperConfig config;
  config.prefix_sum.units = *rc::gen::inRange(1u, 6u);
  config.prefix_sum.section = 1u << *rc::gen::inRange(1, 7);
  config.prefix_sum.stages = *rc::gen::inRange(2u, 6u);
  config.radix_sort.double_buffer = *rc::gen::arbitrary<bool>();
  config.radix_sort.pairs_per_cycle = *rc::gen::inRange(1u, 5u);
  config.radix_sort.combine_bytes = 8u << *rc::gen::inRange(0, 4);
  config.bus.bytes = 4u << *rc::gen::inRange(0, 5);
  const reference::References list = random_references(*rc::gen::inRange(0, 700), 9);
  Sorter sorter(config);
  sorter.round(list, 2, true);
  reference::References expected = list;
  reference::radix_sort_round(list, expected, 2);
  RC_ASSERT(sorter.bench.words(kTo, list.size()) == expected.codes);
  RC_ASSERT(sorter.bench.words(kIds, list.size()) == expected.ids);
}

}  // namespace
}  // namespace fasttree::model
