// SPDX-License-Identifier: Apache-2.0
#include "model/system/memory_map.h"

#include <algorithm>
#include <string>

#include "fasttree/device_image.h"
#include "model/units/pair_writer.h"
#include "model/units/scene_reader.h"

namespace fasttree::model {
namespace {

constexpr std::uint64_t kPage = 4096;

}  // namespace

Result<MemoryMap> plan_memory(const PaperConfig& config, std::uint32_t triangles,
                              std::uint64_t references, int depth) {
  MemoryMap map;
  const auto region = [&](Address& begin, std::uint64_t bytes) {
    begin = Address(map.bytes);
    map.bytes += (std::max<std::uint64_t>(bytes, 1) + kPage - 1) / kPage * kPage;
  };
  // There are no more leaves than references or cells, and the tree of an empty scene has one.
  const std::uint64_t cells = std::uint64_t{1} << depth;
  const std::uint64_t leaves = std::max<std::uint64_t>(std::min(references, cells), 1);
  map.mark_bytes = std::max<std::uint64_t>(2 * cells / 8, kMaxRequestBytes);
  region(map.scene, std::uint64_t{triangles} * kTriangleBytes);
  region(map.pairs[0], references * pair_bytes(config));
  region(map.pairs[1], references * pair_bytes(config));
  region(map.sorted_codes, references * 4);
  region(map.sorted_ids, references * 4);
  region(map.leaf_codes, leaves * 4);
  region(map.leaf_rows, leaves * sizeof(DeviceLeaf));
  region(map.marks, map.mark_bytes);
  region(map.nodes, leaves * sizeof(DeviceInternalNode));
  const std::uint64_t limit = std::uint64_t{config.control.memory_mbytes} << 20;
  if (map.bytes > limit) {
    return Status(StatusCode::resource_limit,
                  "the scene needs " + std::to_string(map.bytes) + " bytes of the machine's " +
                      std::to_string(limit) + " (" + std::to_string(references) +
                      " references at depth " + std::to_string(depth) +
                      "). Raise control_memory_mbytes or lower the depth.");
  }
  return map;
}

}  // namespace fasttree::model
