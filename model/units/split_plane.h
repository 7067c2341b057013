// SPDX-License-Identifier: Apache-2.0
// The second half of the INGU: where a node's split plane lies. A plane is the least binary32 value
// that the quantiser puts into the upper cell, so the unit tries values with a quantiser, from the
// one that arithmetic suggests, until it has it. Docs: docs/accelerator/internal_node.md.
#pragma once

#include <cstdint>
#include <string>

#include "grid/grid.h"
#include "model/config/paper_config.h"
#include "model/kernel/queue.h"
#include "model/kernel/unit.h"
#include "model/system/stream.h"

namespace fasttree::model {

/// The search for one plane, a trial at a time.
class PlaneSearch {
 public:
  /// The plane below cell k of 2^15.
  PlaneSearch() = default;
  PlaneSearch(const AxisQuantiser& quantiser, float hi, std::uint32_t k);

  bool found() const { return phase_ != Phase::first && above_ - below_ <= 1; }
  void trial();
  float plane() const;

 private:
  enum class Phase { first, down, up, halve };
  bool reached(std::int64_t ordinal) const;

  AxisQuantiser quantiser_;
  std::uint32_t k_ = 0;
  Phase phase_ = Phase::halve;
  std::int64_t below_ = 0;  ///< not in the upper cell
  std::int64_t above_ = 0;  ///< in it
  std::int64_t least_ = 0, most_ = 0, start_ = 0;
  std::int64_t step_ = 1;
};

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
  PaperConfig config_;
  BusPort& port_;
  BlockWriter writer_;
  const Grid* grid_ = nullptr;
  std::uint32_t left_ = 0;
  bool searching_ = false;
  std::uint32_t axis_ = 0;
  PlaneSearch search_;
  bool blocked_ = false;
};

}  // namespace fasttree::model
