// SPDX-License-Identifier: Apache-2.0
// The SBCU against the model's unit, cycle for cycle, and what it says of starts at the wrong time.
#include "model/units/scene_bound.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <optional>

#include "Vscene_bound.h"
#include "Vscene_bound_pairs.h"
#include "Vscene_bound_upper.h"
#include "rtl/bench/bench.h"

namespace fasttree::rtl {
namespace {

using model::CoordinateGroup;
using model::SceneBoundUnit;
using Side = SceneBoundUnit::Side;

constexpr std::uint32_t kIdle = 0, kBusy = 1;

/// Any finite binary32; often one of a few, so that there are equal ones and zeros of both signs.
template <typename B>
float finite(B& bench) {
  constexpr std::array<std::uint32_t, 8> kSome = {0x00000000, 0x80000000, 0x00000001, 0x80000001,
                                                  0x3f800000, 0xbf800000, 0x7f7fffff, 0xff7fffff};
  if (bench.chance(40)) return std::bit_cast<float>(kSome[bench.random() % kSome.size()]);
  std::uint32_t bits = bench.random();
  if ((bits >> 23 & 255) == 255) bits ^= 0x00800000;
  return std::bit_cast<float>(bits);
}

// What the model sees in a cycle was pushed in the one before; the RTL's input has no queue.
template <typename Model>
void like_the_model(Side side, std::uint32_t inputs) {
  Bench<Model> bench(inputs + (side == Side::upper ? 1 : 0));
  for (int run = 0; run < 400; ++run) {
    model::PaperConfig::SceneBound config;
    config.inputs = inputs;
    SceneBoundUnit unit(side, config);
    bench.unit.in_valid = 0;
    bench.unit.start = 1;
    bench.cycle();
    bench.unit.start = 0;
    // Some axes may have nothing, and some runs have little of everything: any value is the bound.
    const std::uint32_t axes = 1 + bench.random() % 3;
    const std::uint32_t groups = run % 4 == 0 ? bench.random() % 4 : 1000;
    const bool alike = bench.chance(10);
    // Of one sign all in some runs: the bound is then on the far side of zero.
    const std::uint32_t signs = bench.random() % 3;
    const auto value = [&] {
      const float any = finite(bench);
      return alike ? -0.0f : signs == 0 ? any : std::copysign(any, signs == 1 ? 1.0f : -1.0f);
    };
    std::optional<CoordinateGroup> now;
    for (std::uint32_t sent = 0;;) {
      bench.unit.in_valid = now.has_value();
      if (now) {
        bench.unit.in_axis = static_cast<std::uint8_t>(now->axis);
        for (std::size_t i = 0; i < inputs; ++i) {
          set_word(bench.unit.in_values, i, std::bit_cast<std::uint32_t>(now->values[i]));
        }
      }
      bench.settle();
      ASSERT_EQ(bench.unit.in_ready, 1);
      ASSERT_EQ(bench.unit.done && !now, unit.done());
      if (sent == groups && unit.done()) break;
      const std::uint64_t busy = unit.activity().back().busy_cycles;
      unit.tick();
      const bool worked = unit.activity().back().busy_cycles > busy;
      ASSERT_EQ(bench.unit.activity, worked ? kBusy : kIdle);
      now.reset();
      if (sent < groups && bench.chance(80)) {
        now.emplace();
        now->axis = bench.random() % axes;
        for (std::size_t i = 0; i < inputs; ++i) now->values[i] = value();
        unit.input.push(*now);
        ++sent;
      }
      bench.cycle();
      unit.clock();
    }
    for (std::size_t a = 0; a < 3; ++a) {
      ASSERT_EQ(get_word(bench.unit.bound, a), std::bit_cast<std::uint32_t>(unit.bound(a)));
    }
    bench.cycle();
  }
  EXPECT_EQ(bench.failed_assertions(), 0);
}

TEST(RtlSceneBound, IsTheModelCycleForCycle) {
  like_the_model<Vscene_bound>(Side::lower, 8);
  like_the_model<Vscene_bound_upper>(Side::upper, 8);
  like_the_model<Vscene_bound_pairs>(Side::upper, 2);
}

TEST(RtlSceneBound, SaysWhatMayNotCome) {
  Bench<Vscene_bound> bench;
  bench.unit.in_valid = 1;
  bench.unit.in_axis = 0;
  for (std::size_t i = 0; i < 8; ++i) set_word(bench.unit.in_values, i, 0);
  bench.cycle();
  EXPECT_EQ(bench.failed_assertions(), 0);
  bench.unit.in_valid = 0;
  bench.unit.start = 1;
  bench.cycle();
  EXPECT_EQ(bench.failed_assertions(), 1) << "started with a group on the way";
  bench.unit.start = 0;
  bench.unit.in_valid = 1;
  set_word(bench.unit.in_values, 3, 0x7fc00000);
  bench.cycle();
  EXPECT_EQ(bench.failed_assertions(), 2) << "not a number";
}

}  // namespace
}  // namespace fasttree::rtl
