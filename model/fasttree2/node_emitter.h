// SPDX-License-Identifier: Apache-2.0
// Leaves in descending order become nodes, written backwards: when a node's lower subtree is
// complete, the node itself is next in reversed pre-order. No bitmap, no climbing, no second pass.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "fasttree/tree.h"
#include "model/fasttree2/bucket_lane.h"
#include "model/fasttree2/dma.h"
#include "model/fasttree2/registers.h"
#include "model/fasttree2/split_plane.h"
#include "model/kernel/unit.h"

namespace fasttree::model::ft2 {

class NodeEmitter : public Unit {
 public:
  NodeEmitter(Registers& registers, Dma& dma, BucketOrder& order,
              const std::vector<std::unique_ptr<BucketLane>>& lanes);

  void begin();
  /// No leaves come after those of the buckets handed out.
  void finish() { finishing_ = true; }

  void tick() override;
  bool done() const override { return !active_; }
  std::string waits_for() const override;

  std::uint64_t leaves() const { return leaf_count_; }
  /// The slot of the root: the nodes are in the slots from here to the last.
  std::uint64_t root_slot() const { return next_; }
  const SplitPlanes& planes() const { return planes_; }

 private:
  /// An inner node whose upper subtree is written and whose lower one is not.
  struct Open {
    int m = 0;  ///< highest different bit of the two leaves it lies between
    std::uint32_t axis = 0;
    float plane = 0;
    std::uint32_t upper = 0;     ///< slot of the upper child
    std::uint64_t known_at = 0;  ///< cycle in which the plane is known
  };
  bool put(const Node& node);
  bool close();
  bool take_leaf(const LeafEntry& leaf);
  /// One node: a leaf, or an inner node that is complete.
  bool step();
  bool flush();

  Registers& r_;
  WritePort& port_;
  BucketOrder& order_;
  const std::vector<std::unique_ptr<BucketLane>>& lanes_;
  SplitPlanes planes_;

  bool active_ = false;
  bool finishing_ = false;
  std::array<Open, kMaxDepth + 1> open_{};
  std::size_t open_count_ = 0;
  std::uint64_t next_ = 0;  ///< slot of the node written last; the next goes below it
  std::uint64_t leaf_count_ = 0;
  std::uint32_t code_ = 0;         ///< of the leaf before
  std::uint64_t planes_free_ = 0;  ///< cycle in which the search can begin another
  std::size_t reason_ = 0;
  std::array<std::uint8_t, kMaxBeatBytes> line_{};
  std::uint32_t line_fill_ = 0;  ///< bytes, from the end
};

}  // namespace fasttree::model::ft2
