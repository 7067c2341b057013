// SPDX-License-Identifier: Apache-2.0
// A scene through the verilated accelerator, beside the same memory models as the cycle-level model
// uses, with the same account of every cycle and byte.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "fasttree/mesh.h"
#include "fasttree/status.h"
#include "model/config/machine_config.h"
#include "model/memory/byte_store.h"
#include "model/memory/memory.h"
#include "model/report/simulation.h"
#include "rtl/bench/axi_memory.h"
#include "rtl/driver/fasttree_accel.h"

namespace fasttree::rtl {

struct RtlOptions {
  /// Waveforms of the cycles [from, to) of the build, as FST; empty: none.
  std::string wave_file;
  std::uint64_t wave_from = 0;
  std::uint64_t wave_to = ~std::uint64_t{0};

  /// Memory answers in the wildest way that AXI allows (AxiMemoryOptions::wild), by this seed; 0:
  /// no.
  std::uint32_t wild_seed = 0;
  /// For tests: breaks something in memory before the build.
  std::function<void(AxiMemory&)> spoil;
  /// For tests: changes the order and the scene after the host has seen to both.
  std::function<void(ft_accel_order&, model::ByteStore&)> tamper;
  /// For tests: looks at memory after the build, whether it failed or not.
  std::function<void(const model::ByteStore&)> inspect;
};

/// invalid_argument: no RTL was built for the configuration.
Status check_built(const model::MachineConfig& config);

/// Runs the machine. The host checks the scene and works its depth out as for the model; the
/// accelerator refuses what it finds itself: bad_input (a coordinate), resource_limit (room, the
/// watchdog, max_cycles), io_error (memory answered with an error). cancelled.
/// invalid_argument: as check_built().
Result<model::SimulationResult> simulate_rtl(const MeshView& mesh,
                                             const model::MachineConfig& config,
                                             const model::SimulationOptions& options,
                                             const RtlOptions& rtl = {});

/// The same with a memory of the caller's, which has to be idle.
Result<model::SimulationResult> simulate_rtl(const MeshView& mesh,
                                             const model::MachineConfig& config,
                                             const model::SimulationOptions& options,
                                             const RtlOptions& rtl, model::Memory& memory);

}  // namespace fasttree::rtl
