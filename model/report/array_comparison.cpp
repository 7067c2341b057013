// SPDX-License-Identifier: Apache-2.0
#include "model/report/array_comparison.h"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace fasttree::model {
namespace {

using Words = std::vector<std::uint32_t>;

const Words& words_of(const Party& party, const StageArray& wanted) {
  static const Words kNone;
  const auto found =
      std::find_if(party.arrays.begin(), party.arrays.end(), [&](const StageArray& array) {
        return array.stage == wanted.stage && array.name == wanted.name;
      });
  return found == party.arrays.end() ? kNone : found->words;
}

std::optional<std::size_t> first_difference(const Words& a, const Words& b) {
  const auto [at, other] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  if (at == a.end() && other == b.end()) return std::nullopt;
  return static_cast<std::size_t>(at - a.begin());
}

}  // namespace

std::vector<ArrayComparison> compare_arrays(const std::vector<Party>& parties,
                                            const std::string& stage) {
  std::vector<ArrayComparison> list;
  if (parties.empty()) return list;
  for (const StageArray& expected : parties[0].arrays) {
    if (!stage.empty() && expected.stage != stage) continue;
    ArrayComparison comparison{expected.stage, expected.name, expected.words.size(), {}, {}};
    for (const Party& party : parties) {
      const auto at = first_difference(expected.words, words_of(party, expected));
      if (at) comparison.first_word = std::min(comparison.first_word.value_or(*at), *at);
    }
    if (comparison.first_word) {
      for (const Party& party : parties) {
        const Words& words = words_of(party, expected);
        const std::size_t at = *comparison.first_word;
        comparison.values.push_back(at < words.size() ? std::optional(words[at]) : std::nullopt);
      }
    }
    list.push_back(std::move(comparison));
  }
  return list;
}

std::string word_text(std::uint32_t word) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%08x", word);
  return text;
}

std::string describe(const ArrayComparison& comparison, const std::vector<Party>& parties) {
  if (!comparison.first_word) return "";
  std::string text = comparison.stage + " " + comparison.name + "[" +
                     std::to_string(*comparison.first_word) + "]:";
  for (std::size_t p = 0; p < parties.size(); ++p) {
    const std::optional<std::uint32_t> value = comparison.values[p];
    text += (p > 0 ? ", " : " ") + parties[p].name + " " + (value ? word_text(*value) : "ends");
  }
  return text;
}

}  // namespace fasttree::model
