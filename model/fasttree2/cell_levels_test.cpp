// SPDX-License-Identifier: Apache-2.0
#include "model/fasttree2/cell_levels.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <vector>

#include "model/fasttree2/block_walk.h"

namespace fasttree::model::ft2 {
namespace {

CellLevels random_levels() {
  const Box3 bounds{{0, 0, 0},
                    {static_cast<float>(*rc::gen::inRange(0, 4)),
                     static_cast<float>(*rc::gen::inRange(0, 9)), 2.0f}};
  const auto axes = *rc::gen::element(AxisSchedule::cyclic, AxisSchedule::longest);
  return CellLevels(Grid(bounds, axes, *rc::gen::inRange(0, 16)));
}

CellBox random_box(const CellLevels& levels) {
  CellBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint32_t cells = 1u << levels.grid().bits()[a];
    const std::uint32_t p = *rc::gen::inRange<std::uint32_t>(0, cells);
    box.lo[a] = p;
    box.hi[a] = std::min(p + *rc::gen::inRange<std::uint32_t>(0, 5), cells - 1);
  }
  return box;
}

std::vector<std::uint32_t> codes_of(const CellLevels& levels, const CellBox& box) {
  std::vector<std::uint32_t> codes;
  for (std::uint32_t z = box.lo[2]; z <= box.hi[2]; ++z) {
    for (std::uint32_t y = box.lo[1]; y <= box.hi[1]; ++y) {
      for (std::uint32_t x = box.lo[0]; x <= box.hi[0]; ++x) {
        codes.push_back(levels.grid().morton_code({x, y, z}));
      }
    }
  }
  std::sort(codes.begin(), codes.end());
  return codes;
}

RC_GTEST_PROP(BlockWalk, CoversEachCellOfABoxOnce, ()) {
  const CellLevels levels = random_levels();
  const CellBox box = random_box(levels);
  const std::uint32_t words = std::max(1u, (1u << levels.depth()) / kBlockCells);
  std::vector<std::uint32_t> codes;
  BlockWalk walk;
  for (walk.begin(levels, box, words); walk.active(); walk.next()) {
    RC_ASSERT(walk.mask() != 0u);
    for (std::uint32_t c = 0; c < kBlockCells; ++c) {
      if (walk.mask() >> c & 1u) codes.push_back(walk.word() * kBlockCells + c);
    }
  }
  std::sort(codes.begin(), codes.end());
  RC_ASSERT(codes == codes_of(levels, box));
}

/// Cutting a box into buckets and going over the parts' cells gives the cells of the box.
RC_GTEST_PROP(BoxWalk, CutsABoxIntoBuckets, ()) {
  const CellLevels levels = random_levels();
  const CellBox box = random_box(levels);
  const int prefix_bits = *rc::gen::inRange(0, levels.depth() + 1);
  const auto& inside = levels.bits_below(prefix_bits);
  RC_ASSERT(inside[0] + inside[1] + inside[2] == levels.depth() - prefix_bits);
  std::vector<std::uint32_t> codes;
  for (BoxWalk walk(box, inside); walk.active(); walk.advance()) {
    const Cell corner{walk.at()[0] << inside[0], walk.at()[1] << inside[1],
                      walk.at()[2] << inside[2]};
    const std::uint32_t bucket = levels.grid().morton_code(corner);
    RC_ASSERT((bucket & ((1u << (levels.depth() - prefix_bits)) - 1)) == 0u);
    for (const std::uint32_t local : codes_of(levels, walk.inside())) {
      codes.push_back(bucket | local);
    }
  }
  std::sort(codes.begin(), codes.end());
  RC_ASSERT(codes == codes_of(levels, box));
}

TEST(BoxWalk, HasNothingInABoxThatIsNone) {
  EXPECT_FALSE(BoxWalk(CellBox{{2, 0, 0}, {1, 5, 5}}, {0, 0, 0}).active());
}

}  // namespace
}  // namespace fasttree::model::ft2
