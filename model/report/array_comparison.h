// SPDX-License-Identifier: Apache-2.0
// What several machines have left in memory, compared word by word: where do they first part?
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "model/report/stage_arrays.h"

namespace fasttree::model {

/// One of those that are compared: what it is called, and its arrays in the order of the stages.
struct Party {
  std::string name;
  std::vector<StageArray> arrays;
};

struct ArrayComparison {
  std::string stage;
  std::string name;
  std::size_t words = 0;  ///< of the first party
  /// The least index at which not all have the same word; none: they are equal.
  std::optional<std::size_t> first_word;
  /// Each party's word there, in the order of the parties; none: its array has ended. Empty where
  /// the arrays are equal.
  std::vector<std::optional<std::uint32_t>> values;
};

/// Of each of the first party's arrays, or those of one stage. A party without the array counts as
/// one whose array is empty.
std::vector<ArrayComparison> compare_arrays(const std::vector<Party>& parties,
                                            const std::string& stage = "");

/// "0x0000000c"
std::string word_text(std::uint32_t word);

/// "radix_sort sorted_ids[12]: reference 0x00000003, rtl ends"; empty where nothing differs.
std::string describe(const ArrayComparison& comparison, const std::vector<Party>& parties);

}  // namespace fasttree::model
