// SPDX-License-Identifier: Apache-2.0
// Section [memory]: the keys of MemoryConfig.
#pragma once

#include "model/config/fields.h"
#include "model/memory/memory_config.h"

namespace fasttree::model {

/// `preset` comes first: it sets all others, which may then be changed one by one.
Fields<MemoryConfig> memory_fields();

}  // namespace fasttree::model
