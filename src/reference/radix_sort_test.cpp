// SPDX-License-Identifier: Apache-2.0
#include "reference/radix_sort.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <numeric>

namespace fasttree::reference {
namespace {

References with_ids(std::vector<std::uint32_t> codes) {
  References refs;
  refs.codes = std::move(codes);
  refs.ids.resize(refs.codes.size());
  std::iota(refs.ids.begin(), refs.ids.end(), 0u);
  return refs;
}

TEST(RadixSort, EqualsAStableSort) {
  EXPECT_TRUE(rc::check("equals std::stable_sort", [] {
    const std::uint32_t mask = *rc::gen::element(0xfu, 0xffu, 0xffffu, 0xffffffffu);
    const std::size_t size = *rc::gen::inRange<std::size_t>(0, 1000);
    auto codes = *rc::gen::container<std::vector<std::uint32_t>>(
        size, rc::gen::map(rc::gen::arbitrary<std::uint32_t>(),
                           [mask](std::uint32_t code) { return code & mask; }));
    References refs = with_ids(codes);
    std::vector<std::uint32_t> expected = refs.ids;
    std::stable_sort(expected.begin(), expected.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return codes[a] < codes[b]; });
    refs = radix_sort(std::move(refs));
    RC_ASSERT(refs.ids == expected);
    RC_ASSERT(std::is_sorted(refs.codes.begin(), refs.codes.end()));
  }));
}

TEST(RadixSort, OneRoundSortsByItsDigitOnly) {
  const References in = with_ids({0x21, 0x10, 0x01, 0x20, 0x11});
  References out = in;
  radix_sort_round(in, out, 0);
  EXPECT_EQ(out.codes, (std::vector<std::uint32_t>{0x10, 0x20, 0x21, 0x01, 0x11}));
  radix_sort_round(in, out, 1);
  EXPECT_EQ(out.codes, (std::vector<std::uint32_t>{0x01, 0x10, 0x11, 0x21, 0x20}));
}

TEST(RadixSort, StopsWhenTold) {
  int rounds = 0;
  const References out = radix_sort(with_ids({0x31, 0x12, 0x20}), [&](int round) {
    ++rounds;
    return round < 0;
  });
  EXPECT_EQ(rounds, 1);
  EXPECT_EQ(out.codes, (std::vector<std::uint32_t>{0x20, 0x31, 0x12}));
}

}  // namespace
}  // namespace fasttree::reference
