// SPDX-License-Identifier: Apache-2.0
// The machine fasttree-2: ours.
#pragma once

#include <cstdint>

#include "model/config/fields.h"

namespace fasttree::model {

/// Section [fasttree2]. A new key is a member here and a line in declare().
struct FastTree2Config {
  std::uint32_t bus_bytes_per_cycle = 32;

  static void declare(Fields<FastTree2Config>& fields) {
    using C = FastTree2Config;
    fields.power_of_two("bus_bytes_per_cycle", &C::bus_bytes_per_cycle, 4, 256,
                        "What the bus moves in a cycle");
  }
};

}  // namespace fasttree::model
