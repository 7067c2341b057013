// SPDX-License-Identifier: Apache-2.0
// Whether a memory holds what a machine lays out in it.
#pragma once

#include <cstdint>

#include "fasttree/status.h"
#include "model/memory/memory.h"

namespace fasttree::model {

/// resource_limit where `bytes` from address 0 on are more than the memory holds.
Status check_capacity(const MemoryTraits& traits, std::uint64_t bytes);

}  // namespace fasttree::model
