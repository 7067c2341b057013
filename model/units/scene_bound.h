// SPDX-License-Identifier: Apache-2.0
// Scene bound calculation unit (SBCU): the least or the greatest of eight coordinates by pipelined
// compare-and-select, then against the bound so far. Docs: docs/accelerator/scene_bound.md.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "model/config/paper_config.h"
#include "model/kernel/queue.h"
#include "model/kernel/unit.h"
#include "model/units/scene_reader.h"

namespace fasttree::model {

class SceneBoundUnit : public Unit {
 public:
  enum class Side { lower, upper };
  SceneBoundUnit(Side side, const PaperConfig::SceneBound& config);

  Queue<CoordinateGroup> input;

  void tick() override;
  bool done() const override;
  std::string waits_for() const override { return {}; }
  void clock() { input.clock(); }

  /// The bound of an axis once done; plus zero for minus zero. 0 where no value came.
  float bound(std::size_t axis) const;

 private:
  float select(float a, float b) const;

  struct Stage {
    bool full = false;
    CoordinateGroup group;
  };
  Side side_;
  std::uint32_t inputs_;
  std::vector<Stage> stages_;  ///< stage s holds inputs >> (s + 1) values
  std::array<float, 3> bound_{};
  std::array<bool, 3> any_{};
};

}  // namespace fasttree::model
