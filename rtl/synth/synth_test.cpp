// SPDX-License-Identifier: Apache-2.0
// The counts and the longest path on netlists small enough to work them out by hand.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "rtl/synth/figures.h"
#include "rtl/synth/netlist.h"
#include "rtl/synth/timing.h"

namespace fasttree::synth {
namespace {

using nlohmann::json;

/// Builds what Yosys would write. Nets are numbers from 2 on.
class Unit {
 public:
  Unit& port(const std::string& name, bool input, const json& bits) {
    top_["ports"][name] = {{"direction", input ? "input" : "output"}, {"bits", bits}};
    return *this;
  }
  Unit& name(const std::string& name, const json& bits, bool hidden = false) {
    top_["netnames"][name] = {{"hide_name", hidden ? 1 : 0}, {"bits", bits}};
    return *this;
  }
  Unit& cell(const std::string& name, const std::string& type, const json& inputs,
             const json& outputs, const json& parameters = json::object()) {
    json connections = inputs, directions = json::object();
    for (const auto& [pin, bits] : inputs.items()) directions[pin] = "input";
    for (const auto& [pin, bits] : outputs.items()) {
      directions[pin] = "output";
      connections[pin] = bits;
    }
    top_["cells"][name] = {{"type", type},
                           {"parameters", parameters},
                           {"port_directions", directions},
                           {"connections", connections}};
    return *this;
  }
  /// A flip-flop with its clock on net 2.
  Unit& ff(const std::string& name, int d, int q) {
    return cell(name, "FDRE", {{"C", {2}}, {"CE", {"1"}}, {"D", {d}}, {"R", {"0"}}}, {{"Q", {q}}});
  }
  Unit& lut(const std::string& name, int a, int o) {
    return cell(name, "LUT1", {{"I0", {a}}}, {{"O", {o}}});
  }
  Netlist read() const {
    json top = top_;
    for (const char* part : {"ports", "cells", "netnames"}) {
      if (!top.contains(part)) top[part] = json::object();
    }
    return read_netlist(json{{"modules", {{"unit", top}}}}.dump(), "unit");
  }
  Timing time(const TimingOptions& options = {}) const { return analyse(read(), options); }

 private:
  json top_;
};

const Delays kDelays;

TEST(SynthTiming, BetweenTwoFlipFlops) {
  const Timing timing = Unit().ff("a", 3, 10).lut("l", 10, 11).ff("b", 11, 12).time();
  // One wire; from the LUT to its flip-flop nothing is routed.
  EXPECT_NEAR(timing.registers.ns,
              kDelays.ff_clock_to_q + kDelays.net + kDelays.lut + kDelays.ff_setup, 1e-9);
  EXPECT_EQ(timing.registers.levels, 1);
  EXPECT_NEAR(timing.registers.mhz(), 1000 / timing.registers.ns, 1e-9);
}

TEST(SynthTiming, TheLongestOfSeveral) {
  Unit unit;
  unit.ff("a", 3, 10).name("start", json{10}).name("stop", json{20});
  unit.lut("l0", 10, 11).lut("l1", 11, 12).lut("l2", 12, 13).ff("b", 13, 20);
  unit.lut("short", 10, 14).ff("c", 14, 21);
  const Path path = unit.time().registers;
  EXPECT_EQ(path.levels, 3);
  ASSERT_EQ(path.steps.size(), 5u);
  EXPECT_EQ(path.steps.front().cell, "FDRE");
  EXPECT_EQ(path.steps.front().signal, "start");
  EXPECT_EQ(path.steps.back().cell, "FDRE.D");
  EXPECT_EQ(path.steps.back().signal, "stop");
  EXPECT_NEAR(path.steps.back().ns, path.ns, 1e-9);
  // The first wire has two sinks.
  EXPECT_NEAR(path.ns,
              kDelays.ff_clock_to_q + kDelays.net + kDelays.net_per_doubling + 2 * kDelays.net +
                  3 * kDelays.lut + kDelays.ff_setup,
              1e-9);
}

TEST(SynthTiming, PortsCountOnlyWithThem) {
  Unit unit;
  unit.port("in", true, {4}).port("still", true, {5}).port("out", false, {11});
  unit.lut("l0", 4, 10).lut("l1", 10, 11);
  EXPECT_EQ(unit.time().registers.ns, 0);
  EXPECT_TRUE(unit.time().registers.steps.empty());
  const Path path = unit.time().any;
  EXPECT_EQ(path.levels, 2);
  EXPECT_EQ(path.steps.front().cell, "port");
  EXPECT_EQ(path.steps.back().signal, "out");
  TimingOptions options;
  options.still = {"in"};
  EXPECT_EQ(unit.time(options).any.ns, 0);
}

TEST(SynthTiming, ACarryChainIsFasterThanItsLookUpTables) {
  // Two CARRY4 in a row: in through S of the first, out through O of the second.
  const json open = {"0", "0", "0", "0"};
  Unit unit;
  unit.ff("a", 3, 10).lut("s", 10, 11);
  unit.cell("c0", "CARRY4", {{"S", {11, "0", "0", "0"}}, {"DI", open}, {"CI", {"0"}}},
            {{"CO", {20, 21, 22, 23}}, {"O", {24, 25, 26, 27}}});
  unit.cell("c1", "CARRY4", {{"S", open}, {"DI", open}, {"CI", {23}}},
            {{"CO", {30, 31, 32, 33}}, {"O", {34, 35, 36, 37}}});
  unit.ff("b", 37, 40);
  const Path path = unit.time().registers;
  EXPECT_EQ(path.levels, 3);
  EXPECT_NEAR(path.ns,
              kDelays.ff_clock_to_q + kDelays.net + kDelays.lut + kDelays.carry_in_s +
                  kDelays.carry_out + kDelays.ff_setup,
              1e-9);
}

TEST(SynthTiming, MemoriesAndMultipliersBeginAndEndPaths) {
  Unit ram;
  ram.cell("r", "RAMB18E1", {{"ADDRARDADDR", {12}}, {"CLKARDCLK", {2}}}, {{"DOADO", {10}}},
           {{"DOA_REG", "0"}});
  ram.lut("l", 10, 12);
  EXPECT_NEAR(ram.time().registers.ns,
              kDelays.bram_clock + 2 * kDelays.net + kDelays.lut + kDelays.bram_setup, 1e-9);

  Unit dsp;
  const json inputs = {{"A", {10}}, {"CLK", {2}}};
  const auto with = [&](const char* a, const char* m, const char* p) {
    Unit unit;
    unit.ff("a", 3, 10).ff("b", 11, 12);
    unit.cell("d", "DSP48E1", inputs, {{"P", {11}}}, {{"AREG", a}, {"MREG", m}, {"PREG", p}});
    return unit.time().registers.ns;
  };
  const double through = with("0", "0", "0"), all = with("1", "1", "1");
  EXPECT_NEAR(through,
              kDelays.ff_clock_to_q + 2 * kDelays.net + kDelays.dsp_multiply + kDelays.ff_setup,
              1e-9);
  EXPECT_NEAR(all, kDelays.ff_clock_to_q + kDelays.net + kDelays.dsp_setup, 1e-9);
  EXPECT_NEAR(with("1", "0", "0"), kDelays.dsp_from_input + kDelays.net + kDelays.ff_setup, 1e-9);
  EXPECT_NEAR(with("0", "1", "0"), kDelays.ff_clock_to_q + kDelays.net + kDelays.dsp_setup_multiply,
              1e-9);
}

TEST(SynthTiming, AReadPortOfAMemoryMayFeedItsNext) {
  // Which is a loop of cells but not of wires.
  Unit unit;
  unit.ff("a", 3, 10).ff("b", 12, 13);
  unit.cell("m", "RAM32M",
            {{"ADDRA", {10}}, {"ADDRB", {11}}, {"ADDRD", {"0"}}, {"WCLK", {2}}, {"WE", {"0"}}},
            {{"DOA", {11}}, {"DOB", {12}}});
  const Path path = unit.time().registers;
  EXPECT_EQ(path.levels, 1);
  EXPECT_NEAR(path.ns, kDelays.lutram_clock + kDelays.net + kDelays.lutram_read + kDelays.ff_setup,
              1e-9);
}

TEST(SynthTiming, RefusesLoopsAndWhatItDoesNotKnow) {
  EXPECT_THROW(Unit().lut("a", 10, 11).lut("b", 11, 10).time(), std::runtime_error);
  EXPECT_THROW(Unit().cell("l", "LDCE", {{"D", {3}}}, {{"Q", {4}}}).time(), std::runtime_error);
  EXPECT_THROW(read_netlist("{}", "unit"), std::runtime_error);
  EXPECT_THROW(read_netlist("nonsense", "unit"), std::runtime_error);
}

TEST(SynthTiming, AWireToManyTakesLongerUpToABound) {
  double before = 0;
  for (const std::size_t sinks : {1u, 2u, 8u, 100u, 1000u}) {
    const double now = net_delay("FDRE", "LUT6", "I0", sinks, kDelays);
    EXPECT_GT(now, before);
    before = now;
  }
  EXPECT_EQ(net_delay("FDRE", "LUT6", "I0", 1'000'000, kDelays), kDelays.net_most);
}

TEST(SynthCount, LookUpTablesOfEachKind) {
  Unit unit;
  unit.ff("f", 3, 4).lut("l", 3, 5);
  unit.cell("i", "INV", {{"I", {3}}}, {{"O", {6}}});
  unit.cell("m", "RAM64M", {{"DIA", {3}}}, {{"DOA", {7}}});
  unit.cell("s", "SRL16E", {{"D", {3}}}, {{"Q", {8}}});
  unit.cell("b", "RAMB36E1", {{"DIADI", {3}}}, {{"DOADO", {9}}});
  unit.cell("d", "DSP48E1", {{"A", {3}}}, {{"P", {10}}});
  const FpgaFigures n = count_xc7(unit.read());
  EXPECT_EQ(n.luts, 7);
  EXPECT_EQ(n.memory_luts, 4);
  EXPECT_EQ(n.shift_luts, 1);
  EXPECT_EQ(n.flip_flops, 1);
  EXPECT_EQ(n.bram_kbits(), 36);
  EXPECT_EQ(n.dsp, 1);
  EXPECT_EQ(n.lutram_kbits(), 0.25);
}

TEST(SynthCount, StandardCellsByTheirArea) {
  const auto areas = read_areas(
      "library(x) {\n cell (NAND2X1) {\n  area : 24;\n  pin(A) { area : 7; }\n }\n"
      " cell (DFFPOSX1) {\n  cell_footprint : dff;\n  area : 96;\n }\n}\n");
  ASSERT_EQ(areas.size(), 2u);
  Unit unit;
  unit.cell("n", "NAND2X1", {{"A", {3}}, {"B", {4}}}, {{"Y", {5}}});
  unit.cell("f", "DFFPOSX1", {{"D", {5}}, {"CLK", {2}}}, {{"Q", {6}}});
  unit.cell("m", "$mem_v2", {{"RD_ADDR", {6}}}, {{"RD_DATA", {7}}},
            {{"SIZE", "00010000"}, {"WIDTH", "1000"}});
  const AsicFigures n = count_asic(unit.read(), areas);
  EXPECT_EQ(n.cell_um2, 120);
  EXPECT_EQ(n.gates(), 5);
  EXPECT_EQ(n.cells, 2);
  EXPECT_EQ(n.flip_flops, 1);
  EXPECT_EQ(n.memory_bits, 128);
  unit.cell("x", "XYZ", {{"A", {3}}}, {{"Y", {8}}});
  EXPECT_THROW(count_asic(unit.read(), areas), std::runtime_error);
}

TEST(SynthCount, ReportsAreInRoundFigures) {
  const json j = json_of(Unit().ff("a", 3, 10).lut("l", 10, 11).ff("b", 11, 12).time());
  EXPECT_EQ(j["registers"]["cells"], "LUT1 1");
  EXPECT_EQ(j["registers"]["ns"], 0.76);
  EXPECT_EQ(j["meets_163_mhz"], true);
}

}  // namespace
}  // namespace fasttree::synth
