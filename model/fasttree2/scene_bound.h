// SPDX-License-Identifier: Apache-2.0
// Scene bounds: minimum and maximum of three corners on three axes, a triangle a cycle.
#pragma once

#include "fasttree/vec.h"
#include "model/fasttree2/registers.h"
#include "model/fasttree2/scene_reader.h"
#include "model/kernel/queue.h"
#include "model/kernel/unit.h"

namespace fasttree::model::ft2 {

class SceneBound : public Unit {
 public:
  SceneBound(Registers& registers, Queue<SceneTriangle>& in);

  void begin();
  void tick() override;
  bool done() const override { return seen_ == r_.triangles || !active_; }
  std::string waits_for() const override;

  /// Minus zero has become plus zero; all zero for an empty scene.
  Box3 bounds() const;
  /// A triangle so far was outside these.
  bool outside(const Box3& given) const;

 private:
  Registers& r_;
  Queue<SceneTriangle>& in_;
  bool active_ = false;
  std::uint32_t seen_ = 0;
  Box3 bounds_;
};

}  // namespace fasttree::model::ft2
