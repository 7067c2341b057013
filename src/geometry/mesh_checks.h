// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fasttree/mesh.h"
#include "fasttree/status.h"

namespace fasttree {

/// The part of validate() that looks at no index: for a builder that checks each as it reads it.
Status validate_shape(const MeshView& mesh);

}  // namespace fasttree
