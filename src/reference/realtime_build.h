// SPDX-License-Identifier: Apache-2.0
// Profile `realtime`, literally: a coarse grid, gridded again where crowded. Scalar and readable;
// the definition is docs/realtime.md.
#pragma once

#include "fasttree/build.h"
#include "fasttree/mesh.h"
#include "fasttree/status.h"
#include "fasttree/tree.h"

namespace fasttree::reference {

/// Builds from settings.depth (of the top grid), memory_limit_bytes and progress. Errors as
/// Builder::build. Times are appended to stats.stages.
Result<Tree> realtime_build(const MeshView& mesh, const BuildSettings& settings, BuildStats& stats);

}  // namespace fasttree::reference
