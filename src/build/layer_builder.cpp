// SPDX-License-Identifier: Apache-2.0
#include "build/layer_builder.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "grid/cell_overlap.h"

namespace fasttree::build {
namespace {

// How many triangles before its use something is asked for.
constexpr std::size_t kIndicesAhead = 48;
constexpr std::size_t kVerticesAhead = 24;

double half_area(const Box3& box, int x_bits, int y_bits, int z_bits) {
  const double x = static_cast<double>(box.hi.x - box.lo.x) / (1 << x_bits);
  const double y = static_cast<double>(box.hi.y - box.lo.y) / (1 << y_bits);
  const double z = static_cast<double>(box.hi.z - box.lo.z) / (1 << z_bits);
  return (x * y + y * z) + z * x;
}

template <typename T>
void make_room(Buffer<T>& v, std::size_t n) {
  if (v.size() < n) v.resize(n + n / 2);
}

}  // namespace

void LayerBuilder::build(const MeshView& mesh, std::span<const std::uint32_t> all_ids,
                         std::size_t first, std::size_t end, const Box3& cell, int levels_above,
                         Simd simd, LayerOutput& output) {
  ids_ = all_ids.subspan(first, end - first);
  simd_ = simd;
  output_ = &output;
  lists_end_ = 0;
  const auto size = static_cast<std::uint32_t>(ids_.size());
  if (size > kRealtimeRule.leaf_size) load(mesh, all_ids, first);
  emit_list({0, size, cell, std::uint64_t{kRealtimeRule.whole_growth} * size, 0,
             static_cast<int>(kMaxTreeDepth) - levels_above});
}

void LayerBuilder::load(const MeshView& mesh, std::span<const std::uint32_t> all_ids,
                        std::size_t first) {
  all_.resize(ids_.size());
  std::array<float*, 9> out;
  for (std::size_t c = 0; c < 9; ++c) out[c] = all_.coordinate[c].data();
  const std::uint32_t* const ids = all_ids.data();
  const std::size_t last = all_ids.size() - 1;
  const auto* const positions = static_cast<const char*>(mesh.positions);
  for (std::size_t i = 0; i < ids_.size(); ++i) {
    // The triangles of a cell are anywhere in the mesh. Those of the next cells are fetched too.
    const std::size_t at = first + i;
    if (mesh.indices != nullptr) {
      __builtin_prefetch(mesh.indices + std::size_t{3} * ids[std::min(at + kIndicesAhead, last)]);
    }
    const std::uint32_t next = ids[std::min(at + kVerticesAhead, last)];
    for (std::uint32_t c = 0; c < 3; ++c) {
      __builtin_prefetch(positions + mesh.vertex_index(next, c) * mesh.position_stride_bytes);
    }
    for (std::uint32_t c = 0; c < 3; ++c) {
      float p[3];
      std::memcpy(p, positions + mesh.vertex_index(ids[at], c) * mesh.position_stride_bytes,
                  sizeof p);
      out[3 * c][i] = p[0];
      out[3 * c + 1][i] = p[1];
      out[3 * c + 2][i] = p[2];
    }
  }
  all_.pad();
}

const LayerTriangles& LayerBuilder::triangles_of(const List& list) {
  if (list.layer == 0) return all_;
  part_.resize(list.size);
  const std::uint32_t* const places = lists_.data() + list.begin;
  for (std::size_t c = 0; c < 9; ++c) {
    const float* const from = all_.coordinate[c].data();
    float* const to = part_.coordinate[c].data();
    for (std::size_t i = 0; i < list.size; ++i) to[i] = from[places[i]];
  }
  part_.pad();
  return part_;
}

void LayerBuilder::emit_list(const List& list) {
  if (list.size <= kRealtimeRule.leaf_size || list.layer == kRealtimeRule.most_layers) {
    emit_leaf(list);
    return;
  }
  Layer& layer = layers_[list.layer];
  const std::size_t end = lists_end_;
  if (make_layer(list, layer)) {
    emit_children(layer, 0, layer.count);
  } else {
    emit_leaf(list);
  }
  lists_end_ = end;
}

void LayerBuilder::emit_leaf(const List& list) {
  LayerOutput& out = *output_;
  make_room(out.nodes, out.node_count + 1);
  make_room(out.ids, out.id_count + list.size);
  out.nodes[out.node_count++] = Node::leaf(static_cast<std::uint32_t>(out.id_count), list.size);
  std::uint32_t* const ids = out.ids.data() + out.id_count;
  out.id_count += list.size;
  if (list.layer == 0) {
    std::copy(ids_.begin(), ids_.end(), ids);
    return;
  }
  const std::uint32_t* const places = lists_.data() + list.begin;
  for (std::uint32_t i = 0; i < list.size; ++i) ids[i] = ids_[places[i]];
}

void LayerBuilder::emit_children(const Layer& layer, std::size_t first, std::size_t end) {
  if (end - first == 1) {
    const List child = child_of(layer, first);
    emit_list(child);
    return;
  }
  const unsigned below = layer.code[first], above = layer.code[end - 1];
  const int m = static_cast<int>(std::bit_width(below ^ above)) - 1;
  const std::uint32_t upper_code = above >> m << m;
  const auto* const codes = layer.code.data();
  const auto split =
      static_cast<std::size_t>(std::lower_bound(codes + first, codes + end, upper_code) - codes);
  const Grid::Split plane = layer.grid.split_below(upper_code, m);
  const std::size_t node = output_->node_count++;
  make_room(output_->nodes, node + 1);
  emit_children(layer, first, split);
  output_->nodes[node] =
      Node::inner(plane.axis, plane.position, static_cast<std::uint32_t>(output_->node_count));
  emit_children(layer, split, end);
}

LayerBuilder::List LayerBuilder::child_of(const Layer& layer, std::size_t child) const {
  List list;
  list.begin = layer.begin[child];
  list.size = static_cast<std::uint32_t>(layer.begin[child + 1] - layer.begin[child]);
  list.layer = layer.list.layer + 1;
  if (list.size <= kRealtimeRule.leaf_size) return list;  // a leaf needs no more
  list.budget = layer.list.budget * list.size / layer.kept;
  list.levels_left = layer.list.levels_left - layer.grid.depth();
  list.cell = layer.list.cell;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint32_t k = layer.grid.coordinate_of(layer.code[child], a);
    if (k > 0) list.cell.lo[a] = layer.grid.plane(a, k);
    if (k + 1 < 1u << layer.grid.bits(a)) list.cell.hi[a] = layer.grid.plane(a, k + 1);
  }
  return list;
}

bool LayerBuilder::make_layer(const List& list, Layer& layer) {
  const LayerTriangles& triangles = triangles_of(list);
  LocalGrid& grid = layer.grid;
  Box3 bounds = bounds_of(triangles, simd_);
  for (std::size_t a = 0; a < 3; ++a) {
    bounds.lo[a] = std::max(bounds.lo[a], list.cell.lo[a]);
    bounds.hi[a] = std::min(bounds.hi[a], list.cell.hi[a]);
  }
  const int log2 = static_cast<int>(std::bit_width(list.size - 1));
  grid.set(bounds, std::min({log2 + kRealtimeRule.layer_extra_depth, kRealtimeRule.layer_most_depth,
                             list.levels_left}));
  cells_.resize(list.size);
  const std::uint64_t limit =
      std::min(std::uint64_t{kRealtimeRule.layer_growth} * list.size, list.budget);
  std::uint64_t references = quantise_layer(triangles, grid, simd_, cells_);
  while (references > limit) {
    const auto axis = static_cast<std::size_t>(grid.axis_of_level(grid.depth() - 1));
    grid.coarsen();
    references = coarsen_layer(list.size, axis, simd_, cells_);
  }
  if (grid.depth() == 0) return false;
  grid.make_codes();
  mask_layer(triangles, grid, simd_, cells_);

  entries_.resize(references);
  put_into_cells(triangles, grid);
  layer.kept = static_cast<std::uint32_t>(entries_.count);
  if (layer.kept == 0) return false;

  const double cell_area = half_area(bounds, grid.bits(0), grid.bits(1), grid.bits(2));
  const double area = half_area(bounds, 0, 0, 0);
  const bool worth = !(layer.kept * cell_area > kRealtimeRule.worth * (list.size * area));
  make_room(lists_, lists_end_ + layer.kept);
  std::uint32_t fewest = list.size;
  layer.count = 0;
  std::size_t place = lists_end_;
  for (std::uint32_t code = 0; code < 1u << grid.depth(); ++code) {
    const std::uint32_t size = counters_[code];
    if (size == 0) continue;
    fewest = std::min(fewest, size);
    layer.code[layer.count] = static_cast<std::uint16_t>(code);
    layer.begin[layer.count++] = place;
    counters_[code] = static_cast<std::uint32_t>(place);
    place += size;
  }
  layer.begin[layer.count] = place;
  if (!worth || fewest == list.size) return false;

  std::uint32_t* const lists = lists_.data();
  const std::uint32_t* const places = lists + list.begin;
  for (std::size_t i = 0; i < entries_.count; ++i) {
    const std::uint32_t triangle = entries_.triangle[i];
    lists[counters_[entries_.code[i]]++] = list.layer == 0 ? triangle : places[triangle];
  }
  lists_end_ = place;
  layer.list = list;
  return true;
}

void LayerBuilder::put_into_cells(const LayerTriangles& triangles, const LocalGrid& grid) {
  entries_.count = 0;
  const auto size = static_cast<std::uint32_t>(triangles.size);
  std::uint32_t done = 0;
  for (const std::uint32_t large : std::span(cells_.large.data(), cells_.large_count)) {
    append_masked(done, large, grid, cells_, simd_, entries_);
    put_large(triangles, grid, large);
    done = large + 1;
  }
  append_masked(done, size, grid, cells_, simd_, entries_);
  std::fill_n(counters_.begin(), std::size_t{1} << grid.depth(), 0u);
  for (std::size_t i = 0; i < entries_.count; ++i) ++counters_[entries_.code[i]];
}

void LayerBuilder::put_large(const LayerTriangles& triangles, const LocalGrid& grid,
                             std::uint32_t triangle) {
  std::array<std::array<float, 3>, 3> corner;
  Cell origin, span;
  int axes = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t c = 0; c < 3; ++c) {
      corner[c][a] = in_cells(grid, a, triangles.coordinate[3 * c + a][triangle]);
    }
    origin[a] = static_cast<std::uint32_t>(cells_.lo[a][triangle]);
    span[a] = static_cast<std::uint32_t>(cells_.hi[a][triangle] - cells_.lo[a][triangle]);
    axes += span[a] > 0;
  }
  const CellOverlap overlap(corner, origin);
  for (std::uint32_t z = 0; z <= span[2]; ++z) {
    for (std::uint32_t y = 0; y <= span[1]; ++y) {
      const std::uint32_t zy = grid.code_bits(2, origin[2] + z) | grid.code_bits(1, origin[1] + y);
      for (std::uint32_t x = 0; x <= span[0]; ++x) {
        if (axes > 1 &&
            !overlap.at(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z))) {
          continue;
        }
        entries_.code[entries_.count] =
            static_cast<std::uint16_t>(zy | grid.code_bits(0, origin[0] + x));
        entries_.triangle[entries_.count++] = triangle;
      }
    }
  }
}

}  // namespace fasttree::build
