// SPDX-License-Identifier: Apache-2.0
// Where everything lies in off-chip memory, planned before any of it is allocated.
#pragma once

#include <cstdint>

#include "fasttree/status.h"
#include "model/config/paper_config.h"
#include "model/kernel/quantities.h"

namespace fasttree::model {

/// Begins of the regions. The order is that of their use; each begins at a multiple of 4 KB.
struct MemoryMap {
  Address scene;         ///< nine binary32 a triangle, from the host
  Address pairs[2];      ///< between the rounds, in turn
  Address sorted_codes;  ///< of the last round
  Address sorted_ids;    ///< of the last round: the device image's ids
  Address leaf_codes;
  Address leaf_rows;  ///< the device image's leaf table
  Address marks;
  Address nodes;  ///< the device image's internal nodes
  std::uint64_t bytes = 0;
  std::uint64_t mark_bytes = 0;
};

/// For N triangles with M references at depth D. resource_limit where it does not fit the memory.
Result<MemoryMap> plan_memory(const PaperConfig& config, std::uint32_t triangles,
                              std::uint64_t references, int depth);

}  // namespace fasttree::model
