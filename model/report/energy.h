// SPDX-License-Identifier: Apache-2.0
// What a run costs in energy, by unit and in memory.
#pragma once

#include <string>
#include <vector>

#include "model/report/area.h"
#include "model/report/simulation.h"

namespace fasttree::model {

/// All units of one kind, or one way in which memory takes energy.
struct EnergyRow {
  std::string kind;
  double busy_pj = 0;  ///< 65 nm, in cycles with work
  double idle_pj = 0;  ///< 65 nm, in cycles without: clock and leakage
};

struct MemoryEnergyRow {
  std::string what;         ///< "bytes moved", "rows activated"
  std::uint64_t count = 0;  ///< of bytes, of rows
  double pj = 0;
};

struct EnergyReport {
  std::vector<EnergyRow> rows;
  std::vector<MemoryEnergyRow> memory_rows;  ///< empty where the memory is no DRAM
  double machine_pj = 0;                     ///< 65 nm
  double machine_28nm_pj = 0;
  double memory_pj = 0;        ///< in any process: it is another chip
  double machine_power_w = 0;  ///< mean over the run, 65 nm
  double machine_28nm_power_w = 0;
  double pj_per_triangle = 0;  ///< machine in 65 nm and memory
};

/// A cycle in which everything works takes the energy of the paper's power, shared out by area: 3.9
/// W at 500 MHz in 65 nm, at most 0.8 W in 28 nm. A cycle without work takes kIdleShare of it.
EnergyReport energy(const MachineConfig& config, const SimulationResult& result);

/// Assumed: clock tree and leakage without clock gating, of what a cycle with work takes.
inline constexpr double kIdleShare = 0.3;

/// What the report rests on, in one sentence, to be printed with it.
const char* energy_basis();

}  // namespace fasttree::model
