// SPDX-License-Identifier: Apache-2.0
// The memory that a configuration describes.
#pragma once

#include <memory>

#include "model/memory/memory.h"
#include "model/memory/memory_config.h"

namespace fasttree::model {

/// `config` has passed validate().
std::unique_ptr<Memory> make_memory(const MemoryConfig& config);

}  // namespace fasttree::model
