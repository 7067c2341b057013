// SPDX-License-Identifier: Apache-2.0
// Which memory hangs off the machine: everything that a configuration can say of it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fasttree/status.h"

namespace fasttree::model {

enum class MemoryKind : std::uint8_t { ideal, fixed, dram };

/// Which channel an address belongs to: neighbouring bursts to different ones, or long blocks.
enum class Interleave : std::uint8_t { burst, row };

/// Which part of a channel's address is lowest above the column: the bank (a stream goes over all
/// banks, row by row) or the row (a stream stays in its bank).
enum class AddressOrder : std::uint8_t { row_bank_column, bank_row_column };

enum class RefreshPolicy : std::uint8_t { none, all_bank, per_bank };

/// The device: geometry of one channel and its timing rules in clocks. Defaults: LPDDR3-1600 x32.
struct DramSpec {
  std::uint32_t channels = 1;
  std::uint32_t channel_bits = 32;
  std::uint32_t banks = 8;
  std::uint32_t rows = 32768;
  std::uint32_t columns = 1024;
  std::uint32_t tck_ps = 1250;
  std::uint32_t burst_length = 8;
  std::uint32_t cl = 12;
  std::uint32_t cwl = 9;
  std::uint32_t trcd = 15;
  std::uint32_t trp = 15;
  std::uint32_t tras = 34;
  std::uint32_t trc = 49;
  std::uint32_t trrd = 8;
  std::uint32_t tfaw = 40;
  std::uint32_t twtr = 6;
  std::uint32_t twr = 12;
  std::uint32_t trtp = 6;
  std::uint32_t tccd = 4;
  std::uint32_t trtw_gap = 2;
  std::uint32_t trefi = 3120;
  std::uint32_t trfc_ab = 168;
  std::uint32_t trfc_pb = 72;

  std::uint32_t burst_clocks() const { return burst_length / 2; }
  std::uint32_t access_bytes() const { return burst_length * channel_bits / 8; }
  std::uint64_t row_bytes() const { return std::uint64_t{columns} * channel_bits / 8; }
  std::uint64_t channel_bytes() const { return row_bytes() * banks * rows; }
  double peak_gb_s() const { return channels * (channel_bits / 8.0) * 2000.0 / tck_ps; }
};

/// How the controller uses the device.
struct ControllerConfig {
  Interleave interleave = Interleave::burst;
  std::uint32_t row_interleave_bytes = 32768;
  AddressOrder address_order = AddressOrder::row_bank_column;
  bool bank_hash = true;
  std::uint32_t read_queue = 32;
  std::uint32_t write_queue = 64;
  std::uint32_t write_drain_high = 48;
  std::uint32_t write_drain_low = 8;
  std::uint32_t write_idle_clocks = 16;
  std::uint32_t starvation_clocks = 1000;
  RefreshPolicy refresh = RefreshPolicy::per_bank;
  std::uint32_t refresh_postpone = 0;
};

struct MemoryConfig {
  std::string preset = "lpddr3-1600";
  MemoryKind kind = MemoryKind::dram;
  // ideal and fixed
  std::uint32_t access_bytes = 32;
  double latency_ns = 100;
  double bandwidth_gb_s = 0;
  std::uint32_t fixed_queue = 64;
  // dram
  DramSpec dram;
  ControllerConfig controller;
};

/// Names of the presets, and the memory of one of them.
const std::vector<std::string>& memory_presets();
Result<MemoryConfig> memory_preset(const std::string& name);

/// Whether the values fit together (each alone is in its range already).
Status validate(const MemoryConfig& config);

}  // namespace fasttree::model
