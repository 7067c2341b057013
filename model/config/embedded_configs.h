// SPDX-License-Identifier: Apache-2.0
// The configurations of configs/, inside the library: none has to be found at run time.
#pragma once

#include <span>
#include <string_view>

namespace fasttree::model {

struct EmbeddedConfig {
  std::string_view name;  ///< the file's, without .toml
  std::string_view text;
};

/// In alphabetical order. The definition is written by model/config/CMakeLists.txt.
std::span<const EmbeddedConfig> embedded_configs();

}  // namespace fasttree::model
