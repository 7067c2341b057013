// SPDX-License-Identifier: Apache-2.0
// The small parts: sets of words, pipelines, split planes, area.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <set>

#include "grid/quantiser.h"
#include "model/config/machine_config.h"
#include "model/fasttree2/area.h"
#include "model/fasttree2/pipeline.h"
#include "model/fasttree2/split_plane.h"
#include "model/fasttree2/word_set.h"

namespace fasttree::model::ft2 {
namespace {

RC_GTEST_PROP(WordSet, FindsTheNextMemberUpAndDown, ()) {
  const auto size = *rc::gen::inRange<std::uint32_t>(1, 300);
  WordSet words;
  words.resize(size);
  std::set<std::uint32_t> expected;
  for (int i = 0; i < 40; ++i) {
    const auto w = *rc::gen::inRange<std::uint32_t>(0, size);
    if (*rc::gen::inRange(0, 4) == 0) {
      words.erase(w);
      expected.erase(w);
    } else {
      words.insert(w);
      expected.insert(w);
    }
  }
  for (std::uint32_t w = 0; w < size; ++w) {
    const auto up = expected.lower_bound(w);
    RC_ASSERT(words.from(w) == (up == expected.end() ? WordSet::kNone : *up));
    RC_ASSERT(words.below(w) == (up == expected.begin() ? WordSet::kNone : *std::prev(up)));
  }
}

TEST(Pipeline, GivesBackAfterItsLatencyAndWaitsAtItsEnd) {
  Pipeline<int> pipeline(3);
  pipeline.push(7, 10);
  pipeline.push(8, 11);
  EXPECT_FALSE(pipeline.valid(12));
  ASSERT_TRUE(pipeline.valid(13));
  EXPECT_EQ(pipeline.front(), 7);
  pipeline.push(9, 12);
  pipeline.push(10, 13);
  pipeline.push(11, 14);
  EXPECT_FALSE(pipeline.ready()) << "what is not taken stops those behind it";
  pipeline.pop();
  EXPECT_TRUE(pipeline.ready());
  EXPECT_EQ(pipeline.front(), 8);
}

RC_GTEST_PROP(SplitPlane, IsThatOfTheDefinition, ()) {
  const auto number = [] { return static_cast<float>(*rc::gen::inRange(-100000, 100000)); };
  const float lo = number() * 1e-3f;
  const float hi = lo + std::abs(number()) * *rc::gen::element(1e-7f, 1e-3f, 1.0f);
  RC_PRE(hi > lo);
  const Box3 bounds{{lo, lo, lo}, {hi, hi, hi}};
  const AxisLevels levels = make_axis_levels(bounds, AxisSchedule::cyclic);
  RC_PRE(levels.live[0]);
  const AxisQuantiser quantiser = make_axis_quantiser(bounds, levels, 0);
  const auto k = *rc::gen::inRange<std::uint32_t>(1, kFinestCells);
  const PlaneSearch search = search_plane(quantiser, hi, k);
  RC_ASSERT(search.plane == find_plane(quantiser, hi, k));
  RC_ASSERT(search.trials > 0u);
  RC_ASSERT(search.trials <= 80u);
}

TEST(Area, OfTheConfigurationsIsWithinTheirBounds) {
  const FastTree2Area area = fasttree2_area(load_config("fasttree-2").value().fasttree2);
  EXPECT_LE(area.luts(), 40'000u);
  EXPECT_LE(area.registers(), 35'000u);
  EXPECT_LE(area.sram_bits(), 50u * 1024u * 8u);
  const FastTree2Area small = fasttree2_area(load_config("fasttree-2-small").value().fasttree2);
  EXPECT_LE(small.sram_bits(), 172u * 1024u) << "the memory bits of the paper's mark cache";
  EXPECT_LT(small.luts(), area.luts());
}

TEST(Area, FollowsTheBuffers) {
  FastTree2Config config;
  const FastTree2Area base = fasttree2_area(config);
  config.plane_cache *= 2;
  EXPECT_EQ(fasttree2_area(config).sram_bits() - base.sram_bits(), 3u * 64u * 47u);
  config = {};
  config.lane_references += 100;
  EXPECT_EQ(fasttree2_area(config).sram_bits() - base.sram_bits(), 3u * 100u * 10u);
  config = {};
  // The first partition's lines lie in the lanes' memories, as long as those are larger.
  config.combine_bytes = 32;
  EXPECT_GT(base.sram_bits() - fasttree2_area(config).sram_bits(), 32u * 32u * 8u - 512u);
  EXPECT_LT(base.sram_bits() - fasttree2_area(config).sram_bits(), 512u * 32u * 8u);
  config = {};
  config.quantisers = 6;
  EXPECT_GT(fasttree2_area(config).luts(), base.luts() + 2000);
}

}  // namespace
}  // namespace fasttree::model::ft2
