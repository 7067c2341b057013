// SPDX-License-Identifier: Apache-2.0
#include "model/system/global_control.h"

#include <algorithm>
#include <random>

namespace fasttree::model {
namespace {

constexpr std::uint64_t kCheckCycles = 1024;
constexpr std::uint64_t kReportCycles = 100000;

}  // namespace

GlobalControl::GlobalControl(const PaperConfig& config, PaperUnits& units,
                             const SimulationOptions& options, const TestHooks& hooks,
                             std::uint64_t expected_cycles)
    : config_(config),
      units_(units),
      options_(options),
      hooks_(hooks),
      expected_cycles_(std::max<std::uint64_t>(expected_cycles, 1)),
      all_(units.all()),
      timeline_(options.timeline_windows, {all_.begin(), all_.end()},
                [&bus = units.bus] { return bus.moved_bytes(); }) {}

void GlobalControl::begin_stage(const char* name) {
  stages_.emplace_back();
  stages_.back().name = name;
  stages_.back().begin_cycle = cycle_;
  for (Unit* unit : all_) unit->begin_stage();
  timeline_.begin_stage();
}

void GlobalControl::end_stage() {
  StageRecord& stage = stages_.back();
  timeline_.sample(cycle_);
  stage.end_cycle = cycle_;
  stage.traffic = units_.bus.take_traffic();
  for (Unit* unit : all_) {
    const Activity& activity = unit->activity().back();
    const std::uint64_t seen = activity.busy_cycles + activity.idle_cycles + activity.stalled();
    unit->rest(cycle_ - stage.begin_cycle - seen);
  }
}

void GlobalControl::pause(std::uint64_t cycles) {
  units_.bus.pass(cycles);
  cycle_ += cycles;
}

bool GlobalControl::finished(const Phase& phase) const {
  for (const Unit* unit : phase.units) {
    if (!unit->done()) return false;
  }
  return units_.bus.done();
}

Status GlobalControl::run(const Phase& phase) {
  units_.bus.use_ports(phase.ports);
  std::vector<Unit*> ticked = phase.units;
  ticked.push_back(&units_.bus);
  const std::vector<Unit*> reported = ticked;
  if (hooks_.tick_order != 0) {
    std::mt19937 random(hooks_.tick_order);
    std::shuffle(ticked.begin(), ticked.end(), random);
  }
  std::erase_if(ticked, [&](const Unit* unit) { return unit->name() == hooks_.dead_unit; });
  last_work_cycle_ = cycle_;
  last_work_ = work_done(reported);
  std::uint64_t next_check = cycle_ + kCheckCycles;
  while (!finished(phase)) {
    for (Unit* unit : ticked) unit->tick();
    phase.clocks.clock();
    units_.bus.clock();
    timeline_.tick(++cycle_);
    if (cycle_ < next_check) continue;
    next_check += kCheckCycles;
    if (Status status = check(reported); !status.ok()) return status;
  }
  if (units_.bus.strayed()) return check(reported);
  return {};
}

std::uint64_t GlobalControl::work_done(const std::vector<Unit*>& units) const {
  std::uint64_t work = units_.bus.progress();
  for (const Unit* unit : units) {
    if (unit != &units_.bus) work += unit->activity().back().busy_cycles;
  }
  return work;
}

Status GlobalControl::check(const std::vector<Unit*>& units) {
  const std::string& stage = stages_.back().name;
  if (units_.bus.strayed()) {
    return Status(StatusCode::bad_input, "stage " + stage +
                                             ": a unit went outside the memory, near cycle " +
                                             std::to_string(cycle_));
  }
  const std::uint64_t work = work_done(units);
  if (work != last_work_) {
    last_work_ = work;
    last_work_cycle_ = cycle_;
  } else if (cycle_ - last_work_cycle_ >= config_.control.stuck_cycles) {
    return stuck(units);
  }
  if (options_.max_cycles != 0 && cycle_ > options_.max_cycles) {
    return Status(StatusCode::resource_limit,
                  "the run went past its limit of " + std::to_string(options_.max_cycles) +
                      " cycles in stage " + stage + ". Raise the limit.");
  }
  if (options_.progress && cycle_ >= next_report_) {
    next_report_ = cycle_ + kReportCycles;
    const double fraction = static_cast<double>(cycle_) / static_cast<double>(expected_cycles_);
    if (!options_.progress(stage.c_str(), std::min(fraction, 0.99))) {
      return Status(StatusCode::cancelled, "the simulation was cancelled in stage " + stage);
    }
  }
  return {};
}

Status GlobalControl::stuck(const std::vector<Unit*>& units) const {
  std::string message = "the machine is stuck in stage " + stages_.back().name +
                        ": nothing has moved since about cycle " +
                        std::to_string(last_work_cycle_) + ".";
  for (const Unit* unit : units) {
    const std::string what = unit->waits_for();
    if (!what.empty()) message += " " + unit->name() + " waits for " + what + ".";
  }
  return Status(StatusCode::resource_limit, message);
}

void GlobalControl::report(SimulationResult& result) {
  result.cycles = cycle_;
  result.stages = std::move(stages_);
  result.timeline = timeline_.take();
  for (const Unit* unit : all_) {
    UnitRecord record{unit->name(), unit->kind(), unit->stall_reasons(), {}};
    record.by_stage.assign(unit->activity().begin() + 1, unit->activity().end());
    result.units.push_back(std::move(record));
  }
}

}  // namespace fasttree::model
