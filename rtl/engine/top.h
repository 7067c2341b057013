// SPDX-License-Identifier: Apache-2.0
// The verilated top level behind one interface, whatever its parameters.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fasttree/status.h"
#include "rtl/bench/axi_signals.h"

namespace fasttree::rtl {

/// The AXI4-Lite port, one transaction at a time, and what the top shows of itself.
struct HostSignals {
  bool write_valid = false, write_ready = false;  ///< address and data together
  bool answer_valid = false;                      ///< of a write; always taken
  bool read_valid = false, read_ready = false;
  bool data_valid = false;  ///< of a read; always taken
  std::uint32_t address = 0, write_data = 0, read_data = 0;
  bool irq = false;
  std::uint32_t stage = 0;
};

class Top {
 public:
  virtual ~Top() = default;

  virtual void reset(bool active) = 0;
  /// Inputs in, combinational outputs out.
  virtual void settle(AxiSignals& memory, HostSignals& host) = 0;
  /// The rising edge.
  virtual void clock() = 0;

  /// Four bits a unit, in the order of fasttree_top.
  virtual void activity(std::vector<std::uint8_t>& units) const = 0;

  /// Waveforms (FST) of the cycles between these two calls.
  virtual Status open_wave(const std::string& path) = 0;
  virtual void close_wave() = 0;

  virtual int failed_assertions() const = 0;
};

}  // namespace fasttree::rtl
