// SPDX-License-Identifier: Apache-2.0
// Profile `realtime`, fast: the layers below all cells of the top grid, in parallel, and the whole
// tree put together.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "build/buckets.h"
#include "build/buffer.h"
#include "build/layer_builder.h"
#include "fasttree/build.h"
#include "fasttree/mesh.h"
#include "fasttree/tree.h"
#include "grid/grid.h"
#include "grid/large_triangle.h"

namespace fasttree::build {

/// Working memory kept from build to build.
struct Layers {
  /// A cell of the top grid that holds something.
  struct TopCell {
    std::uint32_t code = 0;
    std::uint32_t first = 0;  ///< of its ids
    std::uint32_t count = 0;  ///< may be 0 where only large triangles' boxes reach the cell
    // Its subtree in its chunk's output, and where the whole tree has it.
    std::uint32_t node_first = 0;
    std::uint32_t id_first = 0;
    std::uint32_t node_place = 0;
    std::uint32_t id_place = 0;
  };
  /// Neighbouring cells that are one task's work.
  struct Chunk {
    std::size_t begin = 0;
    std::size_t end = 0;
    LayerOutput output;
  };
  /// Which of 64 triangles are large, and how many of those before them are.
  struct LargeWord {
    std::uint64_t bits = 0;
    std::uint32_t before = 0;

    /// Place of a large triangle in `large`.
    std::size_t rank(std::uint32_t id) const {
      const std::uint64_t lower = bits & ((std::uint64_t{1} << id % 64) - 1);
      return before + static_cast<std::size_t>(std::popcount(lower));
    }
  };
  Buffer<LargeTriangle> large;  ///< by id
  Buffer<LargeWord> is_large;   ///< of all triangles, where any is large
  Buffer<TopCell> cells;
  std::vector<Chunk> chunks;
  std::size_t chunk_count = 0;
  tbb::enumerable_thread_specific<Buffer<std::uint32_t>> places;  ///< in a cell's ids
  tbb::enumerable_thread_specific<LayerBuilder> builders;
};

/// Bytes that the layers and the tree may take for each reference of the top grid.
std::uint64_t layer_bytes_per_reference();

/// Finds the large triangles from the boxes, whose codes are `box_shift` levels deeper than the
/// grid.
void find_large(const MeshView& mesh, const Grid& grid, std::span<const CodeBox> boxes,
                int box_shift, Layers& layers);

/// Makes the layers of all cells that sort_buckets has left. Takes large triangles out of `ids`
/// where they overlap nothing.
void build_layers(const MeshView& mesh, const Grid& grid, const Buckets& buckets,
                  std::span<std::uint32_t> ids, Simd simd, Layers& layers);

/// Puts the tree together. resource_limit where it has more nodes than a tree can have.
Status assemble(const Grid& grid, Layers& layers, Buffer<Node>& nodes, Buffer<std::uint32_t>& ids);

}  // namespace fasttree::build
