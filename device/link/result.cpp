// SPDX-License-Identifier: Apache-2.0
#include "device/link/result.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "device/link/wire.h"

namespace fasttree::device {
namespace {

// The header. docs/protocol.md has the same table.
constexpr std::size_t kNodesAt = 0, kIdsAt = 8, kHashAt = 16, kCyclesAt = 24, kClockAt = 32,
                      kBuildAt = 40, kStagesAt = 48, kTrianglesAt = 52, kProfileAt = 56,
                      kAxesAt = 57, kDepthAt = 58, kBitsAt = 59, kBoundsAt = 64;
static_assert(kBoundsAt + sizeof(Box3) <= kResultHeaderBytes);
static_assert(sizeof(Box3) == 24);

// A stage.
constexpr std::size_t kNameSize = 32, kBeginAt = 32, kEndAt = 40, kMsAt = 48;

std::vector<std::byte> head_of(const Outcome& outcome) {
  const TreeInfo& info = outcome.tree.info();
  const Counters& counters = outcome.counters;
  const std::size_t stages = std::min(counters.stages.size(), kMostStages);
  std::vector<std::byte> head(kResultHeaderBytes + stages * kStageBytes);
  const std::span to(head);
  put(to, kNodesAt, std::uint64_t{outcome.tree.nodes().size()});
  put(to, kIdsAt, std::uint64_t{outcome.tree.ids().size()});
  put(to, kHashAt, outcome.tree.hash());
  put(to, kCyclesAt, counters.cycles);
  put(to, kClockAt, counters.clock_mhz);
  put(to, kBuildAt, counters.build_ms);
  put(to, kStagesAt, static_cast<std::uint32_t>(stages));
  put(to, kTrianglesAt, info.triangle_count);
  put(to, kProfileAt, static_cast<std::uint8_t>(info.profile));
  put(to, kAxesAt, static_cast<std::uint8_t>(info.axes));
  put(to, kDepthAt, info.depth);
  put(to, kBitsAt, info.bits);
  put(to, kBoundsAt, info.bounds);
  for (std::size_t i = 0; i < stages; ++i) {
    const StageCount& stage = counters.stages[i];
    const auto record = to.subspan(kResultHeaderBytes + i * kStageBytes, kStageBytes);
    put_text(record, 0, kNameSize, stage.stage);
    put(record, kBeginAt, stage.begin_cycle);
    put(record, kEndAt, stage.end_cycle);
    put(record, kMsAt, stage.ms);
  }
  return head;
}

Status broken(const std::string& what) {
  return {StatusCode::bad_input, "the device's result is broken: " + what};
}

Counters counters_of(std::span<const std::byte> bytes, std::size_t stages) {
  Counters counters;
  counters.cycles = get<std::uint64_t>(bytes, kCyclesAt);
  counters.clock_mhz = get<double>(bytes, kClockAt);
  counters.build_ms = get<double>(bytes, kBuildAt);
  for (std::size_t i = 0; i < stages; ++i) {
    const auto record = bytes.subspan(kResultHeaderBytes + i * kStageBytes, kStageBytes);
    counters.stages.push_back({get_text(record, 0, kNameSize), get<std::uint64_t>(record, kBeginAt),
                               get<std::uint64_t>(record, kEndAt), get<double>(record, kMsAt)});
  }
  return counters;
}

}  // namespace

ResultSource::ResultSource(Outcome outcome)
    : outcome_(std::move(outcome)),
      head_(head_of(outcome_)),
      parts_({std::span<const std::byte>(head_), std::as_bytes(outcome_.tree.nodes()),
              std::as_bytes(outcome_.tree.ids())}) {}

Result<Outcome> parse_result(std::span<const std::byte> bytes, std::shared_ptr<const void> owner) {
  if (bytes.size() < kResultHeaderBytes) return broken("shorter than its header");
  const auto nodes = get<std::uint64_t>(bytes, kNodesAt);
  const auto ids = get<std::uint64_t>(bytes, kIdsAt);
  const std::size_t stages = get<std::uint32_t>(bytes, kStagesAt);
  if (stages > kMostStages) return broken(std::to_string(stages) + " stages");
  const std::size_t head = kResultHeaderBytes + stages * kStageBytes;
  if (bytes.size() < head) return broken("shorter than its stages");
  const std::size_t rest = bytes.size() - head;
  if (nodes == 0 || nodes > rest / sizeof(Node) || nodes > kMaxNodes ||
      ids != (rest - nodes * sizeof(Node)) / sizeof(std::uint32_t) ||
      rest % sizeof(std::uint32_t) != 0) {
    return broken(std::to_string(nodes) + " nodes and " + std::to_string(ids) + " ids in " +
                  std::to_string(rest) + " bytes");
  }
  const auto profile = get<std::uint8_t>(bytes, kProfileAt);
  const auto axes = get<std::uint8_t>(bytes, kAxesAt);
  if (profile > static_cast<std::uint8_t>(kLastProfile) ||
      axes > static_cast<std::uint8_t>(AxisSchedule::longest)) {
    return broken("profile " + std::to_string(profile) + ", axes " + std::to_string(axes));
  }
  TreeInfo info;
  info.profile = static_cast<Profile>(profile);
  info.axes = static_cast<AxisSchedule>(axes);
  info.depth = get<std::uint8_t>(bytes, kDepthAt);
  info.bits = get<std::array<std::uint8_t, 3>>(bytes, kBitsAt);
  info.triangle_count = get<std::uint32_t>(bytes, kTrianglesAt);
  info.bounds = get<Box3>(bytes, kBoundsAt);
  const std::byte* at = bytes.data() + head;
  const std::span node_span(reinterpret_cast<const Node*>(at), nodes);
  const std::span id_span(reinterpret_cast<const std::uint32_t*>(at + node_span.size_bytes()), ids);
  Outcome outcome;
  outcome.tree = Tree(info, node_span, id_span, std::move(owner));
  outcome.counters = counters_of(bytes, stages);
  // A board need not hash its tree.
  const auto hash = get<std::uint64_t>(bytes, kHashAt);
  if (hash != 0 && hash != outcome.tree.hash()) {
    return broken("its tree has the hash " + hash_string(outcome.tree.hash()) +
                  ", the device says " + hash_string(hash));
  }
  return outcome;
}

}  // namespace fasttree::device
