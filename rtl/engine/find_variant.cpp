// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <string_view>

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

std::string text(const model::FieldValue& value) {
  if (const bool* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const auto* count = std::get_if<std::uint64_t>(&value)) return std::to_string(*count);
  if (const double* real = std::get_if<double>(&value)) return std::to_string(*real);
  return std::get<std::string>(value);
}

// Keys in which the two differ, "key = ours (not theirs)".
std::vector<std::string> differences(const model::PaperConfig& wanted,
                                     const model::PaperConfig& built) {
  model::Fields<model::PaperConfig> fields;
  model::PaperConfig::declare(fields);
  std::vector<std::string> list;
  for (const model::Field& field : fields.list()) {
    if (std::find(kFree.begin(), kFree.end(), field.key) != kFree.end()) continue;
    const std::string a = text(field.get(&wanted));
    const std::string b = text(field.get(&built));
    if (a != b) list.push_back("paper." + field.key + " = " + b + ", not " + a);
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

}  // namespace fasttree::rtl
