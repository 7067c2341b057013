// SPDX-License-Identifier: Apache-2.0
#include "model/report/energy.h"

#include <gtest/gtest.h>

#include "model/report/simulate.h"

namespace fasttree::model {
namespace {

/// A run in which each unit that has area works `busy` of 1000 cycles.
SimulationResult run_of(const MachineConfig& config, std::uint64_t busy) {
  SimulationResult result;
  result.clock_mhz = config.clock_mhz;
  result.cycles = 1000;
  result.triangles = 100;
  for (const AreaRow& row : area(config).rows) {
    if (row.kind == "control") continue;
    for (std::uint32_t i = 0; i < row.count; ++i) {
      result.units.push_back({row.kind, row.kind, {}, {Activity{busy, 1000 - busy, {}}}});
    }
  }
  return result;
}

TEST(Energy, AllBusyIsThePapersPower) {
  const MachineConfig config = load_config("paper-asic65").value();
  const EnergyReport report = energy(config, run_of(config, 1000));
  EXPECT_NEAR(report.machine_power_w, 3.9, 1e-9);
  EXPECT_NEAR(report.machine_28nm_power_w, 0.8, 1e-9);
  EXPECT_EQ(report.memory_pj, 0);
}

TEST(Energy, LessWorkTakesLessButNeverNothing) {
  const MachineConfig config = load_config("paper-asic65").value();
  double last = 0;
  for (const std::uint64_t busy : {0u, 1u, 500u, 999u, 1000u}) {
    const double pj = energy(config, run_of(config, busy)).machine_pj;
    EXPECT_GT(pj, last);
    last = pj;
  }
  // Idle throughout: the idle share of all but the control, which always works.
  const EnergyReport idle = energy(config, run_of(config, 0));
  for (const EnergyRow& row : idle.rows) EXPECT_EQ(row.busy_pj > 0, row.kind == "control");
  EXPECT_LT(idle.machine_power_w, 3.9 / 2 + 0.5);
}

TEST(Energy, MemoryByBytesMovedAndRows) {
  MachineConfig config = load_config("paper-asic65").value();
  SimulationResult result = run_of(config, 10);
  result.memory_traits.access_bytes = 32;
  result.memory.reads = 10;
  result.memory.writes = 5;
  result.memory.row_misses = 2;
  result.memory.row_conflicts = 1;
  const EnergyReport report = energy(config, result);
  ASSERT_EQ(report.memory_rows.size(), 2u);
  EXPECT_EQ(report.memory_rows[0].count, 15u * 32);
  EXPECT_EQ(report.memory_rows[1].count, 3u);
  EXPECT_DOUBLE_EQ(report.memory_pj, report.memory_rows[0].pj + report.memory_rows[1].pj);
  EXPECT_DOUBLE_EQ(report.pj_per_triangle, (report.machine_pj + report.memory_pj) / 100);
  // Each counts.
  ++result.memory.row_conflicts;
  EXPECT_GT(energy(config, result).memory_pj, report.memory_pj);
  ++result.memory.writes;
  EXPECT_GT(energy(config, result).memory_pj, report.memory_pj + 1e-9);
  // An ideal memory has none.
  ASSERT_TRUE(apply_override(config, "memory.preset=ideal").ok());
  EXPECT_TRUE(energy(config, result).memory_rows.empty());
}

TEST(Energy, OfARun) {
  const float vertices[] = {0, 0, 0, 1, 0, 0, 0, 1, 1};
  MeshView mesh;
  mesh.positions = vertices;
  mesh.vertex_count = 3;
  mesh.triangle_count = 1;
  for (const char* name : {"paper-asic65", "fasttree-2"}) {
    const MachineConfig config = load_config(name).value();
    const auto result = simulate(mesh, config);
    ASSERT_TRUE(result.ok()) << result.status().message();
    const EnergyReport report = energy(config, result.value());
    const double of_paper = area(config).mm2_65nm / 5.4;
    EXPECT_GT(report.machine_power_w, kIdleShare * 3.9 * of_paper);
    EXPECT_LT(report.machine_power_w, 3.9 * of_paper);
    EXPECT_GT(report.memory_pj, 0);
    // Every unit that kept an account of work is in some row.
    for (const UnitRecord& unit : result.value().units) {
      if (unit.kind == "scene_reader") continue;  // part of the bus
      EXPECT_TRUE(std::any_of(report.rows.begin(), report.rows.end(), [&](const EnergyRow& row) {
        return row.kind == unit.kind || row.kind == unit_stem(unit.name);
      })) << unit.kind;
    }
  }
}

}  // namespace
}  // namespace fasttree::model
