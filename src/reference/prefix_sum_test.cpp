// SPDX-License-Identifier: Apache-2.0
#include "reference/prefix_sum.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <numeric>
#include <vector>

namespace fasttree::reference {
namespace {

TEST(PrefixSum, OfASectionIsExclusive) {
  std::array<std::uint32_t, kSection> section;
  std::iota(section.begin(), section.end(), 1u);
  EXPECT_EQ(prefix_sum_section(section), 528u);
  for (std::uint32_t i = 0; i < kSection; ++i) EXPECT_EQ(section[i], i * (i + 1) / 2);
}

TEST(PrefixSum, EqualsTheStandardLibrarysAtEverySize) {
  EXPECT_TRUE(rc::check("equals std::exclusive_scan", [] {
    const std::size_t size = *rc::gen::inRange<std::size_t>(0, 5000);
    std::vector<std::uint32_t> values =
        *rc::gen::container<std::vector<std::uint32_t>>(size, rc::gen::arbitrary<std::uint32_t>());
    std::vector<std::uint32_t> expected(size);
    std::exclusive_scan(values.begin(), values.end(), expected.begin(), 0u);
    const std::uint32_t total = std::accumulate(values.begin(), values.end(), 0u);
    RC_ASSERT(prefix_sum(values) == total);
    RC_ASSERT(values == expected);
  }));
}

TEST(PrefixSum, CrossesTheSectionsOfSectionsOfSections) {
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{1}, kSection, kSection + 1, kSection * kSection,
        kSection * kSection + 1, kSection * kSection * kSection + 5}) {
    std::vector<std::uint32_t> ones(size, 1);
    EXPECT_EQ(prefix_sum(ones), size);
    for (std::size_t i = 0; i < size; ++i) ASSERT_EQ(ones[i], i);
  }
}

}  // namespace
}  // namespace fasttree::reference
