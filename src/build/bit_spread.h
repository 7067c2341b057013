// SPDX-License-Identifier: Apache-2.0
// The bits of one axis inside a Morton code. Codes can be compared, counted and stepped through
// axis by axis where they are, without taking them apart: a masked code orders like its
// coordinate, and carries and borrows run through the gaps between its bits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "grid/axis_schedule.h"

namespace fasttree::build {

/// Moves the low bits of a number to the places that a mask names, and back, in five steps that
/// every processor has (Warren, Hacker's Delight, 7-4 and 7-5).
class BitSpread {
 public:
  BitSpread() = default;
  explicit BitSpread(std::uint32_t mask) : mask_(mask) {
    std::uint32_t above = ~mask << 1;  // odd number of zeros to the right: moves by 2^i
    for (std::size_t i = 0; i < 5; ++i) {
      std::uint32_t odd = above ^ above << 1;
      odd ^= odd << 2;
      odd ^= odd << 4;
      odd ^= odd << 8;
      odd ^= odd << 16;
      moves_[i] = odd & mask;
      mask = (mask ^ moves_[i]) | moves_[i] >> (1 << i);
      above &= ~odd;
    }
  }

  std::uint32_t mask() const { return mask_; }
  std::uint32_t lowest() const { return mask_ & -mask_; }
  std::uint32_t move(std::size_t i) const { return moves_[i]; }

  std::uint32_t spread(std::uint32_t x) const {
    for (std::size_t i = 5; i-- > 0;) x = (x & ~moves_[i]) | (x << (1 << i) & moves_[i]);
    return x & mask_;
  }

  std::uint32_t gather(std::uint32_t x) const {
    x &= mask_;
    for (std::size_t i = 0; i < 5; ++i) {
      const std::uint32_t moved = x & moves_[i];
      x = (x ^ moved) | moved >> (1 << i);
    }
    return x;
  }

  /// The next coordinate, and hi - lo, both left spread.
  std::uint32_t next(std::uint32_t code) const { return ((code | ~mask_) + 1) & mask_; }
  std::uint32_t difference(std::uint32_t lo, std::uint32_t hi) const {
    return ((hi & mask_) - (lo & mask_)) & mask_;
  }

 private:
  std::uint32_t mask_ = 0;
  std::array<std::uint32_t, 5> moves_{};
};

/// Which bits of the Morton codes of one depth belong to which axis.
struct CodeAxes {
  int depth = 0;
  std::array<int, 3> bits{};
  std::array<BitSpread, 3> axis;

  CodeAxes() = default;
  CodeAxes(const AxisLevels& schedule, int at_depth) : depth(at_depth) {
    std::array<std::uint32_t, 3> masks{};
    for (int level = 0; level < depth; ++level) {
      const std::size_t a = schedule.axis[static_cast<std::size_t>(level)];
      masks[a] |= 1u << (depth - 1 - level);
      ++bits[a];
    }
    for (std::size_t a = 0; a < 3; ++a) axis[a] = BitSpread(masks[a]);
  }

  /// Number of cells of the box between two corners; at most 2^30.
  std::uint32_t cells(std::uint32_t lo, std::uint32_t hi) const {
    std::uint32_t product = 1;
    for (const BitSpread& a : axis) product *= a.gather(a.difference(lo, hi)) + 1;
    return product;
  }
};

}  // namespace fasttree::build
