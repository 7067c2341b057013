// SPDX-License-Identifier: Apache-2.0
#include "report/json.h"

#include <nlohmann/json.hpp>

#include "inputs.h"
#include "model/report/account.h"
#include "report/figure1.h"

namespace fasttree::app {
namespace {

using nlohmann::ordered_json;

ordered_json value_of(const std::optional<double>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}

ordered_json json_of(const SkippedScene& scene) {
  return {{"scene", scene.scene}, {"reason", scene.reason}, {"remedy", scene.remedy}};
}

ordered_json json_of(const Claim& claim) {
  return {{"figure", claim.what},
          {"unit", claim.unit},
          {"paper", claim.paper},
          {"ours", value_of(claim.ours)},
          {"ratio", value_of(claim.ratio())},
          {"reason", claim.reason}};
}

ordered_json json_of(const SplitRow& row) {
  return {{"scene", row.scene},
          {"builder", row.builder},
          {"tree", row.simulated ? "simulated" : "measured"},
          {"measured", true},
          {"tree_ms", row.tree_ms},
          {"layout_ms", row.layout_ms},
          {"trace_ms", row.trace_ms},
          {"frame_ms", row.frame_ms()},
          {"construction_percent", row.construction_percent()}};
}

ordered_json json_of(const KeyChange& change) {
  return {{"key", change.key},
          {"base", change.base},
          {"value", change.value},
          {"time_percent", change.time_percent},
          {"area_percent", change.area_percent},
          {"energy_percent", change.energy_percent},
          {"meaning", change.meaning}};
}

ordered_json json_of(const ExploredRun& run) {
  ordered_json json = {{"config", run.config},
                       {"cycles", run.cycles},
                       {"cycles_per_triangle", run.cycles_per_triangle},
                       {"time_ms", run.time_ms},
                       {"bandwidth_gb_s", run.bandwidth_gb_s},
                       {"area_65nm_mm2", run.area_65nm_mm2},
                       {"area_28nm_mm2", run.area_28nm_mm2},
                       {"machine_power_w", run.machine_power_w},
                       {"machine_uj", run.machine_uj},
                       {"memory_uj", run.memory_uj},
                       {"tree_hash", run.tree_hash}};
  if (run.account == nullptr) return json;
  json["clock_mhz"] = run.account->clock_mhz;
  json["memory"] = run.account->memory_traits.name;
  json["stages"] = ordered_json::array();
  for (const model::StageRecord& stage : run.account->stages) {
    json["stages"].push_back({{"stage", stage.name},
                              {"begin_cycle", stage.begin_cycle},
                              {"cycles", model::cycles_of(stage)},
                              {"read_bytes", model::read_bytes(stage)},
                              {"write_bytes", model::write_bytes(stage)}});
  }
  return json;
}

ordered_json json_of(const Sensitivity& sensitivity);
ordered_json json_of(const EvaluatedScene& scene);

template <typename Rows>
ordered_json list_of(const Rows& rows) {
  ordered_json list = ordered_json::array();
  for (const auto& row : rows) list.push_back(json_of(row));
  return list;
}

ordered_json json_of(const Sensitivity& sensitivity) {
  return {{"config", sensitivity.config},
          {"scene", sensitivity.scene},
          {"base", json_of(sensitivity.base)},
          {"changes", list_of(sensitivity.changes)},
          {"refused", sensitivity.refused}};
}

ordered_json json_of(const EvaluatedScene& scene) {
  ordered_json json = {{"scene", scene.name},
                       {"source", scene.source},
                       {"of_paper", scene.paper != nullptr},
                       {"triangles", scene.triangles},
                       {"depth", scene.frame.depth},
                       {"references", scene.runs[kAsic65].account->references},
                       {"leaves", scene.runs[kAsic65].account->leaves},
                       {"tree_hash", scene.frame.tree_hash},
                       {"same_tree", scene.same_tree},
                       {"frame_rays", scene.frame.rays}};
  json["machines"] = list_of(scene.runs);
  return json;
}

}  // namespace

ordered_json json_of(const Evaluation& evaluation) {
  ordered_json json = json_of_program();
  json["quick"] = evaluation.settings.quick;
  json["measured_on"] = {{"processor", evaluation.processor}, {"threads", evaluation.threads}};
  json["scenes"] = list_of(evaluation.scenes);
  json["missing"] = list_of(evaluation.skipped);
  ordered_json split = ordered_json::array();
  for (const EvaluatedScene& scene : evaluation.scenes) {
    for (const SplitRow& row : figure1_rows(scene)) split.push_back(json_of(row));
  }
  json["figure1"] = split;
  json["table1"] = list_of(evaluation.table1);
  json["table2"] = list_of(evaluation.table2);
  json["table3"] = list_of(evaluation.table3);
  json["table3_paper"] = list_of(paper_table3());
  json["text"] = list_of(evaluation.claims);
  json["sensitivity"] = list_of(evaluation.sensitivities);
  json["worst_percent"] = worst_percent(evaluation.table2);
  return json;
}

}  // namespace fasttree::app
