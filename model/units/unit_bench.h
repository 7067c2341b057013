// SPDX-License-Identifier: Apache-2.0
// For unit tests: a bus with memory, to which single units are connected and clocked.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "model/memory/byte_store.h"
#include "model/system/bus.h"
#include "model/system/paper_units.h"
#include "model/system/pipe_memory.h"

namespace fasttree::model::test {

struct UnitBench {
  explicit UnitBench(const PaperConfig& paper = {}, const PipeSettings& pipe = quick(),
                     std::uint64_t bytes = 1 << 20)
      : config(paper), memory(pipe), store(bytes), bus(config.bus, 1000, memory, store) {}

  /// Ten cycles of latency: less than what streams read ahead.
  static PipeSettings quick() {
    PipeSettings pipe;
    pipe.latency_ps = 10000;
    return pipe;
  }

  /// Until all units and the bus are done; the cycles it took.
  std::uint64_t run(const std::vector<Unit*>& units, const Clocks& clocks = {}) {
    std::uint64_t cycles = 0;
    while (!finished(units)) {
      step(units, clocks);
      if (++cycles > 10000000) {
        ADD_FAILURE() << "still at work after ten million cycles";
        break;
      }
    }
    return cycles;
  }
  void step(const std::vector<Unit*>& units, const Clocks& clocks = {}) {
    for (Unit* unit : units) unit->tick();
    bus.tick();
    clocks.clock();
    bus.clock();
  }

  void put(Address at, const std::vector<std::uint32_t>& words) {
    store.write(at, words.data(), words.size() * 4);
  }
  std::vector<std::uint32_t> words(Address at, std::size_t count) const {
    std::vector<std::uint32_t> list(count);
    store.read(at, list.data(), count * 4);
    return list;
  }

  PaperConfig config;
  PipeMemory memory;
  ByteStore store;
  Bus bus;

 private:
  bool finished(const std::vector<Unit*>& units) const {
    for (const Unit* unit : units) {
      if (!unit->done()) return false;
    }
    return bus.done();
  }
};

}  // namespace fasttree::model::test
