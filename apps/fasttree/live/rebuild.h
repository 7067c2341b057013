// SPDX-License-Identifier: Apache-2.0
// A tree and a tracer that are made anew for every frame, in the memory of the frame before.
#pragma once

#include <vector>

#include "fasttree/build.h"
#include "fasttree/trace.h"
#include "fasttree/tree.h"

namespace fasttree::live {

class Rebuild {
 public:
  /// On failure tree and tracer are those of an empty scene.
  Status run(const MeshView& mesh, const BuildSettings& settings) {
    Status status = builder_.build(mesh, settings, tree_);
    if (!status.ok()) {
      tracer_ = Tracer();
      return status;
    }
    return tracer_.update(tree_, mesh);
  }

  const Tree& tree() const { return tree_; }
  const Tracer& tracer() const { return tracer_; }
  const std::vector<StageTime>& stages() const { return builder_.stats().stages; }

  double tree_ms() const { return builder_.stats().build_ms; }
  /// Of the tracer's own data. It is made anew as often as the tree is, so it counts as build.
  double layout_ms() const { return tracer_.layout_ms(); }
  double build_ms() const { return tree_ms() + layout_ms(); }

 private:
  Builder builder_;
  Tree tree_;
  Tracer tracer_;
};

}  // namespace fasttree::live
