// SPDX-License-Identifier: Apache-2.0
// Path compression unit (PCU): climbs from each node of the tree to its essential ancestor, reading
// marks through the cache, and writes the node there as a child.
// Docs: docs/accelerator/path_compression.md.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "fasttree/device_image.h"
#include "model/config/paper_config.h"
#include "model/kernel/queue.h"
#include "model/kernel/unit.h"
#include "model/system/stream.h"
#include "model/units/mark_cache.h"

namespace fasttree::model {

/// Leaves are taken in order. A leaf that arrives at an ancestor from above completes it, and the
/// ancestor climbs next; so a node's leaves are known when it climbs, and with them the rank of
/// the ancestor it arrives at: the node between leaves j and j + 1 has rank j. Of the ancestors
/// whose upper side is still open, a register a level keeps the first leaf.
class PathCompressionUnit : public Unit {
 public:
  PathCompressionUnit(const PaperConfig& config, BusPort& reads, BusPort& links,
                      Queue<MarkRequest>& cache, Queue<std::uint32_t>& marks);

  void start(Address leaf_codes, std::uint32_t leaves, Address marks, Address nodes,
             std::uint32_t depth);

  void tick() override;
  bool done() const override { return left_ == 0 && state_ == State::next_leaf; }
  std::string waits_for() const override;

  std::uint32_t root() const { return root_; }
  std::uint64_t climb_steps() const { return steps_; }

 private:
  enum class State { next_leaf, climb, mark };
  bool next_leaf();
  bool climb();
  bool arrive();

  PaperConfig config_;
  StreamReader reader_;
  BusPort& link_port_;
  Queue<MarkRequest>& cache_;
  Queue<std::uint32_t>& marks_;
  std::uint64_t mark_base_ = 0;
  std::uint64_t node_base_ = 0;
  std::uint32_t root_index_ = 1;
  std::uint32_t leaves_ = 0;
  std::uint32_t left_ = 0;
  State state_ = State::next_leaf;
  std::uint32_t wait_ = 0;
  std::uint32_t leaf_ = 0;   ///< the last one taken, and the last leaf below what climbs
  std::uint32_t first_ = 0;  ///< the first leaf below it
  std::uint32_t child_ = 0;  ///< how its parent names it
  std::uint32_t node_ = 0;   ///< node index it has climbed to
  std::uint32_t parent_ = 0;
  bool upper_child_ = false;
  std::array<std::uint32_t, 32> first_leaf_{};  ///< a level: of the ancestor open there
  std::uint32_t root_ = kDeviceLeaf;
  std::uint64_t steps_ = 0;
  std::size_t waits_ = 0;
};

}  // namespace fasttree::model
