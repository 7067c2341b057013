// SPDX-License-Identifier: Apache-2.0
// The board: the verilated accelerator with its memory and clock, and the processor's side of its
// registers.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "model/config/machine_config.h"
#include "model/report/simulation.h"
#include "model/system/timeline.h"
#include "rtl/bench/axi_memory.h"
#include "rtl/driver/fasttree_accel.h"
#include "rtl/engine/top.h"
#include "rtl/engine/traffic_account.h"
#include "rtl/engine/unit_account.h"

namespace fasttree::rtl {

/// Stem of the stage that the status register calls so; "" for none.
const char* stage_name(std::uint32_t stage);

class Board {
 public:
  /// After reset. `timeline_windows` as in SimulationOptions. `traffic` hears of every burst; null:
  /// no account is kept of anything.
  Board(Top& top, AxiMemory& memory, const model::MachineConfig& config,
        std::uint32_t timeline_windows, TrafficAccount* traffic);

  /// One cycle of everything.
  void step();

  /// The processor's accesses; each takes a few cycles.
  std::uint32_t read(std::uint32_t address);
  void write(std::uint32_t address, std::uint32_t data);
  /// The driver of fasttree_accel.h, over these two. The board has to stay where it is.
  ft_accel driver();

  bool irq() const { return host_.irq; }

  std::uint32_t stage() const { return stage_; }
  std::uint64_t build_cycles() const { return recorded_; }
  /// Stages, units and timeline, after the build.
  void report(model::SimulationResult& result);

 private:
  std::vector<const model::Unit*> pointers() const;
  void account();
  void end_stage();

  Top& top_;
  AxiMemory& memory_;
  AxiSignals bus_;
  HostSignals host_;
  std::vector<std::unique_ptr<RecordedUnit>> units_;
  std::vector<std::uint8_t> activity_;
  model::Timeline timeline_;
  TrafficAccount* traffic_;
  std::uint32_t stage_ = 0;
  std::uint64_t recorded_ = 0;  ///< cycles inside stages
  std::vector<model::StageRecord> stages_;
};

}  // namespace fasttree::rtl
