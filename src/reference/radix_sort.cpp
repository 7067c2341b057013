// SPDX-License-Identifier: Apache-2.0
#include "reference/radix_sort.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "reference/prefix_sum.h"

namespace fasttree::reference {

void radix_sort_round(const References& in, References& out, int round) {
  const std::size_t sections = (in.size() + kSection - 1) / kSection;
  const auto digit_of = [&](std::size_t i) {
    return in.codes[i] >> (round * kDigitBits) & (kRadix - 1);
  };

  // How often each digit occurs in each section, digit by digit, so that one prefix sum over all
  // of it gives where the digit's references of a section begin.
  std::vector<std::uint32_t> begins(kRadix * sections);
  for (std::size_t i = 0; i < in.size(); ++i) ++begins[digit_of(i) * sections + i / kSection];
  prefix_sum(begins);

  for (std::size_t s = 0; s < sections; ++s) {
    const std::size_t first = s * kSection;
    const std::size_t count = std::min(kSection, in.size() - first);
    for (std::uint32_t digit = 0; digit < kRadix; ++digit) {
      // Flags of the references with this digit; their prefix sum is each one's rank among them.
      std::array<std::uint32_t, kSection> rank{};
      for (std::size_t i = 0; i < count; ++i) rank[i] = digit_of(first + i) == digit;
      if (prefix_sum_section(rank) == 0) continue;
      const std::uint32_t begin = begins[digit * sections + s];
      for (std::size_t i = 0; i < count; ++i) {
        if (digit_of(first + i) != digit) continue;
        out.codes[begin + rank[i]] = in.codes[first + i];
        out.ids[begin + rank[i]] = in.ids[first + i];
      }
    }
  }
}

References radix_sort(References references, const std::function<bool(int round)>& after_round) {
  References other;
  other.codes.resize(references.size());
  other.ids.resize(references.size());
  for (int round = 0; round < kRounds; ++round) {
    radix_sort_round(references, other, round);
    std::swap(references, other);
    if (after_round && !after_round(round)) break;
  }
  return references;
}

}  // namespace fasttree::reference
