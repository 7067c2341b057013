// SPDX-License-Identifier: Apache-2.0
// The second half of the INGU: where a node's split plane lies, by a pipeline that computes it
// directly. The value is the grid's. Docs: docs/accelerator/internal_node.md.
#pragma once

#include <cstdint>
#include <deque>
#include <string>

#include "fasttree/device_image.h"
#include "grid/grid.h"
#include "model/config/paper_config.h"
#include "model/kernel/queue.h"
#include "model/kernel/unit.h"
#include "model/system/stream.h"

namespace fasttree::model {

/// A node without its plane: level m of the grid's code, and the upper leaf's code.
struct SplitJob {
  std::uint32_t upper_code = 0;
  std::int32_t bit = 0;
};

class SplitPlaneUnit : public Unit {
 public:
  SplitPlaneUnit(const PaperConfig& config, BusPort& port);

  Queue<SplitJob> input;

  void start(Address nodes, std::uint32_t count, const Grid& grid);

  void tick() override;
  bool done() const override;
  std::string waits_for() const override;
  void clock() { input.clock(); }

 private:
  struct Record {
    DeviceInternalNode node;
    std::uint64_t out_at = 0;  ///< the move with which it leaves
  };

  PaperConfig config_;
  BusPort& port_;
  BlockWriter writer_;
  const Grid* grid_ = nullptr;
  std::uint32_t left_ = 0;      ///< records to be written
  std::deque<Record> records_;  ///< in the pipeline
  std::uint64_t moves_ = 0;     ///< of the pipeline: all of it at once or none of it
  std::uint64_t next_in_ = 0;   ///< the first move that may take a node in
  bool blocked_ = false;
};

}  // namespace fasttree::model
