// SPDX-License-Identifier: Apache-2.0
#include "model/fasttree2/node_emitter.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace fasttree::model::ft2 {

namespace {
enum Reason : std::size_t { kLanes, kMemory, kPlane };
}  // namespace

NodeEmitter::NodeEmitter(Registers& registers, Dma& dma, BucketOrder& order,
                         const std::vector<std::unique_ptr<BucketLane>>& lanes)
    : Unit("node_emitter", "internal_node", {"lanes", "memory", "split_plane"}),
      r_(registers),
      port_(dma.add_write("nodes", registers.config.write_buffer_bytes)),
      order_(order),
      lanes_(lanes),
      planes_(registers) {}

void NodeEmitter::begin() {
  active_ = true;
  finishing_ = false;
  open_count_ = 0;
  next_ = r_.layout.node_slots;
  leaf_count_ = 0;
  planes_free_ = 0;
  line_fill_ = 0;
  planes_.begin();
}

bool NodeEmitter::put(const Node& node) {
  if (next_ == 0) {
    r_.fail("node_emitter: more nodes than there is room for");
    return false;
  }
  const std::uint64_t address = r_.layout.nodes.value + (next_ - 1) * sizeof(Node);
  const bool full = address % port_.beat_bytes() == 0;
  if (full && !port_.ready(Address(address), line_fill_ + sizeof(Node))) {
    reason_ = kMemory;
    return false;
  }
  --next_;
  line_fill_ += sizeof(Node);
  std::memcpy(line_.data() + line_.size() - line_fill_, &node, sizeof(Node));
  if (full) {
    port_.write(Address(address), line_.data() + line_.size() - line_fill_, line_fill_);
    line_fill_ = 0;
  }
  return true;
}

bool NodeEmitter::close() {
  const Open& node = open_[open_count_ - 1];
  if (node.known_at > r_.cycle) {
    reason_ = kPlane;
    return false;
  }
  if (!put(Node::inner(node.axis, node.plane, node.upper))) return false;
  --open_count_;
  return true;
}

bool NodeEmitter::take_leaf(const LeafEntry& leaf) {
  if (leaf_count_ == 0) {
    if (!put(Node::leaf(leaf.first, leaf.count))) return false;
  } else {
    // The node between this leaf and the one before. Open nodes under it have both children now.
    const int m = std::bit_width(leaf.code ^ code_) - 1;
    if (open_count_ > 0 && open_[open_count_ - 1].m < m) return close();
    if (m < 0 || leaf.code > code_ || open_count_ > static_cast<std::size_t>(r_.levels.depth())) {
      r_.fail("node_emitter: leaf " + std::to_string(leaf.code) + " after leaf " +
              std::to_string(code_));
      return false;
    }
    if (planes_free_ > r_.cycle) {
      reason_ = kPlane;
      return false;
    }
    if (!put(Node::leaf(leaf.first, leaf.count))) return false;
    const Grid& grid = r_.levels.grid();
    const auto axis = static_cast<std::uint32_t>(grid.axis_of_level(grid.depth() - 1 - m));
    const std::uint32_t k = grid.coordinate_of(code_ >> m << m, axis);
    const SplitPlanes::Answer answer = planes_.find(axis, k);
    planes_free_ = r_.cycle + answer.cycles;
    open_[open_count_++] = {m, axis, answer.plane, static_cast<std::uint32_t>(next_ + 1),
                            r_.cycle + answer.cycles};
  }
  code_ = leaf.code;
  ++leaf_count_;
  return true;
}

bool NodeEmitter::step() {
  if (order_.next_leaves < order_.next_ticket) {
    for (const auto& lane : lanes_) {
      // Only the lane whose bucket is due has put leaves into its queue.
      if (!lane->leaves().valid()) continue;
      const std::uint64_t before = leaf_count_;
      const bool worked = take_leaf(lane->leaves().front());
      if (leaf_count_ != before && lane->leaves().pop().last_of_bucket) ++order_.next_leaves;
      return worked;
    }
    reason_ = kLanes;
    return false;
  }
  reason_ = kLanes;
  if (!finishing_) return false;
  if (open_count_ > 0) return close();
  if (leaf_count_ > 0) return flush();
  leaf_count_ = 1;
  return put(Node::leaf(0, 0));  // an empty scene still has a root
}

bool NodeEmitter::flush() {
  if (line_fill_ > 0) {
    const Address address(r_.layout.nodes.value + next_ * sizeof(Node));
    if (!port_.ready(address, line_fill_)) {
      reason_ = kMemory;
      return false;
    }
    port_.write(address, line_.data() + line_.size() - line_fill_, line_fill_);
    line_fill_ = 0;
  }
  active_ = false;
  return true;
}

void NodeEmitter::tick() {
  if (!active_) return idle();
  std::uint32_t steps = 0;
  while (steps < r_.config.nodes_per_cycle && active_ && step()) ++steps;
  steps > 0 ? busy() : stalled(reason_);
}

std::string NodeEmitter::waits_for() const {
  if (!active_) return "";
  switch (reason_) {
    case kMemory:
      return "room for nodes in the write buffer";
    case kPlane:
      return "a split plane";
    default:
      return "the leaves of bucket number " + std::to_string(order_.next_leaves) + " in order";
  }
}

}  // namespace fasttree::model::ft2
