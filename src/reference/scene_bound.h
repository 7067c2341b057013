// SPDX-License-Identifier: Apache-2.0
// Step 1 of 6, scene bound calculation (SBCU). Docs: docs/scene_bound.md.
#pragma once

#include "fasttree/mesh.h"
#include "fasttree/status.h"
#include "fasttree/vec.h"

namespace fasttree::reference {

/// Smallest box round every corner of every triangle; vertices no triangle uses do not count. Minus
/// zero becomes plus zero. An empty mesh has the box 0..0. bad_input, naming the triangle, for a
/// coordinate that is not finite, and for an extent that overflows binary32.
Result<Box3> scene_bound(const MeshView& mesh);

}  // namespace fasttree::reference
