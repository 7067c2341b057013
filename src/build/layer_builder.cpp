// SPDX-License-Identifier: Apache-2.0
#include "build/layer_builder.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "grid/cell_overlap.h"

namespace fasttree::build {
namespace {

double half_area(const Box3& box, int x_bits, int y_bits, int z_bits) {
  const double x = static_cast<double>(box.hi.x - box.lo.x) / (1 << x_bits);
  const double y = static_cast<double>(box.hi.y - box.lo.y) / (1 << y_bits);
  const double z = static_cast<double>(box.hi.z - box.lo.z) / (1 << z_bits);
  return (x * y + y * z) + z * x;
}

template <typename T>
void make_room(std::vector<T>& v, std::size_t n) {
  if (v.size() < n) v.resize(n + n / 2);
}

}  // namespace

void LayerBuilder::build(const MeshView& mesh, std::span<const std::uint32_t> ids,
                         const Box3& cell, int levels_above, Simd simd, LayerOutput& output) {
  ids_ = ids;
  simd_ = simd;
  output_ = &output;
  lists_end_ = 0;
  const auto size = static_cast<std::uint32_t>(ids.size());
  if (size > kRealtimeRule.leaf_size) load(mesh);
  emit_list({0, size, cell, std::uint64_t{kRealtimeRule.whole_growth} * size, 0,
             static_cast<int>(kMaxTreeDepth) - levels_above});
}

void LayerBuilder::load(const MeshView& mesh) {
  all_.resize(ids_.size());
  std::array<float*, 9> out;
  for (std::size_t c = 0; c < 9; ++c) out[c] = all_.coordinate[c].data();
  for (std::size_t i = 0; i < ids_.size(); ++i) {
    const std::array<Vec3, 3> corners = mesh.triangle(ids_[i]);
    for (std::size_t c = 0; c < 3; ++c) {
      out[3 * c][i] = corners[c].x;
      out[3 * c + 1][i] = corners[c].y;
      out[3 * c + 2][i] = corners[c].z;
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
  auto& ids = output_->ids;
  const std::size_t first = ids.size();
  output_->nodes.push_back(Node::leaf(static_cast<std::uint32_t>(first), list.size));
  ids.resize(first + list.size);
  if (list.layer == 0) {
    std::copy(ids_.begin(), ids_.end(), ids.begin() + static_cast<std::ptrdiff_t>(first));
    return;
  }
  const std::uint32_t* const places = lists_.data() + list.begin;
  for (std::uint32_t i = 0; i < list.size; ++i) ids[first + i] = ids_[places[i]];
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
  const auto split = static_cast<std::size_t>(
      std::lower_bound(codes + first, codes + end, upper_code) - codes);
  const Grid::Split plane = layer.grid.split_below(upper_code, m);
  const std::size_t node = output_->nodes.size();
  output_->nodes.emplace_back();
  emit_children(layer, first, split);
  output_->nodes[node] = Node::inner(plane.axis, plane.position,
                                     static_cast<std::uint32_t>(output_->nodes.size()));
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
  grid.set(bounds, std::min({log2 + kRealtimeRule.layer_extra_depth,
                             kRealtimeRule.layer_most_depth, list.levels_left}));
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

  make_room(entries_, references);
  layer.kept = put_into_cells(triangles, grid);
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
  if (list.layer == 0) {
    for (std::size_t i = 0; i < entry_count_; ++i) {
      const std::uint64_t entry = entries_[i];
      lists[counters_[entry >> 32]++] = static_cast<std::uint32_t>(entry);
    }
  } else {
    const std::uint32_t* const places = lists + list.begin;
    for (std::size_t i = 0; i < entry_count_; ++i) {
      const std::uint64_t entry = entries_[i];
      lists[counters_[entry >> 32]++] = places[static_cast<std::uint32_t>(entry)];
    }
  }
  lists_end_ = place;
  layer.list = list;
  return true;
}

std::uint32_t LayerBuilder::put_into_cells(const LayerTriangles& triangles,
                                           const LocalGrid& grid) {
  std::fill_n(counters_.begin(), std::size_t{1} << grid.depth(), 0u);
  entry_count_ = 0;
  for (std::uint32_t i = 0; i < triangles.size; ++i) {
    unsigned mask = cells_.mask[i];
    const auto x = static_cast<std::uint32_t>(cells_.lo[0][i]);
    const auto y = static_cast<std::uint32_t>(cells_.lo[1][i]);
    const auto z = static_cast<std::uint32_t>(cells_.lo[2][i]);
    if (mask == 1) {
      put(grid.code_bits(0, x) | grid.code_bits(1, y) | grid.code_bits(2, z), i);
      continue;
    }
    for (; mask != 0; mask &= mask - 1) {
      const auto cell = static_cast<unsigned>(std::countr_zero(mask));
      put(grid.code_bits(0, x + (cell & 1)) | grid.code_bits(1, y + (cell >> 1 & 1)) |
              grid.code_bits(2, z + (cell >> 2)),
          i);
    }
    const auto span = [&](std::size_t a) { return cells_.hi[a][i] - cells_.lo[a][i]; };
    if (std::max({span(0), span(1), span(2)}) > 1) put_large(triangles, grid, i);
  }
  return static_cast<std::uint32_t>(entry_count_);
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
      const std::uint32_t zy =
          grid.code_bits(2, origin[2] + z) | grid.code_bits(1, origin[1] + y);
      for (std::uint32_t x = 0; x <= span[0]; ++x) {
        if (axes > 1 && !overlap.at(static_cast<float>(x), static_cast<float>(y),
                                    static_cast<float>(z))) {
          continue;
        }
        put(zy | grid.code_bits(0, origin[0] + x), triangle);
      }
    }
  }
}

}  // namespace fasttree::build
