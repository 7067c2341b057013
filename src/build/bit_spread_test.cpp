// SPDX-License-Identifier: Apache-2.0
#include "build/bit_spread.h"

#include <gtest/gtest.h>

#include <bit>

#include "grid/grid.h"
#include "tests/support/meshes.h"

namespace fasttree::build {
namespace {

// Judge: bit by bit.
std::uint32_t spread_slowly(std::uint32_t x, std::uint32_t mask) {
  std::uint32_t out = 0;
  for (; mask != 0; mask &= mask - 1, x >>= 1) out |= (x & 1) << std::countr_zero(mask);
  return out;
}

TEST(BitSpread, SpreadsGathersStepsAndSubtracts) {
  test::Random random(1);
  for (int round = 0; round < 300; ++round) {
    const std::uint32_t mask = round == 0   ? 0
                               : round == 1 ? ~0u >> 2
                                            : random.below(1u << 30) & random.below(1u << 30);
    const BitSpread bits(mask);
    EXPECT_EQ(bits.mask(), mask);
    const std::uint32_t count = 1u << std::popcount(mask);
    for (int i = 0; i < 20; ++i) {
      const std::uint32_t x = random.below(count), y = random.below(count);
      const std::uint32_t noise = random.below(1u << 30) & ~mask;
      const std::uint32_t code = bits.spread(x);
      ASSERT_EQ(code, spread_slowly(x, mask));
      ASSERT_EQ(bits.gather(code | noise), x);
      ASSERT_EQ(bits.next(code | noise), bits.spread((x + 1) % count));
      ASSERT_EQ(bits.difference(code | noise, bits.spread(y)), bits.spread((y - x) % count));
    }
  }
}

TEST(CodeAxes, AreTheGridsMortonCodes) {
  const Box3 bounds{{0, 0, 0}, {3, 1, 20}};
  test::Random random(2);
  for (const AxisSchedule schedule : {AxisSchedule::cyclic, AxisSchedule::longest}) {
    for (const int depth : {0, 1, 2, 7, 21, 30}) {
      const Grid grid(bounds, schedule, depth);
      const CodeAxes axes(make_axis_levels(bounds, schedule), depth);
      for (int i = 0; i < 100; ++i) {
        CellBox box;
        std::uint32_t lo = 0, hi = 0;
        for (std::size_t a = 0; a < 3; ++a) {
          EXPECT_EQ(axes.bits[a], grid.bits()[a]);
          const std::uint32_t first = random.below(1u << axes.bits[a]);
          box.lo[a] = first;
          box.hi[a] = first + random.below((1u << axes.bits[a]) - first);
          lo |= axes.axis[a].spread(box.lo[a]);
          hi |= axes.axis[a].spread(box.hi[a]);
        }
        ASSERT_EQ(lo, grid.morton_code(box.lo));
        ASSERT_EQ(hi, grid.morton_code(box.hi));
        ASSERT_EQ(axes.cells(lo, hi), box.count());
      }
    }
  }
}

}  // namespace
}  // namespace fasttree::build
