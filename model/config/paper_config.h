// SPDX-License-Identifier: Apache-2.0
// The machine of the paper: what it states and, where it is silent, our assumptions by name.
#pragma once

#include <cstdint>

#include "model/config/fields.h"

namespace fasttree::model {

/// Section [paper]. A new key is a member here and a line in declare().
struct PaperConfig {
  std::uint32_t bus_bytes_per_cycle = 16;

  static void declare(Fields<PaperConfig>& fields) {
    using C = PaperConfig;
    fields.power_of_two("bus_bytes_per_cycle", &C::bus_bytes_per_cycle, 4, 256,
                        "What the bus moves in a cycle (the paper does not say)");
  }
};

}  // namespace fasttree::model
