// SPDX-License-Identifier: Apache-2.0
// A machine with its memory, as a configuration file (TOML) describes it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "fasttree/status.h"
#include "model/config/fasttree2_config.h"
#include "model/config/paper_config.h"
#include "model/memory/memory_config.h"

namespace fasttree::model {

struct MachineConfig {
  std::string name;
  std::string architecture = "paper";  ///< "paper" or "fasttree-2"
  double clock_mhz = 500;
  MemoryConfig memory;
  PaperConfig paper;          ///< where architecture is "paper"
  FastTree2Config fasttree2;  ///< where architecture is "fasttree-2"

  double cycle_ps() const { return 1e6 / clock_mhz; }
};

/// Names of the configurations that come with the library (configs/*.toml).
std::vector<std::string> config_names();

/// A configuration by one of config_names(), or from the file at this path.
Result<MachineConfig> load_config(const std::string& name_or_path);

/// A configuration from its text. `origin` is what messages call it, and its name where the text
/// gives none.
Result<MachineConfig> parse_config(std::string_view text, const std::string& origin);

/// Changes one key: "section.key=value", or "key=value" for those outside sections. Setting
/// memory.preset sets all of the memory. The configuration stays as it was where this fails.
Status apply_override(MachineConfig& config, const std::string& assignment);

/// The whole configuration as TOML, each key with its comment and what is allowed. Reading it
/// gives the same configuration.
std::string to_toml(const MachineConfig& config);

}  // namespace fasttree::model
