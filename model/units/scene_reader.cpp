// SPDX-License-Identifier: Apache-2.0
#include "model/units/scene_reader.h"

#include <algorithm>
#include <cstring>

namespace fasttree::model {
namespace {

enum Stall : std::size_t { kBus, kUnits };

}  // namespace

SceneReader::SceneReader(const PaperConfig& config, BusPort& port)
    : Unit("scene_reader", "scene_reader", {"bus", "scene_bound or morton_code"}),
      config_(config),
      reader_(port, config.bus.burst_bytes) {}

void SceneReader::start_bounds(Address scene, std::uint32_t triangles,
                               std::vector<Queue<CoordinateGroup>*> units) {
  reader_.start(scene, std::uint64_t{triangles} * kTriangleBytes, Purpose::scene);
  bound_units_ = std::move(units);
  bounds_ = true;
}

void SceneReader::start_triangles(Address scene, std::uint32_t triangles,
                                  std::vector<Queue<TriangleJob>*> units) {
  reader_.start(scene, std::uint64_t{triangles} * kTriangleBytes, Purpose::scene);
  code_units_ = std::move(units);
  bounds_ = false;
  held_bytes_ = 0;
  next_triangle_ = 0;
  next_unit_ = 0;
}

void SceneReader::tick() {
  reader_.tick();
  blocked_ = false;
  bool worked = bounds_ ? send_group() : send_triangle();
  worked |= bounds_ ? gather_coordinates() : take_bytes();
  if (worked) {
    busy();
  } else if (blocked_) {
    stalled(kUnits);
  } else if (!done()) {
    stalled(kBus);
  } else {
    idle();
  }
}

// A bus width of coordinates, each to the values of its axis.
bool SceneReader::gather_coordinates() {
  const std::size_t bytes = std::min<std::uint64_t>(config_.bus.bytes, reader_.left());
  if (bytes == 0 || reader_.available() < bytes) return false;
  const auto count = static_cast<std::uint32_t>(bytes / sizeof(float));
  for (const Gather& gather : gathers_) {
    if (gather.count + (count + 2) / 3 > gather.values.size()) {
      blocked_ = true;
      return false;
    }
  }
  std::array<float, kMaxRequestBytes / sizeof(float)> values;
  reader_.take(values.data(), bytes);
  for (std::uint32_t i = 0; i < count; ++i) {
    Gather& gather = gathers_[next_axis_];
    gather.values[gather.count++] = values[i];
    if (++next_axis_ == 3) next_axis_ = 0;
  }
  return true;
}

// The first axis that has a group together. The last group of an axis repeats its first value.
bool SceneReader::send_group() {
  const std::uint32_t inputs = config_.scene_bound.inputs;
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    Gather& gather = gathers_[axis];
    const bool last = reader_.left() == 0 && gather.count > 0;
    if (gather.count < inputs && !last) continue;
    for (const auto* unit : bound_units_) {
      if (!unit->ready()) {
        blocked_ = true;
        return false;
      }
    }
    CoordinateGroup group;
    group.axis = axis;
    const std::uint32_t count = std::min(inputs, gather.count);
    group.values.fill(gather.values[0]);
    std::copy_n(gather.values.begin(), count, group.values.begin());
    std::copy(gather.values.begin() + count, gather.values.begin() + gather.count,
              gather.values.begin());
    gather.count -= count;
    for (auto* unit : bound_units_) unit->push(group);
    return true;
  }
  return false;
}

bool SceneReader::take_bytes() {
  const std::size_t bytes = std::min<std::uint64_t>(config_.bus.bytes, reader_.left());
  if (bytes == 0 || reader_.available() < bytes) return false;
  if (held_bytes_ + bytes > held_.size()) {
    blocked_ = true;
    return false;
  }
  reader_.take(held_.data() + held_bytes_, bytes);
  held_bytes_ += static_cast<std::uint32_t>(bytes);
  return true;
}

bool SceneReader::send_triangle() {
  if (held_bytes_ < kTriangleBytes) return false;
  Queue<TriangleJob>& unit = *code_units_[next_unit_];
  if (!unit.ready()) {
    blocked_ = true;
    return false;
  }
  TriangleJob job;
  job.id = next_triangle_++;
  std::memcpy(job.coordinates.data(), held_.data(), kTriangleBytes);
  held_bytes_ -= kTriangleBytes;
  std::memmove(held_.data(), held_.data() + kTriangleBytes, held_bytes_);
  unit.push(job);
  if (++next_unit_ == code_units_.size()) next_unit_ = 0;
  return true;
}

bool SceneReader::done() const {
  return reader_.left() == 0 && held_bytes_ < kTriangleBytes && gathers_[0].count == 0 &&
         gathers_[1].count == 0 && gathers_[2].count == 0;
}

std::string SceneReader::waits_for() const {
  if (done()) return {};
  if (blocked_)
    return bounds_ ? "scene_bound to take coordinates" : "morton_code to take a triangle";
  return std::to_string(reader_.left()) + " bytes of the scene from the bus";
}

}  // namespace fasttree::model
