// SPDX-License-Identifier: Apache-2.0
// Profile `realtime` below one cell of the top grid: layer after layer, until lists are short.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "build/buffer.h"
#include "build/layer_kernels.h"
#include "build/local_grid.h"
#include "fasttree/build.h"
#include "fasttree/mesh.h"
#include "fasttree/tree.h"
#include "grid/realtime_rule.h"

namespace fasttree::build {

/// Subtrees in pre-order, one after the other. Upper children and first ids count from the
/// beginning of the two arrays, which have room for more.
struct LayerOutput {
  Buffer<Node> nodes;
  Buffer<std::uint32_t> ids;
  std::size_t node_count = 0;
  std::size_t id_count = 0;
};

/// One a thread; keeps its memory from list to list and from build to build.
class LayerBuilder {
 public:
  /// Appends the subtree of a cell that holds the triangles `all_ids[first ... end)` and has
  /// `levels_above` levels of the top grid above it.
  void build(const MeshView& mesh, std::span<const std::uint32_t> all_ids, std::size_t first,
             std::size_t end, const Box3& cell, int levels_above, Simd simd, LayerOutput& output);

 private:
  static constexpr std::size_t kMostCells = std::size_t{1} << kRealtimeRule.layer_most_depth;

  // A list of triangles, by their places in `all_`, and what it may become.
  struct List {
    std::size_t begin = 0;  // in lists_; the first layer's list is everything
    std::uint32_t size = 0;
    Box3 cell;
    std::uint64_t budget = 0;  // references that may be made of it
    std::size_t layer = 0;
    int levels_left = 0;
  };

  // A layer that is being emitted: its grid, and the lists of its cells that are not empty.
  struct Layer {
    LocalGrid grid;
    List list;
    std::uint32_t kept = 0;
    std::size_t count = 0;
    std::array<std::uint16_t, kMostCells> code;
    std::array<std::size_t, kMostCells + 1> begin;
  };

  void load(const MeshView& mesh, std::span<const std::uint32_t> all_ids, std::size_t first);
  const LayerTriangles& triangles_of(const List& list);
  void emit_list(const List& list);
  void emit_leaf(const List& list);
  void emit_children(const Layer& layer, std::size_t first, std::size_t end);
  List child_of(const Layer& layer, std::size_t child) const;
  bool make_layer(const List& list, Layer& layer);
  void put_into_cells(const LayerTriangles& triangles, const LocalGrid& grid);
  void put_large(const LayerTriangles& triangles, const LocalGrid& grid, std::uint32_t triangle);

  std::span<const std::uint32_t> ids_;
  Simd simd_ = Simd::widest;
  LayerOutput* output_ = nullptr;
  LayerTriangles all_;   // of the cell of the top grid
  LayerTriangles part_;  // of one list
  LayerCells cells_;
  LayerEntries entries_;
  std::array<std::uint32_t, kMostCells> counters_{};
  Buffer<std::uint32_t> lists_;  // a stack
  std::size_t lists_end_ = 0;
  std::array<Layer, kRealtimeRule.most_layers> layers_;
};

}  // namespace fasttree::build
