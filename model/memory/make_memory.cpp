// SPDX-License-Identifier: Apache-2.0
#include "model/memory/make_memory.h"

#include "model/memory/dram_memory.h"
#include "model/memory/simple_memory.h"

namespace fasttree::model {

std::unique_ptr<Memory> make_memory(const MemoryConfig& config) {
  if (config.kind == MemoryKind::dram) return std::make_unique<DramMemory>(config);
  return std::make_unique<SimpleMemory>(config);
}

}  // namespace fasttree::model
