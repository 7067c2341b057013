// SPDX-License-Identifier: Apache-2.0
// The inner loops of a layer over the triangles of one list. Every function has a scalar form and
// one for the widest instruction set; both give the same bits.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "build/buffer.h"
#include "build/local_grid.h"
#include "fasttree/build.h"
#include "fasttree/vec.h"

namespace fasttree::build {

/// Whole vectors are read, beyond the last triangle too: arrays have this much more room.
inline constexpr std::size_t kLayerPadding = 64;

/// The triangles of a list, one array a coordinate.
struct LayerTriangles {
  std::array<Buffer<float>, 9> coordinate;  ///< 3 * corner + axis
  std::size_t size = 0;

  /// Room for n triangles; what was there is lost.
  void resize(std::size_t n) {
    size = n;
    for (auto& c : coordinate) {
      if (c.size() < n + kLayerPadding) c.resize(n + kLayerPadding);
    }
  }
  /// Repeats the last triangle in the padding, so that bounds can include it.
  void pad() {
    for (auto& c : coordinate) {
      for (std::size_t i = 0; i < kLayerPadding; ++i) c[size + i] = c[size - 1];
    }
  }
};

/// Where those triangles are in the layer's grid.
struct LayerCells {
  /// The corners of each triangle's box of cells.
  std::array<Buffer<std::int32_t>, 3> lo;
  std::array<Buffer<std::int32_t>, 3> hi;
  /// For a box of at most two cells an axis, which of them the triangle is put into: bit x + 2 y +
  /// 4 z is the cell so far from `lo`. Zero for a larger box.
  Buffer<std::uint8_t> mask;
  /// Triangles whose mask has to be tested for overlap.
  Buffer<std::uint32_t> tests;
  std::size_t test_count = 0;
  /// Triangles with a larger box, in order.
  Buffer<std::uint32_t> large;
  std::size_t large_count = 0;

  void resize(std::size_t n) {
    if (mask.size() >= n + kLayerPadding) return;
    for (std::size_t a = 0; a < 3; ++a) {
      lo[a].resize(n + kLayerPadding);
      hi[a].resize(n + kLayerPadding);
    }
    tests.resize(n + kLayerPadding);
    large.resize(n + kLayerPadding);
    mask.resize(n + kLayerPadding);
  }
};

/// Box round padded triangles.
Box3 bounds_of(const LayerTriangles& triangles, Simd simd);

/// Fills `lo` and `hi` and returns the number of cells in all boxes.
std::uint64_t quantise_layer(const LayerTriangles& triangles, const LocalGrid& grid, Simd simd,
                             LayerCells& cells);

/// Halves the coordinates on an axis and counts again.
std::uint64_t coarsen_layer(std::size_t count, std::size_t axis, Simd simd, LayerCells& cells);

/// Fills `mask` and `large`, masks tested for overlap where a box spans two axes or more.
void mask_layer(const LayerTriangles& triangles, const LocalGrid& grid, Simd simd,
                LayerCells& cells);

/// References of a layer: which cell, and which triangle of the list.
struct LayerEntries {
  Buffer<std::uint16_t> code;
  Buffer<std::uint32_t> triangle;
  std::size_t count = 0;

  void resize(std::size_t n) {
    if (code.size() >= n + kLayerPadding) return;
    triangle.resize(n + n / 2 + kLayerPadding);
    code.resize(n + n / 2 + kLayerPadding);
  }
};

/// Appends the cells in the masks of triangles [first, end), in order.
void append_masked(std::uint32_t first, std::uint32_t end, const LocalGrid& grid,
                   const LayerCells& cells, Simd simd, LayerEntries& entries);

/// A corner in units of cells.
inline float in_cells(const LocalGrid& grid, std::size_t axis, float v) {
  const AxisQuantiser& q = grid.quantiser(axis);
  return ((v - q.lo) * q.scale) * grid.to_cells(axis);
}

}  // namespace fasttree::build
