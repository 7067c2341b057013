// SPDX-License-Identifier: Apache-2.0
// Goes over the cells of a record, all those of a block at once: a block's eight counters lie in
// one word, and a mask says which of them the record's box covers.
#pragma once

#include <cstdint>

#include "model/fasttree2/cell_levels.h"

namespace fasttree::model::ft2 {

class BlockWalk {
 public:
  /// `words` counters of eight are in use; what a broken memory names beyond them is cut off, as
  /// wires would.
  void begin(const CellLevels& levels, const CellBox& box, std::uint32_t words) {
    levels_ = &levels;
    words_ = words;
    boxes_ = BoxWalk(box, levels.block_bits());
    if (boxes_.active()) load();
  }
  bool active() const { return boxes_.active(); }
  std::uint32_t word() const { return word_; }
  std::uint32_t mask() const { return mask_; }
  /// Takes one cell off the mask.
  void drop_lowest() { mask_ &= mask_ - 1; }
  void next() {
    boxes_.advance();
    if (boxes_.active()) load();
  }

 private:
  void load() {
    const Cell& at = boxes_.at();
    const auto& bits = levels_->block_bits();
    const std::uint32_t code =
        levels_->grid().morton_code({at[0] << bits[0], at[1] << bits[1], at[2] << bits[2]});
    word_ = code / kBlockCells & (words_ - 1);
    const CellBox part = boxes_.inside();
    mask_ = 0xff;
    for (std::size_t a = 0; a < 3; ++a) mask_ &= levels_->covered(a, part.lo[a], part.hi[a]);
  }

  const CellLevels* levels_ = nullptr;
  BoxWalk boxes_;
  std::uint32_t words_ = 1;
  std::uint32_t word_ = 0;
  std::uint32_t mask_ = 0;
};

}  // namespace fasttree::model::ft2
