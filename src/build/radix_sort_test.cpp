// SPDX-License-Identifier: Apache-2.0
#include "build/radix_sort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "tests/support/meshes.h"

namespace fasttree::build {
namespace {

TEST(FastRadixSort, EqualsAStableSortForEveryKeyWidth) {
  test::Random random(1);
  std::vector<std::uint32_t> counters;
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{1}, std::size_t{1000}, std::size_t{100000}}) {
    for (int bits = 0; bits <= 30; ++bits) {
      std::vector<std::uint32_t> codes(size), ids(size), other_codes(size), other_ids(size);
      for (auto& code : codes) code = random.below(1u << bits);
      std::iota(ids.begin(), ids.end(), 0u);
      std::vector<std::uint32_t> expected = ids;
      const std::vector<std::uint32_t> keys = codes;
      std::stable_sort(expected.begin(), expected.end(),
                       [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });
      radix_sort({codes, ids}, {other_codes, other_ids}, bits, counters);
      const bool even = radix_sort_rounds(bits) % 2 == 0;
      ASSERT_EQ(even ? ids : other_ids, expected) << bits << " bits, " << size;
      ASSERT_TRUE(
          std::is_sorted((even ? codes : other_codes).begin(), (even ? codes : other_codes).end()));
    }
  }
}

}  // namespace
}  // namespace fasttree::build
