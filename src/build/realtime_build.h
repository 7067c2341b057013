// SPDX-License-Identifier: Apache-2.0
// Profile `realtime`, fast: a coarse grid, gridded again where crowded. Same bytes as
// src/reference/realtime_build.h; docs/realtime.md is the definition.
#pragma once

#include "build/morton_build.h"

namespace fasttree::build {

/// Builds into `tree`, whose arrays' memory is reused. Errors as Builder::build.
Status realtime_build(const MeshView& mesh, const BuildSettings& settings, Workspace& workspace,
                      TreeArrays& tree, BuildStats& stats);

}  // namespace fasttree::build
