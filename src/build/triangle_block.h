// SPDX-License-Identifier: Apache-2.0
// Blocks of triangles as structure of arrays, and the vectorised work on them. Every function has a
// scalar form and one for the widest instruction set; both give the same bits.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "fasttree/build.h"
#include "fasttree/mesh.h"
#include "grid/grid.h"

namespace fasttree::build {

inline constexpr std::uint32_t kBlock = 256;

/// Corner coordinates of up to kBlock triangles: corner[c][axis][i]. Lanes from `count` on repeat
/// the last triangle, so that kernels can work on whole vectors.
struct TriangleBlock {
  alignas(64) float corner[3][3][kBlock];
  std::uint32_t count = 0;
};

void gather(const MeshView& mesh, std::uint32_t first, std::uint32_t count, TriangleBlock& block);

/// Range of cells at the finest grid: lo[axis][i], hi[axis][i].
struct BoxBlock {
  alignas(64) std::uint32_t lo[3][kBlock];
  alignas(64) std::uint32_t hi[3][kBlock];
  std::uint32_t count = 0;
};

/// A triangle's cells at the finest grid in 12 bytes, as kept between two passes.
struct StoredBox {
  std::array<std::uint16_t, 3> lo;
  std::array<std::uint16_t, 3> hi;
};

/// Extends `bounds` by the block; false where a coordinate is not finite (bounds are then void).
bool scene_bound(Simd simd, const TriangleBlock& block, Box3& bounds);

/// Quantises the boxes of the block's triangles (same bits as finest_cells_of).
void quantise(Simd simd, const TriangleBlock& block, const std::array<AxisQuantiser, 3>& quantisers,
              BoxBlock& boxes);

/// Adds the block to M(D) for D = 0..levels (same sums as ReferenceCounts::add).
void count_references(Simd simd, const BoxBlock& boxes, const AxisLevels& schedule, int levels,
                      ReferenceCounts& counts);

/// The instruction set Simd::widest uses on this processor, e.g. "AVX3".
const char* widest_simd_name();

}  // namespace fasttree::build
