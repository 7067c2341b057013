// SPDX-License-Identifier: Apache-2.0
// What a configuration of fasttree-2 costs: bits of SRAM counted from its buffers, look-up tables
// and registers estimated block by block from stated costs of an adder, a comparator, a multiplexer
// and a quantiser. docs/accelerator/fasttree2.md has the table and its assumptions.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/config/fasttree2_config.h"

namespace fasttree::model {

struct AreaBlock {
  std::string name;
  std::uint32_t luts = 0;       ///< 6-input look-up tables
  std::uint32_t registers = 0;  ///< flip-flops
  std::uint64_t sram_bits = 0;
};

struct FastTree2Area {
  std::vector<AreaBlock> blocks;
  /// Bits that two blocks use at different times, and that are therefore there once: the lines of
  /// the first partition lie in the lanes' memories, the scene's prefetch in that of the records.
  std::uint64_t shared_bits = 0;

  std::uint32_t luts() const;
  std::uint32_t registers() const;
  std::uint64_t sram_bits() const;  ///< shared bits counted once
};

FastTree2Area fasttree2_area(const FastTree2Config& config);

}  // namespace fasttree::model
