// SPDX-License-Identifier: Apache-2.0
// The six steps of the paper, literally: the golden model every fast path, the accelerator's model
// and its RTL are checked against. Scalar and readable; every intermediate array is public.
#pragma once

#include <vector>

#include "fasttree/build.h"
#include "fasttree/device_image.h"
#include "fasttree/mesh.h"
#include "fasttree/status.h"
#include "grid/grid.h"
#include "reference/bit_encoding.h"
#include "reference/internal_node.h"
#include "reference/leaf_node.h"
#include "reference/morton_code.h"
#include "reference/path_compression.h"

namespace fasttree::reference {

/// Everything the steps made, in the order they made it.
struct ReferenceBuild {
  std::uint32_t triangle_count = 0;
  Box3 bounds;                ///< step 1, scene_bound
  ReferenceCounts counts;     ///< M(D) for every D
  Grid grid;                  ///< at the depth that was chosen
  References references;      ///< step 2, morton_code
  References sorted;          ///< step 3, radix_sort
  LeafTable leaves;           ///< step 4, leaf_node
  InternalNodes internal;     ///< step 5, internal_node
  EssentialBitmap essential;  ///< step 5, bit_encoding
  Links links;                ///< step 6, path_compression
};

/// Builds profile `paper` from settings.axes, depth, extra_depth, max_growth, memory_limit_bytes
/// and progress. Errors as Builder::build. Times are appended to stats.stages.
Result<ReferenceBuild> build(const MeshView& mesh, const BuildSettings& settings,
                             BuildStats& stats);

/// What the hardware would leave in its memory. An empty mesh gives one leaf without triangles.
DeviceImage device_image(const ReferenceBuild& build);

}  // namespace fasttree::reference
