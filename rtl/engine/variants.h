// SPDX-License-Identifier: Apache-2.0
// For which configurations the top level has been verilated: parameters are fixed when it is built.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "fasttree/status.h"
#include "model/config/machine_config.h"
#include "rtl/engine/top.h"

namespace fasttree::rtl {

struct Variant {
  std::string name;
  std::vector<std::string> keys;  ///< "key=value" of section [paper], where other than the default
  std::unique_ptr<Top> (*make)();
};

/// In the order of the build's list (FASTTREE_RTL_VARIANTS).
const std::vector<Variant>& variants();

/// The variant for a configuration. invalid_argument where there is none, naming the key that
/// differs from the nearest one, or where the architecture has no RTL.
Result<const Variant*> find_variant(const model::MachineConfig& config);

}  // namespace fasttree::rtl
