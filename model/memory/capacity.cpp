// SPDX-License-Identifier: Apache-2.0
#include "model/memory/capacity.h"

#include <string>

namespace fasttree::model {

Status check_capacity(const MemoryTraits& traits, std::uint64_t bytes) {
  if (traits.capacity_bytes == 0 || bytes <= traits.capacity_bytes) return {};
  return {StatusCode::resource_limit, "the scene needs " + std::to_string(bytes) +
                                          " bytes of memory, and " + traits.name + " has " +
                                          std::to_string(traits.capacity_bytes) +
                                          ". Ask for a smaller depth or choose a larger memory."};
}

}  // namespace fasttree::model
