// SPDX-License-Identifier: Apache-2.0
// How the bits of a Morton code are shared between buckets and the cells inside one.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "build/bit_spread.h"
#include "build/triangle_boxes.h"

namespace fasttree::build {

class BucketGrid {
 public:
  /// `axes` are those of the tree's depth; the boxes may have been made `box_shift` levels deeper.
  explicit BucketGrid(const CodeAxes& axes, int box_shift = 0, int threads = 1)
      : axes_(axes),
        box_shift_(box_shift),
        cell_bits_(cell_bits_of(axes.depth, threads)),
        bucket_bits_(axes.depth - cell_bits_) {}

  const CodeAxes& axes() const { return axes_; }
  int box_shift() const { return box_shift_; }
  int bucket_bits() const { return bucket_bits_; }
  int cell_bits() const { return cell_bits_; }
  std::size_t bucket_count() const { return std::size_t{1} << bucket_bits_; }
  std::uint32_t cell_mask() const { return (1u << cell_bits_) - 1; }

  /// Large buckets, so that few triangles are in several, but eight a thread. Nothing in the result
  /// depends on it.
  static int cell_bits_of(int depth, int threads) {
    constexpr int kLeastCellBits = 10;
    const int bucket_bits = 3 + std::bit_width(static_cast<unsigned>(threads) - 1);
    return std::clamp(depth - bucket_bits, std::min(depth, kLeastCellBits), kMostCellBits);
  }

  /// A triangle's part in one bucket: its id in the lower half; in the upper half the codes of its
  /// box' corners inside the bucket and its shape.
  using Record = std::uint64_t;
  static constexpr int kMostCellBits = 14;
  static constexpr int kShapeAt = 2 * kMostCellBits;
  static constexpr std::uint32_t kCornerMask = (1u << kMostCellBits) - 1;
  /// Shapes 0 to 7 are boxes of one or two cells an axis: bit a where it is two. This bit: larger.
  static constexpr std::uint32_t kLarge = 8;

  static Record record(std::uint32_t box, std::uint32_t id) {
    return std::uint64_t{box} << 32 | id;
  }
  static std::uint32_t id_of(Record record) { return static_cast<std::uint32_t>(record); }
  static std::uint32_t box_of(Record record) { return static_cast<std::uint32_t>(record >> 32); }

  /// A record's upper half.
  std::uint32_t pack(std::uint32_t lo, std::uint32_t hi) const {
    std::uint32_t shape = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::uint32_t span = axes_.axis[a].difference(lo, hi);
      if (span != 0) shape |= span == axes_.axis[a].lowest() ? 1u << a : kLarge;
    }
    return lo | hi << kMostCellBits | shape << kShapeAt;
  }

  /// Calls work(bucket, lo, hi) for each bucket the box reaches, with the corners' codes inside it.
  template <typename Work>
  void for_each_part(CodeBox box, const Work& work) const;

 private:
  CodeAxes axes_;
  int box_shift_;
  int cell_bits_;
  int bucket_bits_;
};

template <typename Work>
void BucketGrid::for_each_part(CodeBox box, const Work& work) const {
  box = {box.lo >> box_shift_, box.hi >> box_shift_};
  const std::uint32_t cells = cell_mask();
  // One axis: calls work(coordinate of the bucket, first and last cell inside), all as code bits.
  const auto along = [&](std::size_t a, const auto& each) {
    const std::uint32_t mask = axes_.axis[a].mask();
    const std::uint32_t lo = box.lo & mask, hi = box.hi & mask;
    const std::uint32_t outside = mask & ~cells, inside = mask & cells;
    std::uint32_t from = lo & inside;
    for (std::uint32_t bucket = lo & outside; bucket != (hi & outside);
         bucket = ((bucket | ~outside) + 1) & outside) {
      each(bucket, from, inside);
      from = 0;
    }
    each(hi & outside, from, hi & inside);
  };
  along(2, [&](std::uint32_t z, std::uint32_t z_lo, std::uint32_t z_hi) {
    along(1, [&](std::uint32_t y, std::uint32_t y_lo, std::uint32_t y_hi) {
      along(0, [&](std::uint32_t x, std::uint32_t x_lo, std::uint32_t x_hi) {
        work((x | y | z) >> cell_bits_, x_lo | y_lo | z_lo, x_hi | y_hi | z_hi);
      });
    });
  });
}

}  // namespace fasttree::build
