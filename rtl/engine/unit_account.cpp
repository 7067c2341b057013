// SPDX-License-Identifier: Apache-2.0
#include "rtl/engine/unit_account.h"

namespace fasttree::rtl {

std::vector<std::unique_ptr<RecordedUnit>> recorded_units(const model::PaperConfig& config) {
  std::vector<std::unique_ptr<RecordedUnit>> units;
  const auto add = [&](std::string name, const char* kind, std::vector<std::string> reasons = {}) {
    units.push_back(std::make_unique<RecordedUnit>(std::move(name), kind, std::move(reasons)));
  };
  add("bus", "bus", {"memory"});
  add("scene_reader", "scene_reader", {"bus", "scene_bound or morton_code"});
  add("sbcu_lower", "scene_bound");
  add("sbcu_upper", "scene_bound");
  for (std::uint32_t i = 0; i < config.morton_code.units; ++i) {
    add("mcgu" + std::to_string(i), "morton_code", {"pair_writer"});
  }
  add("pair_writer", "morton_code", {"bus"});
  for (std::uint32_t i = 0; i < config.prefix_sum.units; ++i) {
    add("psu" + std::to_string(i), "prefix_sum", {"radix_sort"});
  }
  add("rsu", "radix_sort", {"bus (reading)", "bus (writing)", "prefix_sum"});
  add("lngu", "leaf_node", {"bus (reading)", "bus (writing)"});
  add("ingu", "internal_node", {"bus", "split_plane", "bit_encoding"});
  add("split_plane", "internal_node", {"bus"});
  add("beu", "bit_encoding", {"bus", "mark_cache"});
  add("mark_cache", "mark_cache", {"bus", "path_compression"});
  add("pcu", "path_compression", {"bus (reading)", "bus (writing)", "mark_cache"});
  return units;
}

}  // namespace fasttree::rtl
