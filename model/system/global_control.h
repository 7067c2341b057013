// SPDX-License-Identifier: Apache-2.0
// Global control: runs phases one after the other, a cycle at a time, keeps the account of stages,
// and ends a run that is cancelled, too long or stuck.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fasttree/status.h"
#include "model/report/simulation.h"
#include "model/system/paper_machine.h"
#include "model/system/paper_units.h"
#include "model/system/timeline.h"

namespace fasttree::model {

class GlobalControl {
 public:
  /// `expected_cycles`: for progress, nothing else.
  GlobalControl(const PaperConfig& config, PaperUnits& units, const SimulationOptions& options,
                const TestHooks& hooks, std::uint64_t expected_cycles);

  void begin_stage(const char* name);
  void end_stage();

  /// Until every unit of the phase is done and the bus has nothing left to do.
  Status run(const Phase& phase);
  /// Cycles in which no unit works.
  void pause(std::uint64_t cycles);

  std::uint64_t cycle() const { return cycle_; }
  /// Stages, units' accounts and timeline.
  void report(SimulationResult& result);

 private:
  bool finished(const Phase& phase) const;
  Status check(const std::vector<Unit*>& units);
  Status stuck(const std::vector<Unit*>& units) const;
  std::uint64_t work_done(const std::vector<Unit*>& units) const;

  const PaperConfig& config_;
  PaperUnits& units_;
  const SimulationOptions& options_;
  TestHooks hooks_;
  std::uint64_t expected_cycles_;
  std::vector<Unit*> all_;
  Timeline timeline_;
  std::vector<StageRecord> stages_;
  std::uint64_t cycle_ = 0;
  std::uint64_t next_report_ = 0;
  std::uint64_t last_work_ = 0;
  std::uint64_t last_work_cycle_ = 0;
};

}  // namespace fasttree::model
