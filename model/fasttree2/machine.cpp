// SPDX-License-Identifier: Apache-2.0
#include "model/fasttree2/machine.h"

#include <memory>
#include <utility>

#include "model/fasttree2/control.h"
#include "model/fasttree2/host.h"
#include "model/memory/byte_store.h"
#include "model/memory/capacity.h"

namespace fasttree::model::ft2 {

namespace {

// The leaf table and the sorted ids: of the arrays between the steps, those that this machine has.
void keep_arrays(const Tree& tree, IntermediateArrays& arrays) {
  arrays.sorted_ids.assign(tree.ids().begin(), tree.ids().end());
  for (const Node& node : tree.nodes()) {
    if (!node.is_leaf()) continue;
    arrays.leaf_first.push_back(node.first());
    arrays.leaf_count.push_back(node.count());
  }
}

}  // namespace

Result<SimulationResult> run(const MeshView& mesh, const std::string& name,
                             const FastTree2Config& config, double clock_mhz, Memory& memory,
                             const SimulationOptions& options, const Extras& extras,
                             Figures* figures) {
  const Result<HostPlan> plan = make_plan(mesh, config);
  if (!plan.ok()) return plan.status();
  if (Status status = check_capacity(memory.traits(), plan.value().layout.bytes); !status.ok()) {
    return status;
  }
  ByteStore store(plan.value().layout.bytes);
  upload_scene(mesh, plan.value().layout.scene, store);

  // Large: buffers of all units.
  const auto machine = std::make_unique<Machine>(plan.value(), mesh.triangle_count, config, extras,
                                                 clock_mhz, memory, store, options);
  if (Status status = machine->build(); !status.ok()) return status;

  SimulationResult result;
  result.config = name;
  result.clock_mhz = clock_mhz;
  machine->report(result);
  result.tree = download_tree(store, machine->registers(), machine->root_slot());
  if (options.keep_arrays) keep_arrays(result.tree, result.arrays);
  if (figures != nullptr) *figures = machine->figures();
  return result;
}

}  // namespace fasttree::model::ft2
