// SPDX-License-Identifier: Apache-2.0
// A grid as a unit's port of type ft_pkg::grid_t has it.
#pragma once

#include <bit>
#include <cstdint>

#include "grid/grid.h"

namespace fasttree::rtl {

/// Where the fields of ft_pkg::grid_t are, the last one declared being at bit 0.
namespace grid_bits {
inline constexpr std::size_t kDepth = 0, kRank = 5, kMask = 125, kBits = 215, kExtent = 227,
                             kScale = 323, kLo = 419;
}  // namespace grid_bits

template <typename Port>
void set_bits(Port& port, std::size_t from, std::size_t count, std::uint32_t value) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t bit = 1u << (from + i) % 32;
    const std::uint32_t word = port[(from + i) / 32];
    port[(from + i) / 32] = value >> i & 1u ? word | bit : word & ~bit;
  }
}

/// One axis of it.
template <typename Port>
void set_axis(Port& port, std::size_t axis, const AxisQuantiser& quantiser, float extent,
              std::uint32_t bits) {
  set_bits(port, grid_bits::kLo + 32 * axis, 32, std::bit_cast<std::uint32_t>(quantiser.lo));
  set_bits(port, grid_bits::kScale + 32 * axis, 32, std::bit_cast<std::uint32_t>(quantiser.scale));
  set_bits(port, grid_bits::kExtent + 32 * axis, 32, std::bit_cast<std::uint32_t>(extent));
  set_bits(port, grid_bits::kBits + 4 * axis, 4, bits);
}

template <typename Port>
void set_grid(Port& port, const Grid& grid) {
  for (std::size_t i = 0; i < kMaxDepth; ++i) {
    for (std::size_t a = 0; a < 3; ++a) set_bits(port, grid_bits::kMask + 30 * a + i, 1, 0);
    set_bits(port, grid_bits::kRank + 4 * i, 4, 0);
  }
  for (std::size_t a = 0; a < 3; ++a) {
    set_axis(port, a, grid.quantiser(a), grid.bounds().extent()[a], grid.bits()[a]);
  }
  std::uint32_t rank[3] = {};
  for (int i = 0; i < grid.depth(); ++i) {
    const auto bit = static_cast<std::size_t>(i);
    const auto axis = static_cast<std::size_t>(grid.axis_of_level(grid.depth() - 1 - i));
    set_bits(port, grid_bits::kMask + 30 * axis + bit, 1, 1);
    set_bits(port, grid_bits::kRank + 4 * bit, 4, rank[axis]++);
  }
  set_bits(port, grid_bits::kDepth, 5, static_cast<std::uint32_t>(grid.depth()));
}

}  // namespace fasttree::rtl
