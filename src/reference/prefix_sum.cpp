// SPDX-License-Identifier: Apache-2.0
#include "reference/prefix_sum.h"

#include <algorithm>
#include <vector>

namespace fasttree::reference {

std::uint32_t prefix_sum_section(std::array<std::uint32_t, kSection>& section) {
  // Up-sweep: a balanced tree of partial sums, each in its right-most leaf.
  for (std::size_t stride = 1; stride < kSection; stride *= 2) {
    for (std::size_t i = 2 * stride - 1; i < kSection; i += 2 * stride) {
      section[i] += section[i - stride];
    }
  }
  const std::uint32_t total = section[kSection - 1];
  section[kSection - 1] = 0;
  // Down-sweep: each node hands its sum to the left child, and that plus the left's to the right.
  for (std::size_t stride = kSection / 2; stride > 0; stride /= 2) {
    for (std::size_t i = 2 * stride - 1; i < kSection; i += 2 * stride) {
      const std::uint32_t left = section[i - stride];
      section[i - stride] = section[i];
      section[i] += left;
    }
  }
  return total;
}

std::uint32_t prefix_sum(std::span<std::uint32_t> values) {
  if (values.empty()) return 0;
  const std::size_t sections = (values.size() + kSection - 1) / kSection;
  std::vector<std::uint32_t> totals(sections);
  for (std::size_t s = 0; s < sections; ++s) {
    const auto part =
        values.subspan(s * kSection, std::min(kSection, values.size() - s * kSection));
    std::array<std::uint32_t, kSection> section{};
    std::copy(part.begin(), part.end(), section.begin());
    totals[s] = prefix_sum_section(section);
    std::copy_n(section.begin(), part.size(), part.begin());
  }
  if (sections == 1) return totals[0];
  const std::uint32_t total = prefix_sum(totals);
  for (std::size_t s = 1; s < sections; ++s) {
    const auto part =
        values.subspan(s * kSection, std::min(kSection, values.size() - s * kSection));
    for (std::uint32_t& value : part) value += totals[s];
  }
  return total;
}

}  // namespace fasttree::reference
