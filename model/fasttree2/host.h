// SPDX-License-Identifier: Apache-2.0
// What the host does before and after a build: picks D, lays out memory, puts the scene there as
// nine floats a triangle, and takes the tree out.
#pragma once

#include <cstdint>

#include "fasttree/mesh.h"
#include "fasttree/status.h"
#include "fasttree/tree.h"
#include "grid/grid.h"
#include "model/fasttree2/registers.h"
#include "model/memory/byte_store.h"

namespace fasttree::model::ft2 {

/// What the host knows or decides. D follows from the library's rule, which needs the bounds: a
/// host that shows moving scenes has them from the last frame, and a D that is one off costs time
/// and no correctness. In this model the host simply computes both.
struct HostPlan {
  Box3 bounds;
  int depth = 0;
  std::uint64_t references = 0;  ///< M(D), for the sizes of the regions
  Layout layout;
};

Result<HostPlan> make_plan(const MeshView& mesh, const FastTree2Config& config);

/// Whether the keys fit together (each alone is in its range already).
Status check(const FastTree2Config& config);

void upload_scene(const MeshView& mesh, Address to, ByteStore& store);

/// The tree as it lies in memory. Nodes were written backwards, from the last slot down, so the
/// root is in slot `root`; a tracer that is told so reads them in place. In the library's tree the
/// root is node 0, so that number is taken off every link.
Tree download_tree(const ByteStore& store, const Registers& registers, std::uint64_t root);

}  // namespace fasttree::model::ft2
