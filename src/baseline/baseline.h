// SPDX-License-Identifier: Apache-2.0
// The yardsticks: kd-trees made by the surface-area heuristic, for judging the Morton trees.
#pragma once

#include <cstdint>

#include "fasttree/build.h"
#include "fasttree/mesh.h"
#include "fasttree/quality.h"
#include "fasttree/status.h"
#include "fasttree/tree.h"
#include "fasttree/vec.h"

namespace fasttree {

/// What a baseline builder works on. All of it is the caller's and has to outlive the call.
struct BaselineInput {
  const MeshView& mesh;  ///< has passed validate()
  Box3 bounds;           ///< of all the mesh's triangles, finite; ignored if it has none
  SahCosts costs;        ///< finite, not negative
  std::uint64_t memory_limit_bytes;  ///< held at once, result included; 0: no limit
  const ProgressCallback& progress;  ///< may be empty
};

/// The exact surface-area heuristic with perfect splits, in O(N log N): I. Wald and V. Havran, "On
/// building fast kd-trees for ray tracing, and on doing that in O(N log N)", 2006.
/// invalid_argument: costs; resource_limit: memory or number of nodes; cancelled: by the callback.
Result<Tree> build_sah_exact(const BaselineInput& input);

/// The heuristic evaluated at the borders of 32 bins an axis, over the triangles' boxes, as
/// M. Shevtsov, A. Soupikov and A. Kapustin, "Highly parallel fast kd-tree construction for
/// interactive ray tracing of dynamic scenes", 2007, do for the upper levels. Here the bins are
/// used at every level. Errors as above.
Result<Tree> build_sah_binned(const BaselineInput& input);

}  // namespace fasttree
