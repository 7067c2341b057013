// SPDX-License-Identifier: Apache-2.0
// The prefix sum unit against the reference and, cycle by cycle, against the model's unit.
#include "model/units/prefix_sum.h"

#include <gtest/gtest.h>

#include <deque>
#include <random>
#include <string>
#include <vector>

#include "Vprefix_sum.h"
#include "Vprefix_sum_10.h"
#include "Vprefix_sum_3.h"
#include "Vprefix_sum_8.h"
#include "Vprefix_sum_flags.h"
#include "Vprefix_sum_sweep.h"
#include "reference/prefix_sum.h"
#include "rtl/bench/bench.h"

namespace fasttree::rtl {
namespace {

/// Values of `Width` bits in a vector of words.
template <std::uint32_t Width, typename Port>
void set_value(Port& port, std::size_t i, std::uint32_t value) {
  if constexpr (Width == 32) {
    set_word(port, i, value);
  } else {
    const std::uint32_t shift = i % 2 * 16;
    set_word(port, i / 2,
             (get_word(port, i / 2) & ~(0xffffu << shift)) | (value & 0xffff) << shift);
  }
}
template <std::uint32_t Width, typename Port>
std::uint32_t get_value(const Port& port, std::size_t i) {
  if constexpr (Width == 32) return get_word(port, i);
  return get_word(port, i / 2) >> i % 2 * 16 & 0xffff;
}

struct Shape {
  std::uint32_t section = 32;
  std::uint32_t stages = 2;
  std::uint32_t value_bits = 32;
};

/// Sections through the unit and the model's at once: the same sums, handshakes and activity in
/// every cycle.
template <typename Model, std::uint32_t Width = 32>
void like_the_model(const Shape& shape, int cycles, unsigned in_percent, unsigned out_percent) {
  Bench<Model> bench(in_percent * 101 + out_percent);
  model::PaperConfig::PrefixSum config;
  config.section = shape.section;
  config.stages = shape.stages;
  model::PrefixSumUnit unit("psu", config);
  constexpr std::uint32_t kMask = Width == 32 ? 0xffffffffu : (1u << Width) - 1;
  const std::uint32_t value_mask = shape.value_bits >= Width ? kMask : (1u << shape.value_bits) - 1;

  std::deque<std::vector<std::uint32_t>> sent;
  std::vector<std::uint32_t> next;
  std::uint64_t passed = 0, busy = 0, idle = 0, stalled = 0;
  std::size_t most = 0;
  for (int cycle = 0; cycle < cycles; ++cycle) {
    if (next.empty() && bench.chance(in_percent)) {
      next.resize(shape.section);
      const bool small = bench.chance(20);
      for (std::size_t i = 0; i < next.size(); ++i) {
        next[i] = small ? bench.random() & value_mask & 7 : bench.random() & value_mask;
        set_value<Width>(bench.unit.in_values, i, next[i]);
      }
    }
    bench.unit.in_valid = !next.empty();
    bench.unit.out_ready = bench.chance(out_percent);
    bench.settle();

    ASSERT_EQ(bench.unit.out_valid, unit.valid()) << cycle;
    if (bench.unit.out_valid && bench.unit.out_ready) {
      ASSERT_FALSE(sent.empty());
      std::vector<std::uint32_t> expected = sent.front();
      const std::uint32_t total = reference::prefix_sum(expected);
      ASSERT_EQ(bench.unit.out_total, total & kMask);
      for (std::size_t i = 0; i < expected.size(); ++i) {
        ASSERT_EQ(get_value<Width>(bench.unit.out_sums, i), expected[i] & kMask) << i;
      }
      sent.pop_front();
      unit.drop();
      ++passed;
    }
    ASSERT_EQ(bench.unit.in_ready, unit.ready()) << cycle;
    if (bench.unit.in_valid && bench.unit.in_ready) {
      unit.push(model::Section(shape.section));
      sent.push_back(next);
      next.clear();
    }
    most = std::max(most, sent.size());
    (bench.unit.activity == 0 ? idle : bench.unit.activity == 1 ? busy : stalled) += 1;
    unit.tick();
    unit.clock();
    bench.cycle();
  }
  EXPECT_EQ(busy, unit.activity().back().busy_cycles);
  EXPECT_EQ(idle, unit.activity().back().idle_cycles);
  EXPECT_EQ(stalled, unit.activity().back().stalled());
  EXPECT_GT(passed, static_cast<std::uint64_t>(cycles) / 10);
  if (in_percent > out_percent) {
    EXPECT_EQ(most, shape.stages) << "gaps close";
  }
  if (in_percent == 100 && out_percent == 100) {
    EXPECT_EQ(passed, static_cast<std::uint64_t>(cycles) - shape.stages) << "a section a cycle";
  }
  EXPECT_EQ(bench.failed_assertions(), 0);
}

constexpr std::pair<unsigned, unsigned> kPressures[] = {
    {100, 100}, {100, 30}, {30, 100}, {60, 60}, {95, 90}};

TEST(RtlPrefixSum, IsTheModelsInEveryCycle) {
  for (const auto& [in, out] : kPressures) like_the_model<Vprefix_sum>({}, 40000, in, out);
}

TEST(RtlPrefixSum, IsTheModelsForMoreStagesUpToOneALevel) {
  for (const auto& [in, out] : kPressures) {
    like_the_model<Vprefix_sum_3>({.stages = 3}, 20000, in, out);
    like_the_model<Vprefix_sum_10>({.stages = 10}, 15000, in, out);
  }
}

TEST(RtlPrefixSum, IsTheModelsForShortSectionsOfNarrowValues) {
  for (const auto& [in, out] : kPressures) {
    like_the_model<Vprefix_sum_8, 16>({.section = 8, .stages = 4}, 20000, in, out);
  }
}

TEST(RtlPrefixSum, SumsFlagsWhereItIsBuiltForNothingElse) {
  for (const auto& [in, out] : kPressures) {
    like_the_model<Vprefix_sum_flags>({.value_bits = 1}, 20000, in, out);
  }
  Bench<Vprefix_sum_flags> bench;
  for (std::size_t i = 0; i < 32; ++i) set_word(bench.unit.in_values, i, i == 17 ? 2 : 1);
  bench.unit.in_valid = 1;
  bench.unit.out_ready = 1;
  bench.cycle();
  EXPECT_GT(bench.failed_assertions(), 0) << "a value of two bits is noticed";
}

TEST(RtlPrefixSum, TheWholeSweepIsTheSerialSum) {
  VerilatedContext context;
  Vprefix_sum_sweep sweep(&context);
  std::mt19937 random(1);
  std::vector<std::uint32_t> values(32);
  for (int run = 0; run < 400000; ++run) {
    const std::uint32_t mask = ~std::uint32_t{0} >> random() % 32;
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = random() & mask;
      set_word(sweep.in_values, i, values[i]);
    }
    sweep.eval();
    ASSERT_EQ(sweep.out_total, reference::prefix_sum(values));
    for (std::size_t i = 0; i < values.size(); ++i) {
      ASSERT_EQ(get_word(sweep.out_values, i), values[i]) << i;
    }
  }
}

}  // namespace
}  // namespace fasttree::rtl
