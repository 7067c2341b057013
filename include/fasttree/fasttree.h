// SPDX-License-Identifier: Apache-2.0
// Everything of the C++ API.
#pragma once

#include "fasttree/build.h"
#include "fasttree/device_image.h"
#include "fasttree/mesh.h"
#include "fasttree/quality.h"
#include "fasttree/status.h"
#include "fasttree/trace.h"
#include "fasttree/tree.h"
#include "fasttree/tree_file.h"
#include "fasttree/vec.h"
#include "fasttree/verify.h"
