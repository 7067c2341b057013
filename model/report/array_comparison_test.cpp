// SPDX-License-Identifier: Apache-2.0
// The comparison of fasttree diff: the first word that differs is found, named and shown as it is
// in each of those compared.
#include "model/report/array_comparison.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "model/report/simulate.h"
#include "tests/support/meshes.h"

namespace fasttree::model {
namespace {

std::vector<StageArray> arrays() {
  return {{"morton_code", "unsorted_codes", {5, 3, 3, 9}},
          {"radix_sort", "sorted_codes", {3, 3, 5, 9}},
          {"radix_sort", "sorted_ids", {1, 2, 0, 3}},
          {"path_compression", "root", {7}}};
}

TEST(ArrayComparison, EqualPartiesHaveNoDifference) {
  const std::vector<Party> parties{{"reference", arrays()}, {"model", arrays()}, {"rtl", arrays()}};
  const auto list = compare_arrays(parties);
  ASSERT_EQ(list.size(), 4u);
  for (std::size_t i = 0; i < list.size(); ++i) {
    EXPECT_EQ(list[i].stage, arrays()[i].stage);
    EXPECT_EQ(list[i].name, arrays()[i].name);
    EXPECT_EQ(list[i].words, arrays()[i].words.size());
    EXPECT_FALSE(list[i].first_word);
    EXPECT_TRUE(list[i].values.empty());
    EXPECT_EQ(describe(list[i], parties), "");
  }
}

TEST(ArrayComparison, NamesStageArrayWordAndValues) {
  std::vector<Party> parties{{"reference", arrays()}, {"model", arrays()}, {"rtl", arrays()}};
  parties[2].arrays[2].words[1] = 0xabc;
  const auto list = compare_arrays(parties);
  EXPECT_FALSE(list[0].first_word || list[1].first_word || list[3].first_word);
  EXPECT_EQ(describe(list[2], parties),
            "radix_sort sorted_ids[1]: reference 0x00000002, model 0x00000002, rtl 0x00000abc");
}

TEST(ArrayComparison, TheEarliestOfSeveralCounts) {
  std::vector<Party> parties{{"reference", arrays()}, {"model", arrays()}, {"rtl", arrays()}};
  parties[1].arrays[0].words[3] = 0;
  parties[2].arrays[0].words[2] = 0;
  EXPECT_EQ(compare_arrays(parties)[0].first_word, 2u);
  std::swap(parties[1], parties[2]);
  EXPECT_EQ(compare_arrays(parties)[0].first_word, 2u);
}

TEST(ArrayComparison, AnArrayThatEndsDiffersThere) {
  std::vector<Party> parties{{"reference", arrays()}, {"rtl", arrays()}};
  parties[1].arrays[1].words.pop_back();
  EXPECT_EQ(describe(compare_arrays(parties)[1], parties),
            "radix_sort sorted_codes[3]: reference 0x00000009, rtl ends");
  parties[1].arrays[1].words = {3, 3, 5, 9, 9};
  EXPECT_EQ(describe(compare_arrays(parties)[1], parties),
            "radix_sort sorted_codes[4]: reference ends, rtl 0x00000009");
  parties[1].arrays.erase(parties[1].arrays.begin() + 1);
  EXPECT_EQ(compare_arrays(parties)[1].first_word, 0u);
}

TEST(ArrayComparison, AStageAloneIsCompared) {
  std::vector<Party> parties{{"reference", arrays()}, {"rtl", arrays()}};
  parties[1].arrays[0].words[0] = 0;
  const auto sort = compare_arrays(parties, "radix_sort");
  ASSERT_EQ(sort.size(), 2u);
  EXPECT_EQ(sort[0].name, "sorted_codes");
  EXPECT_FALSE(sort[0].first_word || sort[1].first_word);
  EXPECT_EQ(compare_arrays(parties, "morton_code")[0].first_word, 0u);
}

/// A run of the model against the reference, with one bit of one of its words turned.
RC_GTEST_PROP(ArrayComparison, FindsAnyBitOfARun, ()) {
  static const test::OwnedMesh mesh = test::soup(200, 8, 0.05f);
  static const MachineConfig config = load_config("paper-asic65").value();
  static const std::vector<Party> parties = [] {
    SimulationOptions options;
    options.keep_arrays = true;
    return std::vector<Party>{
        {"reference", reference_stage_arrays(mesh.view(), config, {}).value()},
        {"model", stage_arrays(simulate(mesh.view(), config, options).value())}};
  }();
  for (const ArrayComparison& array : compare_arrays(parties)) RC_ASSERT(!array.first_word);

  std::vector<Party> broken = parties;
  const auto at = *rc::gen::inRange<std::size_t>(0, broken[1].arrays.size());
  StageArray& array = broken[1].arrays[at];
  RC_ASSERT(!array.words.empty());
  const auto word = *rc::gen::inRange<std::size_t>(0, array.words.size());
  array.words[word] ^= 1u << *rc::gen::inRange(0, 32);
  const auto list = compare_arrays(broken);
  for (std::size_t i = 0; i < list.size(); ++i) {
    RC_ASSERT(list[i].first_word == (i == at ? std::optional(word) : std::nullopt));
  }
}

}  // namespace
}  // namespace fasttree::model
