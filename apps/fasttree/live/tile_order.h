// SPDX-License-Identifier: Apache-2.0
// The order of a picture's pixels in a batch of rays: tile by tile, so that 64 neighbours in the
// batch are 8 x 8 pixels.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace fasttree::live {

class TileOrder {
 public:
  static constexpr std::uint32_t kSide = 8;

  struct Tile {
    std::uint32_t x0, y0, x1, y1;  ///< pixels x0 <= x < x1, y0 <= y < y1
    std::size_t first;             ///< place of its first pixel in the batch
  };

  TileOrder(std::uint32_t width, std::uint32_t height)
      : width_(width), height_(height), columns_((width + kSide - 1) / kSide) {}

  std::uint32_t width() const { return width_; }
  std::uint32_t height() const { return height_; }
  std::size_t pixels() const { return std::size_t{width_} * height_; }
  std::size_t tiles() const { return std::size_t{columns_} * ((height_ + kSide - 1) / kSide); }

  /// Tiles go row by row, and so do the pixels in each. Those at the right and lower edge are cut
  /// short, and the batch has no gaps.
  Tile tile(std::size_t i) const {
    Tile t{};
    t.x0 = static_cast<std::uint32_t>(i % columns_) * kSide;
    t.y0 = static_cast<std::uint32_t>(i / columns_) * kSide;
    t.x1 = std::min(t.x0 + kSide, width_);
    t.y1 = std::min(t.y0 + kSide, height_);
    t.first = std::size_t{t.y0} * width_ + std::size_t{t.x0} * (t.y1 - t.y0);
    return t;
  }

 private:
  std::uint32_t width_;
  std::uint32_t height_;
  std::uint32_t columns_;
};

}  // namespace fasttree::live
