// SPDX-License-Identifier: Apache-2.0
// The memory that a configuration describes.
#pragma once

#include <memory>

#include "fasttree/status.h"
#include "model/memory/memory.h"
#include "model/memory/memory_config.h"

namespace fasttree::model {

/// `config` has passed validate().
std::unique_ptr<Memory> make_memory(const MemoryConfig& config);

/// resource_limit where `bytes` from address 0 on are more than the memory holds.
Status check_capacity(const MemoryTraits& traits, std::uint64_t bytes);

}  // namespace fasttree::model
