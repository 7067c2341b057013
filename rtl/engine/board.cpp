// SPDX-License-Identifier: Apache-2.0
#include "rtl/engine/board.h"

#include <utility>

namespace fasttree::rtl {

const char* stage_name(std::uint32_t stage) {
  constexpr const char* kNames[] = {"",          "scene_bound",   "morton_code",     "radix_sort",
                                    "leaf_node", "internal_node", "path_compression"};
  return stage < std::size(kNames) ? kNames[stage] : "";
}

Board::Board(Top& top, AxiMemory& memory, const model::MachineConfig& config,
             std::uint32_t timeline_windows, TrafficAccount* traffic)
    : top_(top),
      memory_(memory),
      units_(recorded_units(config.paper)),
      activity_(units_.size()),
      timeline_(timeline_windows, pointers(), [traffic] { return traffic->moved_bytes(); }),
      traffic_(traffic) {
  memory_.observe(traffic);
  top_.reset(true);
  for (int i = 0; i < 4; ++i) {
    top_.settle(bus_, host_);
    top_.clock();
  }
  top_.reset(false);
  for (int i = 0; i < 4; ++i) step();
}

std::vector<const model::Unit*> Board::pointers() const {
  std::vector<const model::Unit*> list;
  for (const auto& unit : units_) list.push_back(unit.get());
  return list;
}

void Board::step() {
  memory_.drive(bus_);
  top_.settle(bus_, host_);
  if (traffic_ != nullptr) account();
  memory_.clock(bus_);
  top_.clock();
}

std::uint32_t Board::read(std::uint32_t address) {
  host_.address = address;
  host_.read_valid = true;
  do step();
  while (!host_.read_ready);
  host_.read_valid = false;
  do step();
  while (!host_.data_valid);
  return host_.read_data;
}

void Board::write(std::uint32_t address, std::uint32_t data) {
  host_.address = address;
  host_.write_data = data;
  host_.write_valid = true;
  do step();
  while (!host_.write_ready);
  host_.write_valid = false;
  do step();
  while (!host_.answer_valid);
}

ft_accel Board::driver() {
  return {this,
          [](void* board, std::uint32_t reg) { return static_cast<Board*>(board)->read(reg); },
          [](void* board, std::uint32_t reg, std::uint32_t value) {
            static_cast<Board*>(board)->write(reg, value);
          }};
}

// A stage begins and ends where the top says so.
void Board::account() {
  if (host_.stage != stage_) {
    end_stage();
    stage_ = host_.stage;
    if (stage_ != 0) {
      for (const auto& unit : units_) unit->begin_stage();
      timeline_.begin_stage();
      stages_.emplace_back();
      stages_.back().name = stage_name(stage_);
      stages_.back().begin_cycle = recorded_;
    }
  }
  if (stage_ == 0) return;
  top_.activity(activity_);
  for (std::size_t u = 0; u < units_.size(); ++u) units_[u]->record(activity_[u]);
  timeline_.tick(++recorded_);
}

void Board::end_stage() {
  if (stage_ == 0) return;
  timeline_.sample(recorded_);
  stages_.back().end_cycle = recorded_;
  stages_.back().traffic = traffic_->take();
  stage_ = 0;
}

void Board::report(model::SimulationResult& result) {
  end_stage();
  result.stages = std::move(stages_);
  result.timeline = timeline_.take();
  for (const auto& unit : units_) {
    model::UnitRecord record{unit->name(), unit->kind(), unit->stall_reasons(), {}};
    record.by_stage.assign(unit->activity().begin() + 1, unit->activity().end());
    result.units.push_back(std::move(record));
  }
}

}  // namespace fasttree::rtl
