// SPDX-License-Identifier: Apache-2.0
#include "model/fasttree2/cell_levels.h"

#include <algorithm>
#include <utility>

namespace fasttree::model::ft2 {

CellLevels::CellLevels(Grid grid) : grid_(std::move(grid)) {
  for (int level = depth() - 1; level >= 0; --level) {
    const auto l = static_cast<std::size_t>(level);
    below_[l] = below_[l + 1];
    ++below_[l][static_cast<std::size_t>(grid_.axis_of_level(level))];
  }
  block_bits_ = bits_below(std::max(depth() - 3, 0));
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint32_t size = 1u << block_bits_[a];
    for (std::uint32_t lo = 0; lo < size; ++lo) {
      for (std::uint32_t hi = lo; hi < size; ++hi) {
        for (std::uint32_t c = 0; c < 1u << std::min(depth(), 3); ++c) {
          const std::uint32_t k = grid_.coordinate_of(c, a);
          if (lo <= k && k <= hi) covered_[a][lo][hi] |= static_cast<std::uint8_t>(1u << c);
        }
      }
    }
  }
}

BoxWalk::BoxWalk(const CellBox& box, const std::array<std::uint8_t, 3>& shift)
    : box_(box), shift_(shift), active_(true) {
  for (std::size_t a = 0; a < 3; ++a) {
    first_[a] = box.lo[a] >> shift[a];
    last_[a] = box.hi[a] >> shift[a];
    if (box.lo[a] > box.hi[a]) active_ = false;  // no record of ours: a broken memory's
  }
  at_ = first_;
}

CellBox BoxWalk::inside() const {
  CellBox part;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint32_t corner = at_[a] << shift_[a];
    const std::uint32_t end = corner + (1u << shift_[a]) - 1;
    part.lo[a] = std::max(box_.lo[a], corner) - corner;
    part.hi[a] = std::min(box_.hi[a], end) - corner;
  }
  return part;
}

void BoxWalk::advance() {
  for (std::size_t a = 0; a < 3; ++a) {
    if (at_[a] < last_[a]) {
      ++at_[a];
      return;
    }
    at_[a] = first_[a];
  }
  active_ = false;
}

}  // namespace fasttree::model::ft2
