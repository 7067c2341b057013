// SPDX-License-Identifier: Apache-2.0
// A clocked unit, and the account it keeps of its cycles: busy, stalled (and on whom), idle.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace fasttree::model {

/// Cycles of one unit in one stage.
struct Activity {
  std::uint64_t busy_cycles = 0;
  std::uint64_t idle_cycles = 0;
  std::vector<std::uint64_t> stalled_cycles;  ///< by reason, in the order of Unit::stall_reasons()

  std::uint64_t stalled() const {
    std::uint64_t sum = 0;
    for (const std::uint64_t cycles : stalled_cycles) sum += cycles;
    return sum;
  }
};

/// Base of every unit. The machine calls tick() once a cycle; the unit looks at its queues, does at
/// most one cycle's work, and accounts for the cycle exactly once.
class Unit {
 public:
  /// `name` is the instance ("psu2"), `kind` the stem of its stage ("prefix_sum"). `stall_reasons`:
  /// whom this unit may wait for, in words ("bus", "psu").
  Unit(std::string name, std::string kind, std::vector<std::string> stall_reasons)
      : name_(std::move(name)), kind_(std::move(kind)), stall_reasons_(std::move(stall_reasons)) {
    begin_stage();
  }
  virtual ~Unit() = default;
  Unit(const Unit&) = delete;
  Unit& operator=(const Unit&) = delete;

  virtual void tick() = 0;

  /// Nothing to do and nothing held: the stage may end.
  virtual bool done() const = 0;

  /// What it waits for now, for the report of a machine that is stuck ("a response of the bus for
  /// section 17"); empty where it waits for nothing.
  virtual std::string waits_for() const = 0;

  const std::string& name() const { return name_; }
  const std::string& kind() const { return kind_; }
  const std::vector<std::string>& stall_reasons() const { return stall_reasons_; }

  /// Starts the account of the next stage.
  void begin_stage() {
    by_stage_.emplace_back();
    by_stage_.back().stalled_cycles.resize(stall_reasons_.size());
  }
  /// Cycles of a stage in which the unit was not ticked because the stage does not use it.
  void rest(std::uint64_t cycles) { by_stage_.back().idle_cycles += cycles; }
  /// One entry a begin_stage(); the first is before any stage.
  const std::vector<Activity>& activity() const { return by_stage_; }

 protected:
  void busy() { ++by_stage_.back().busy_cycles; }
  void idle() { ++by_stage_.back().idle_cycles; }
  void stalled(std::size_t reason) { ++by_stage_.back().stalled_cycles[reason]; }

 private:
  std::string name_;
  std::string kind_;
  std::vector<std::string> stall_reasons_;
  std::vector<Activity> by_stage_;
};

}  // namespace fasttree::model
