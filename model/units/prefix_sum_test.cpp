// SPDX-License-Identifier: Apache-2.0
#include "model/units/prefix_sum.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>

#include "reference/prefix_sum.h"

namespace fasttree::model {
namespace {

TEST(PrefixSumUnit, GivesASectionsSumsAfterItsStagesAndOneSectionACycle) {
  for (const std::uint32_t stages : {2u, 5u}) {
    PaperConfig::PrefixSum config;
    config.stages = stages;
    PrefixSumUnit psu("psu", config);
    std::vector<std::uint32_t> tags;
    std::vector<std::uint32_t> cycles;
    for (std::uint32_t cycle = 0; cycle < 40; ++cycle) {
      if (psu.valid()) {
        const Section sums = psu.front();
        psu.drop();
        tags.push_back(sums.tag);
        cycles.push_back(cycle);
        EXPECT_EQ(sums.total, 32 * sums.tag + 31 * 16);
        EXPECT_EQ(sums.values[3], 3 * sums.tag + 3);
      }
      if (cycle < 10) {
        ASSERT_TRUE(psu.ready());
        Section section(32);
        for (std::uint32_t i = 0; i < 32; ++i) section.values[i] = cycle + i;
        section.tag = cycle;
        psu.push(section);
      }
      psu.tick();
      psu.clock();
    }
    ASSERT_EQ(tags.size(), 10u);
    for (std::uint32_t i = 0; i < 10; ++i) {
      EXPECT_EQ(tags[i], i);
      EXPECT_EQ(cycles[i], i + stages);
    }
    EXPECT_TRUE(psu.done());
  }
}

TEST(PrefixSumUnit, HoldsItsSectionsWhileNobodyTakesThem) {
  PrefixSumUnit psu("psu", {});
  std::uint32_t pushed = 0;
  for (int cycle = 0; cycle < 20; ++cycle) {
    if (psu.ready()) {
      Section section(32);
      std::fill_n(section.values, 32, 1);
      section.tag = pushed++;
      psu.push(section);
    }
    psu.tick();
    psu.clock();
  }
  EXPECT_EQ(pushed, PaperConfig::PrefixSum{}.stages) << "one a stage";
  EXPECT_GT(psu.activity().back().stalled(), 10u);
  EXPECT_NE(psu.waits_for(), "");
  for (std::uint32_t tag = 0; tag < pushed;) {
    if (psu.valid()) {
      EXPECT_EQ(psu.front().tag, tag++);
      psu.drop();
    }
    psu.tick();
    psu.clock();
  }
}

RC_GTEST_PROP(PrefixSumUnit, SumsAsTheReferenceDoes, ()) {
  const auto bits = *rc::gen::inRange(1, 7);
  const std::uint32_t length = 1u << bits;
  const auto values =
      *rc::gen::container<std::vector<std::uint32_t>>(length, rc::gen::arbitrary<std::uint32_t>());
  std::vector<std::uint32_t> sums = values;
  up_sweep(sums.data(), length);
  const std::uint32_t total = down_sweep(sums.data(), length);
  std::vector<std::uint32_t> expected = values;
  RC_ASSERT(total == reference::prefix_sum(expected));
  RC_ASSERT(sums == expected);
}

}  // namespace
}  // namespace fasttree::model
