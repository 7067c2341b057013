// SPDX-License-Identifier: Apache-2.0
#include "model/memory/memory_config.h"

#include <algorithm>

namespace fasttree::model {
namespace {

/// One channel of DDR3-1600 (11-11-11) of 64 bits: a 1 GB module of eight 1 Gb x8 devices.
MemoryConfig ddr3_1600() {
  MemoryConfig config;
  DramSpec& d = config.dram;
  d.channel_bits = 64;
  d.rows = 16384;
  d.cl = 11;
  d.cwl = 8;
  d.trcd = 11;
  d.trp = 11;
  d.tras = 28;
  d.trc = 39;
  d.trrd = 5;
  d.tfaw = 24;
  d.twtr = 6;
  d.twr = 12;
  d.trtp = 6;
  d.trefi = 6240;
  d.trfc_ab = 88;
  d.trfc_pb = 88;  // DDR3 has none: all_bank is the policy
  config.controller.refresh = RefreshPolicy::all_bank;
  return config;
}

}  // namespace

const std::vector<std::string>& memory_presets() {
  static const std::vector<std::string> names = {"ideal", "fixed", "lpddr3-1600",
                                                 "lpddr3-1600-dual", "ddr3-1600"};
  return names;
}

Result<MemoryConfig> memory_preset(const std::string& name) {
  MemoryConfig config;
  if (name == "ideal") {
    config.kind = MemoryKind::ideal;
  } else if (name == "fixed") {
    config.kind = MemoryKind::fixed;
  } else if (name == "lpddr3-1600-dual") {
    config.dram.channels = 2;
  } else if (name == "ddr3-1600") {
    config = ddr3_1600();
  } else if (name != "lpddr3-1600") {
    return Status(StatusCode::invalid_argument, "there is no memory preset '" + name + "'");
  }
  config.preset = name;
  return config;
}

Status validate(const MemoryConfig& config) {
  const auto refuse = [](const char* what) {
    return Status(StatusCode::bad_input, std::string("memory: ") + what);
  };
  if (config.kind != MemoryKind::dram) return {};
  const DramSpec& d = config.dram;
  const ControllerConfig& c = config.controller;
  if (d.columns % d.burst_length != 0) return refuse("columns is not a multiple of burst_length");
  if (d.tccd < d.burst_clocks()) return refuse("tccd_clocks is less than a burst on the bus");
  if (d.cl + d.burst_clocks() + d.trtw_gap < d.cwl) {
    return refuse("cwl_clocks is greater than cl_clocks, a burst and trtw_gap_clocks together");
  }
  if (d.tras < d.trcd) return refuse("tras_clocks is less than trcd_clocks");
  if (d.trc < d.tras) return refuse("trc_clocks is less than tras_clocks");
  if (c.write_drain_high > c.write_queue) return refuse("write_drain_high is over write_queue");
  if (c.write_drain_low >= c.write_drain_high) {
    return refuse("write_drain_low is not below write_drain_high");
  }
  if (c.row_interleave_bytes < d.access_bytes()) {
    return refuse("row_interleave_bytes is less than a burst");
  }
  // Half of the time for refresh at most, so that every other command finds its turn.
  const std::uint64_t share = c.refresh == RefreshPolicy::per_bank
                                  ? std::uint64_t{d.trfc_pb} * d.banks
                                  : std::uint64_t{d.trfc_ab};
  if (c.refresh != RefreshPolicy::none && 2 * share > d.trefi) {
    return refuse("refresh takes more than half of trefi_clocks");
  }
  return {};
}

}  // namespace fasttree::model
