// SPDX-License-Identifier: Apache-2.0
#include "model/report/report_csv.h"

#include "model/report/account.h"
#include "model/report/text.h"

namespace fasttree::model {

std::string report_csv(const SimulationReport& report) {
  const SimulationResult& result = report.result;
  std::string text =
      "scene,config,stage,unit,kind,stage_cycles,busy_cycles,stalled_cycles,idle_cycles,"
      "stalled_on\n";
  const std::string run = csv_cell(report.scene) + "," + csv_cell(result.config) + ",";
  for (std::size_t s = 0; s < result.stages.size(); ++s) {
    const StageRecord& stage = result.stages[s];
    for (const UnitRecord& unit : result.units) {
      const Activity& activity = unit.by_stage[s];
      std::string on;
      for (const Wait& wait : waits(unit, activity)) {
        on += (on.empty() ? "" : "; ") + wait.on + " " + std::to_string(wait.cycles);
      }
      text += run + csv_cell(stage.name) + "," + csv_cell(unit.name) + "," + csv_cell(unit.kind);
      for (const std::uint64_t cycles :
           {cycles_of(stage), activity.busy_cycles, activity.stalled(), activity.idle_cycles}) {
        text += "," + std::to_string(cycles);
      }
      text += "," + csv_cell(on) + "\n";
    }
  }
  return text;
}

}  // namespace fasttree::model
