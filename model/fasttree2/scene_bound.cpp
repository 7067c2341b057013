// SPDX-License-Identifier: Apache-2.0
#include "model/fasttree2/scene_bound.h"

#include <cmath>

namespace fasttree::model::ft2 {

namespace {
enum Reason : std::size_t { kScene };
}  // namespace

SceneBound::SceneBound(Registers& registers, Queue<SceneTriangle>& in)
    : Unit("scene_bound", "scene_bound", {"scene_reader"}), r_(registers), in_(in) {}

void SceneBound::begin() {
  active_ = true;
  seen_ = 0;
  bounds_ = Box3();
}

void SceneBound::tick() {
  if (!in_.valid()) {
    return active_ && seen_ < r_.triangles ? stalled(kScene) : idle();
  }
  const SceneTriangle triangle = in_.pop();
  for (std::size_t i = 0; i < 9; ++i) {
    // One look at the exponent; the triangle's number goes to a status register.
    if (!std::isfinite(triangle.v[i])) {
      r_.fail("scene_bound: triangle " + std::to_string(triangle.id) +
              " has a coordinate that is not finite");
    }
  }
  for (std::size_t c = 0; c < 3; ++c) {
    bounds_.include({triangle.v[3 * c], triangle.v[3 * c + 1], triangle.v[3 * c + 2]});
  }
  ++seen_;
  busy();
}

Box3 SceneBound::bounds() const {
  if (seen_ == 0) return {{0, 0, 0}, {0, 0, 0}};
  Box3 b = bounds_;
  for (std::size_t a = 0; a < 3; ++a) {
    b.lo[a] += 0.0f;
    b.hi[a] += 0.0f;
  }
  return b;
}

bool SceneBound::outside(const Box3& given) const {
  if (seen_ == 0) return false;
  for (std::size_t a = 0; a < 3; ++a) {
    if (bounds_.lo[a] < given.lo[a] || bounds_.hi[a] > given.hi[a]) return true;
  }
  return false;
}

std::string SceneBound::waits_for() const {
  if (done()) return "";
  return "scene_reader for triangle " + std::to_string(seen_);
}

}  // namespace fasttree::model::ft2
