// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <string_view>

#include "model/config/sections.h"
#include "rtl/engine/rtl_machine.h"
#include "rtl/engine/variants.h"

namespace fasttree::rtl {
namespace {

// Keys of [paper] that no gate depends on: the host's, the order's, and those of the model alone.
constexpr std::array<std::string_view, 13> kFree{
    "axes",
    "depth_fixed",
    "depth",
    "extra_depth",
    "max_growth",
    "radix_sort_sorted_bits",
    "control_step_cycles",
    "control_setup_cycles",
    "control_memory_mbytes",
    "control_stuck_cycles",
    "control_count_host",
    "control_host_bytes_per_cycle",
    "bus_commands_per_cycle",
};

// Keys in which the two differ, "key = ours (not theirs)".
std::vector<std::string> differences(const model::PaperConfig& wanted,
                                     const model::PaperConfig& built) {
  model::Fields<model::PaperConfig> fields;
  model::PaperConfig::declare(fields);
  std::vector<std::string> list;
  for (const model::Field& field : fields.list()) {
    if (std::find(kFree.begin(), kFree.end(), field.key) != kFree.end()) continue;
    const model::FieldValue a = field.get(&wanted), b = field.get(&built);
    if (a == b) continue;
    list.push_back("paper." + field.key + " = " + model::text_of(b) + ", not " + model::text_of(a));
  }
  return list;
}

}  // namespace

Result<const Variant*> find_variant(const model::MachineConfig& config) {
  if (config.architecture != "paper") {
    return Status(StatusCode::invalid_argument,
                  "there is RTL for the paper's architecture alone, not for " +
                      config.architecture + ". Choose a paper-* configuration, or the model.");
  }
  std::vector<std::string> nearest;
  for (const Variant& variant : variants()) {
    model::MachineConfig built;
    for (const std::string& key : variant.keys) {
      if (Status status = apply_override(built, "paper." + key); !status.ok()) return status;
    }
    std::vector<std::string> found = differences(config.paper, built.paper);
    if (found.empty()) return &variant;
    if (nearest.empty() || found.size() < nearest.size()) nearest = std::move(found);
  }
  std::string message = "the RTL was not built for this configuration: the nearest has ";
  for (std::size_t i = 0; i < nearest.size(); ++i) message += (i > 0 ? "; " : "") + nearest[i];
  message += ". Take that, or build another variant (docs/accelerator/rtl.md).";
  return Status(StatusCode::invalid_argument, message);
}

Status check_built(const model::MachineConfig& config) {
  return find_variant(config).status();
}

}  // namespace fasttree::rtl
