// SPDX-License-Identifier: Apache-2.0
#include "model/report/costs.h"

#include "model/report/area.h"
#include "model/report/energy.h"

namespace fasttree::model {
namespace {

constexpr double kPicoPerMicro = 1e6;

CostTable area_table(const MachineConfig& config) {
  const AreaReport report = area(config);
  CostTable table;
  table.key = "area";
  table.title = "Area (estimate)";
  table.basis = area_basis();
  table.columns = {{"units", "units", 0},         {"luts", "LUTs", 0},
                   {"registers", "registers", 0}, {"ram_kbits", "RAM, kbit", 1},
                   {"mm2_65nm", "mm2, 65 nm", 3}, {"mm2_28nm", "mm2, 28 nm", 3}};
  for (const AreaRow& row : report.rows) {
    table.rows.push_back(
        {row.kind,
         {static_cast<double>(row.count), row.resources.luts, row.resources.registers,
          row.resources.ram_kbits, row.mm2_65nm, row.mm2_28nm}});
  }
  return table;
}

CostTable energy_table(const MachineConfig& config, const SimulationResult& result) {
  const EnergyReport report = energy(config, result);
  CostTable table;
  table.key = "energy";
  table.title = "Energy (estimate)";
  table.basis = energy_basis();
  table.columns = {
      {"busy_uj", "busy, uJ", 2}, {"idle_uj", "idle, uJ", 2}, {"memory_uj", "memory, uJ", 2}};
  for (const EnergyRow& row : report.rows) {
    table.rows.push_back({row.kind, {row.busy_pj / kPicoPerMicro, row.idle_pj / kPicoPerMicro, 0}});
  }
  for (const MemoryEnergyRow& row : report.memory_rows) {
    table.rows.push_back({"memory: " + row.what, {0, 0, row.pj / kPicoPerMicro}});
  }
  table.figures = {
      {"total_uj", "machine in 65 nm and memory, uJ",
       (report.machine_pj + report.memory_pj) / kPicoPerMicro, 2},
      {"pj_per_triangle", "pJ a triangle", report.pj_per_triangle, 0},
      {"power_65nm_w", "mean power of the machine in 65 nm, W", report.machine_power_w, 2},
      {"power_28nm_w", "in 28 nm, W", report.machine_28nm_power_w, 2}};
  return table;
}

}  // namespace

std::vector<CostTable> cost_tables(const MachineConfig& config, const SimulationResult& result) {
  return {area_table(config), energy_table(config, result)};
}

}  // namespace fasttree::model
