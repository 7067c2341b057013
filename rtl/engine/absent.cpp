// SPDX-License-Identifier: Apache-2.0
// Instead of the engine where the program was built without Verilator.
#include "rtl/engine/rtl_machine.h"

namespace fasttree::rtl {
namespace {

Status absent() {
  return Status(StatusCode::invalid_argument,
                "this program was built without the RTL: install verilator and zlib1g-dev, and "
                "configure anew with -DFASTTREE_RTL=ON");
}

}  // namespace

Status check_built(const model::MachineConfig&) {
  return absent();
}

Result<model::SimulationResult> simulate_rtl(const MeshView&, const model::MachineConfig&,
                                             const model::SimulationOptions&, const RtlOptions&) {
  return absent();
}

Result<model::SimulationResult> simulate_rtl(const MeshView&, const model::MachineConfig&,
                                             const model::SimulationOptions&, const RtlOptions&,
                                             model::Memory&) {
  return absent();
}

}  // namespace fasttree::rtl
