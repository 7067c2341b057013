// SPDX-License-Identifier: Apache-2.0
// Any bytes as a machine's configuration: read or refused with a message, and what is read comes
// back from its own text unchanged.
//
// Run: config_fuzz -max_len=8192 NEW_FINDS fuzz/corpus/config
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "model/config/machine_config.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fasttree;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const Result<model::MachineConfig> read = model::parse_config(text, "fuzz");
  if (!read.ok()) {
    if (read.status().message().empty()) std::abort();
    return 0;
  }
  const std::string written = model::to_toml(read.value());
  const Result<model::MachineConfig> again = model::parse_config(written, "written");
  if (!again.ok() || model::to_toml(again.value()) != written) std::abort();
  // The same bytes as a change of a key.
  model::MachineConfig changed = read.value();
  if (!model::apply_override(changed, std::string(text)).ok() &&
      model::to_toml(changed) != written) {
    std::abort();
  }
  return 0;
}
