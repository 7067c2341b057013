// SPDX-License-Identifier: Apache-2.0
#include "build/layers.h"

#include <tbb/blocked_range.h>
#include <tbb/combinable.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <string>

namespace fasttree::build {
namespace {

// References of one chunk: a task of some tens of microseconds, whose output fits the second-level
// cache.
constexpr std::uint32_t kChunkReferences = 4096;

Box3 box_of(const Grid& grid, std::uint32_t code) {
  Box3 box = grid.bounds();
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint32_t k = grid.coordinate_of(code, a);
    if (k > 0) box.lo[a] = grid.plane(a, k);
    if (k + 1 < 1u << grid.bits()[a]) box.hi[a] = grid.plane(a, k + 1);
  }
  return box;
}

// The cells in order, with a last one that says where the ids end; and the chunks.
void list_cells(const Buckets& buckets, std::size_t ids, Layers& layers) {
  layers.cells.clear();
  for (std::size_t b = 0; b < buckets.leaf_count.size(); ++b) {
    const LeafStart* const leaves = buckets.leaves.data() + buckets.leaf_begin[b];
    for (std::uint32_t l = 0; l < buckets.leaf_count[b]; ++l) {
      Layers::TopCell cell;
      cell.code = leaves[l].code;
      cell.first = leaves[l].first;
      layers.cells.push_back(cell);
    }
  }
  const std::size_t count = layers.cells.size();
  Layers::TopCell last;
  last.first = static_cast<std::uint32_t>(ids);
  layers.cells.push_back(last);
  for (std::size_t j = 0; j < count; ++j) {
    layers.cells[j].count = layers.cells[j + 1].first - layers.cells[j].first;
  }

  layers.chunk_count = 0;
  for (std::size_t begin = 0, end = 0; begin < count; begin = end) {
    while (end < count &&
           (end == begin ||
            layers.cells[end + 1].first - layers.cells[begin].first <= kChunkReferences)) {
      ++end;
    }
    if (layers.chunk_count == layers.chunks.size()) layers.chunks.emplace_back();
    Layers::Chunk& chunk = layers.chunks[layers.chunk_count++];
    chunk.begin = begin;
    chunk.end = end;
  }
}

// Takes the large triangles out of the cells they do not overlap. Which of a cell's triangles are
// large and which of those overlap it cannot be predicted: nothing branches on it.
void drop_large(const Grid& grid, const Layers::Chunk& chunk, std::span<std::uint32_t> ids,
                Buffer<std::uint32_t>& places, Layers& layers) {
  for (std::size_t j = chunk.begin; j < chunk.end; ++j) {
    Layers::TopCell& top = layers.cells[j];
    std::uint32_t* const of_cell = ids.data() + top.first;
    if (places.size() < top.count) places.resize(top.count);
    std::size_t large = 0;
    for (std::uint32_t i = 0; i < top.count; ++i) {
      places[large] = i;
      large += layers.is_large[of_cell[i] / 64].bits >> of_cell[i] % 64 & 1;
    }
    if (large == 0) continue;
    const Cell cell = grid.cell_of(top.code);
    std::size_t dropped = 0;
    for (std::size_t l = 0; l < large; ++l) {
      const std::uint32_t id = of_cell[places[l]];
      const LargeTriangle& triangle = layers.large[layers.is_large[id / 64].rank(id)];
      places[dropped] = places[l];
      dropped += triangle.overlaps(cell) ? 0 : 1;
    }
    // Everything behind one that is dropped moves down by those dropped before it.
    for (std::size_t d = 0; d < dropped; ++d) {
      const std::uint32_t end = d + 1 < dropped ? places[d + 1] : top.count;
      std::copy(of_cell + places[d] + 1, of_cell + end, of_cell + places[d] - d);
    }
    top.count -= static_cast<std::uint32_t>(dropped);
  }
}

// Nodes and ids of a cell's subtree: up to where the next of its chunk begins.
std::uint32_t nodes_end(const Layers& layers, const Layers::Chunk& chunk, std::size_t cell) {
  return cell + 1 < chunk.end ? layers.cells[cell + 1].node_first
                              : static_cast<std::uint32_t>(chunk.output.node_count);
}

std::uint32_t ids_end(const Layers& layers, const Layers::Chunk& chunk, std::size_t cell) {
  return cell + 1 < chunk.end ? layers.cells[cell + 1].id_first
                              : static_cast<std::uint32_t>(chunk.output.id_count);
}

// The nodes above the cells' subtrees, from the last to the first as in emit_nodes; and the place
// of each subtree.
void emit_top(const Grid& grid, Layers& layers, Buffer<Node>& nodes) {
  struct Open {
    int m;
    std::uint32_t upper_code;
    std::uint32_t upper;
  };
  std::array<Open, kMaxDepth> open;
  std::size_t open_count = 0;
  auto next = static_cast<std::uint32_t>(nodes.size());
  const auto close = [&] {
    const Open& node = open[--open_count];
    const Grid::Split split = grid.split_below(node.upper_code, node.m);
    nodes[--next] = Node::inner(split.axis, split.position, node.upper);
  };
  const Layers::TopCell* above = nullptr;
  for (std::size_t c = layers.chunk_count; c-- > 0;) {
    const Layers::Chunk& chunk = layers.chunks[c];
    for (std::size_t j = chunk.end; j-- > chunk.begin;) {
      Layers::TopCell& cell = layers.cells[j];
      if (cell.count == 0) continue;
      if (above != nullptr) {
        // The node between this cell and the one above. Open nodes under it have both children.
        const int m = std::bit_width(above->code ^ cell.code) - 1;
        while (open_count > 0 && open[open_count - 1].m < m) close();
        open[open_count++] = {m, above->code, next};
      }
      above = &cell;
      next -= nodes_end(layers, chunk, j) - cell.node_first;
      cell.node_place = next;
    }
  }
  while (open_count > 0) close();
}

}  // namespace

std::uint64_t layer_bytes_per_reference() {
  // A list of n makes fewer than n 2^(k+1) leaves where a layer has at most ceil(log2 n) + k
  // levels; a list that is a leaf of the top grid makes one.
  constexpr int extra = kRealtimeRule.layer_extra_depth + 1;
  constexpr std::uint64_t references = kRealtimeRule.whole_growth;
  constexpr std::uint64_t leaves = extra < 0 ? (references >> -extra) + 1 : references;
  // In the chunks' output, which grows by doubling, and in the tree.
  return (2 + 1) * (references * sizeof(std::uint32_t) + 2 * leaves * sizeof(Node)) +
         sizeof(Layers::TopCell) +
         // Each large one has more than large_cells references.
         (sizeof(LargeTriangle) + sizeof(std::uint32_t)) / kRealtimeRule.large_cells + 1;
}

void find_large(const MeshView& mesh, const Grid& grid, std::span<const CodeBox> boxes,
                int box_shift, Layers& layers) {
  layers.large.clear();
  // More than 4 x 4 x 4 cells are more than 4 on some axis: a difference of codes, axis by axis, in
  // which other bits than the axis' last two are set.
  static_assert(kRealtimeRule.large_cells == 64);
  std::array<std::uint32_t, 3> axis, high;
  for (std::size_t a = 0; a < 3; ++a) {
    Cell cell{};
    cell[a] = (1u << grid.bits()[a]) - 1;
    axis[a] = grid.morton_code(cell);
    cell[a] &= ~3u;
    high[a] = grid.morton_code(cell);
  }
  tbb::combinable<std::vector<std::uint32_t>> found;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, boxes.size(), 16384),
                    [&](const auto& range) {
                      const auto wide = [&](std::size_t t) {
                        const std::uint32_t lo = boxes[t].lo >> box_shift;
                        const std::uint32_t hi = boxes[t].hi >> box_shift;
                        std::uint32_t bits = 0;
                        for (std::size_t a = 0; a < 3; ++a) {
                          bits |= ((hi & axis[a]) - (lo & axis[a])) & high[a];
                        }
                        return bits;
                      };
                      // Mostly none of them is: a block is looked at as a whole first.
                      constexpr std::size_t kBlock = 64;
                      for (std::size_t t = range.begin(); t < range.end(); t += kBlock) {
                        const std::size_t end = std::min(t + kBlock, range.end());
                        std::uint32_t any = 0;
                        for (std::size_t i = t; i < end; ++i) any |= wide(i);
                        if (any == 0) continue;
                        for (std::size_t i = t; i < end; ++i) {
                          const auto id = static_cast<std::uint32_t>(i);
                          if (wide(i) != 0 && LargeTriangle::is_large(grid, mesh.triangle(id))) {
                            found.local().push_back(id);
                          }
                        }
                      }
                    });
  std::vector<std::uint32_t> ids;
  found.combine_each([&](const auto& part) { ids.insert(ids.end(), part.begin(), part.end()); });
  std::sort(ids.begin(), ids.end());
  for (const std::uint32_t id : ids) layers.large.emplace_back(grid, id, mesh.triangle(id));
  if (ids.empty()) return;
  layers.is_large.assign(boxes.size() / 64 + 1, {});
  for (const std::uint32_t id : ids) layers.is_large[id / 64].bits |= std::uint64_t{1} << id % 64;
  std::uint32_t before = 0;
  for (Layers::LargeWord& word : layers.is_large) {
    word.before = before;
    before += static_cast<std::uint32_t>(std::popcount(word.bits));
  }
}

void build_layers(const MeshView& mesh, const Grid& grid, const Buckets& buckets,
                  std::span<std::uint32_t> ids, Simd simd, Layers& layers) {
  list_cells(buckets, ids.size(), layers);
  if (!layers.large.empty()) {
    tbb::parallel_for(std::size_t{0}, layers.chunk_count, [&](std::size_t c) {
      drop_large(grid, layers.chunks[c], ids, layers.places.local(), layers);
    });
  }
  tbb::parallel_for(std::size_t{0}, layers.chunk_count, [&](std::size_t c) {
    Layers::Chunk& chunk = layers.chunks[c];
    LayerOutput& output = chunk.output;
    output.node_count = 0;
    output.id_count = 0;
    LayerBuilder& builder = layers.builders.local();
    for (std::size_t j = chunk.begin; j < chunk.end; ++j) {
      Layers::TopCell& cell = layers.cells[j];
      cell.node_first = static_cast<std::uint32_t>(output.node_count);
      cell.id_first = static_cast<std::uint32_t>(output.id_count);
      if (cell.count == 0) continue;
      builder.build(mesh, ids, cell.first, cell.first + cell.count, box_of(grid, cell.code),
                    grid.depth(), simd, output);
    }
  });
}

Status assemble(const Grid& grid, Layers& layers, Buffer<Node>& nodes, Buffer<std::uint32_t>& ids) {
  std::uint64_t cells = 0, node_count = 0, id_count = 0;
  for (std::size_t c = 0; c < layers.chunk_count; ++c) {
    const Layers::Chunk& chunk = layers.chunks[c];
    for (std::size_t j = chunk.begin; j < chunk.end; ++j) {
      layers.cells[j].id_place = static_cast<std::uint32_t>(id_count + layers.cells[j].id_first);
      cells += layers.cells[j].count != 0;
    }
    node_count += chunk.output.node_count;
    id_count += chunk.output.id_count;
  }
  node_count += cells - 1;  // those above the cells
  if (node_count >= kMaxNodes) {
    return {StatusCode::resource_limit, "build: the tree would have " + std::to_string(node_count) +
                                            " nodes; at most " + std::to_string(kMaxNodes - 1) +
                                            " are possible. Ask for a smaller depth."};
  }
  nodes.resize(node_count);
  ids.resize(id_count);
  emit_top(grid, layers, nodes);
  tbb::parallel_for(std::size_t{0}, layers.chunk_count, [&](std::size_t c) {
    const Layers::Chunk& chunk = layers.chunks[c];
    for (std::size_t j = chunk.begin; j < chunk.end; ++j) {
      const Layers::TopCell& cell = layers.cells[j];
      const std::uint32_t node_shift = cell.node_place - cell.node_first;
      const std::uint32_t id_shift = cell.id_place - cell.id_first;
      for (std::uint32_t i = cell.node_first; i < nodes_end(layers, chunk, j); ++i) {
        Node node = chunk.output.nodes[i];
        if (node.is_leaf()) {
          node.word1 += id_shift;
        } else {
          node.word0 += node_shift << 2;
        }
        nodes[i + node_shift] = node;
      }
      std::copy(chunk.output.ids.begin() + cell.id_first,
                chunk.output.ids.begin() + ids_end(layers, chunk, j), ids.begin() + cell.id_place);
    }
  });
  return {};
}

}  // namespace fasttree::build
