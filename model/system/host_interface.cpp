// SPDX-License-Identifier: Apache-2.0
#include "model/system/host_interface.h"

#include <algorithm>
#include <cstring>

#include "model/units/pair_writer.h"
#include "model/units/scene_reader.h"
#include "reference/scene_bound.h"

namespace fasttree::model {
namespace {

std::vector<std::uint32_t> read_words(const ByteStore& store, Address from, std::uint64_t count) {
  std::vector<std::uint32_t> words(count);
  store.read(from, words.data(), count * 4);
  return words;
}

}  // namespace

Result<HostOrder> prepare_order(const MeshView& mesh, const PaperConfig& config) {
  if (Status status = validate(mesh); !status.ok()) return status;
  const Result<Box3> bounds = reference::scene_bound(mesh);
  if (!bounds.ok()) return bounds.status();
  const ReferenceCounts counts = count_references(mesh, bounds.value(), config.grid.axes);
  BuildSettings settings;
  settings.depth = config.grid.depth_fixed ? static_cast<int>(config.grid.depth) : kAutoDepth;
  settings.extra_depth = static_cast<int>(config.grid.extra_depth);
  settings.max_growth = config.grid.max_growth;
  const Result<int> depth = choose_depth(counts, mesh.triangle_count, settings);
  if (!depth.ok()) return depth.status();
  return HostOrder{mesh.triangle_count, depth.value(),
                   counts.at[static_cast<std::size_t>(depth.value())]};
}

void write_scene(const MeshView& mesh, const MemoryMap& map, ByteStore& store) {
  std::vector<std::uint8_t> pattern(std::size_t{1} << 16, 0xa5);
  for (std::uint64_t at = 0; at < store.size(); at += pattern.size()) {
    store.write(Address(at), pattern.data(),
                std::min<std::uint64_t>(pattern.size(), store.size() - at));
  }
  for (std::uint32_t t = 0; t < mesh.triangle_count; ++t) {
    const std::array<Vec3, 3> corners = mesh.triangle(t);
    static_assert(sizeof corners == kTriangleBytes);
    store.write(Address(map.scene.value + std::uint64_t{t} * kTriangleBytes), corners.data(),
                kTriangleBytes);
  }
}

DeviceImage read_image(const ByteStore& store, const MemoryMap& map, const Grid& grid,
                       std::uint32_t triangles, const MachineRegisters& registers) {
  DeviceImage image;
  image.info = grid.tree_info(triangles);
  image.root = registers.root;
  image.leaves.resize(std::max(registers.leaves, 1u));
  store.read(map.leaf_rows, image.leaves.data(), image.leaves.size() * sizeof(DeviceLeaf));
  image.internal.resize(image.leaves.size() - 1);
  store.read(map.nodes, image.internal.data(), image.internal.size() * sizeof(DeviceInternalNode));
  image.ids = read_words(store, map.sorted_ids, registers.references);
  return image;
}

void read_pairs(const ByteStore& store, const PaperConfig& config, Address pairs,
                std::uint64_t references, IntermediateArrays& arrays) {
  arrays.unsorted_codes.resize(references);
  arrays.unsorted_ids.resize(references);
  const std::uint32_t size = pair_bytes(config);
  for (std::uint64_t i = 0; i < references; ++i) {
    const auto bytes = store.view(Address(pairs.value + i * size), size);
    unpack_pair(config, bytes.data(), arrays.unsorted_codes[i], arrays.unsorted_ids[i]);
  }
}

std::vector<std::uint8_t> read_marks(const ByteStore& store, const MemoryMap& map,
                                     const Grid& grid) {
  const std::size_t words = ((std::size_t{1} << (grid.depth() + 1)) + 31) / 32;
  std::vector<std::uint8_t> marks(words * 4);
  store.read(map.marks, marks.data(), marks.size());
  return marks;
}

void read_arrays(const ByteStore& store, const MemoryMap& map, const MachineRegisters& registers,
                 const std::vector<std::uint8_t>& marks, IntermediateArrays& arrays) {
  arrays.sorted_codes = read_words(store, map.sorted_codes, registers.references);
  arrays.sorted_ids = read_words(store, map.sorted_ids, registers.references);
  arrays.leaf_codes = read_words(store, map.leaf_codes, registers.leaves);
  const std::vector<std::uint32_t> rows =
      read_words(store, map.leaf_rows, 2 * std::uint64_t{registers.leaves});
  arrays.leaf_first.resize(registers.leaves);
  arrays.leaf_count.resize(registers.leaves);
  for (std::size_t j = 0; j < registers.leaves; ++j) {
    arrays.leaf_first[j] = rows[2 * j];
    arrays.leaf_count[j] = rows[2 * j + 1];
  }
  const std::uint64_t nodes = registers.leaves > 0 ? registers.leaves - 1 : 0;
  arrays.node_words = read_words(store, map.nodes, nodes * sizeof(DeviceInternalNode) / 4);
  arrays.root = registers.root;
  arrays.mark_words.resize(marks.size() / 4);
  std::memcpy(arrays.mark_words.data(), marks.data(), marks.size());
}

}  // namespace fasttree::model
