// SPDX-License-Identifier: Apache-2.0
// Morton code generation unit (MCGU): a triangle's box, its six bounds through a shared quantiser,
// then every cell of the box, one a cycle. Docs: docs/accelerator/morton_code.md.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "grid/grid.h"
#include "model/config/paper_config.h"
#include "model/kernel/queue.h"
#include "model/kernel/unit.h"
#include "model/units/scene_reader.h"

namespace fasttree::model {

/// A code with its triangle.
struct Pair {
  std::uint32_t code = 0;
  std::uint32_t id = 0;
  bool last = false;  ///< of its triangle
};

class MortonCodeUnit : public Unit {
 public:
  MortonCodeUnit(std::string name, const PaperConfig::MortonCode& config);

  Queue<TriangleJob> input;
  Queue<Pair> output;

  /// The grid's registers: origin, scale and bits of each axis, and the schedule.
  void set_grid(const Grid& grid) { grid_ = &grid; }

  void tick() override;
  bool done() const override;
  std::string waits_for() const override;
  void clock() {
    input.clock();
    output.clock();
  }

 private:
  enum class State { ready, box, quantise, iterate };
  void take();
  void quantise_one();
  void emit();

  PaperConfig::MortonCode config_;
  const Grid* grid_ = nullptr;
  State state_ = State::ready;
  std::uint32_t wait_ = 0;       ///< cycles left in the state
  std::uint32_t quantised_ = 0;  ///< of the six bounds
  TriangleJob job_;
  std::array<float, 6> bounds_{};  ///< lower x, y, z, then upper
  CellBox cells_;
  Cell cell_{};
};

}  // namespace fasttree::model
