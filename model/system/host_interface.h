// SPDX-License-Identifier: Apache-2.0
// The host's side: it checks the scene, works D out, lays triangles into the machine's memory, and
// reads the finished device image and the arrays between the steps back.
#pragma once

#include <cstdint>
#include <vector>

#include "fasttree/device_image.h"
#include "fasttree/mesh.h"
#include "fasttree/status.h"
#include "grid/grid.h"
#include "model/config/paper_config.h"
#include "model/memory/byte_store.h"
#include "model/report/simulation.h"
#include "model/system/memory_map.h"

namespace fasttree::model {

/// What the host writes into the machine's registers, and what it plans memory by.
struct HostOrder {
  std::uint32_t triangles = 0;
  int depth = 0;                 ///< D
  std::uint64_t references = 0;  ///< M(D), for the plan alone: the machine finds its own
};

/// bad_input: the scene; resource_limit, invalid_argument: its depth.
Result<HostOrder> prepare_order(const MeshView& mesh, const PaperConfig& config);

/// Nine binary32 a triangle; what no host writes is left with a pattern that no step relies on.
void write_scene(const MeshView& mesh, const MemoryMap& map, ByteStore& store);

/// What the machine's registers say at the end.
struct MachineRegisters {
  std::uint64_t references = 0;
  std::uint32_t leaves = 0;
  std::uint32_t root = kDeviceLeaf;
};

DeviceImage read_image(const ByteStore& store, const MemoryMap& map, const Grid& grid,
                       std::uint32_t triangles, const MachineRegisters& registers);

/// The marks of all nodes of the complete tree, a bit each, as memory has them.
std::vector<std::uint8_t> read_marks(const ByteStore& store, const MemoryMap& map,
                                     const Grid& grid);
/// The arrays after the sort; the marks with what only the cache had. The pairs before the sort
/// have to be read before it reuses their memory.
void read_arrays(const ByteStore& store, const MemoryMap& map, const MachineRegisters& registers,
                 const std::vector<std::uint8_t>& marks, IntermediateArrays& arrays);
void read_pairs(const ByteStore& store, const PaperConfig& config, Address pairs,
                std::uint64_t references, IntermediateArrays& arrays);

}  // namespace fasttree::model
