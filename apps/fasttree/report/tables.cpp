// SPDX-License-Identifier: Apache-2.0
#include "report/tables.h"

#include <fmt/format.h>

#include "model/report/account.h"
#include "report/figure1.h"

namespace fasttree::app {
namespace {

std::string number(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : "-";
}

double share(double part, double whole) {
  return whole > 0 ? part / whole : 0;
}

}  // namespace

Table scene_table(const Evaluation& evaluation) {
  Table table({"scene", "from", "triangles", "in the paper", "references/tri", "leaves", "depth",
               "same tree"});
  for (const EvaluatedScene& scene : evaluation.scenes) {
    const model::SimulationResult& account = *scene.runs[kAsic65].account;
    table.row({scene.name, scene.source, with_commas(scene.triangles),
               scene.paper != nullptr ? with_commas(scene.paper->triangles) : "-",
               fmt::format("{:.2f}", share(static_cast<double>(account.references),
                                           static_cast<double>(scene.triangles))),
               with_commas(account.leaves), std::to_string(scene.frame.depth),
               scene.same_tree ? "yes" : "NO"});
  }
  return table;
}

Table skipped_table(const Evaluation& evaluation) {
  Table table({"scene", "why it is missing", "how to get it"});
  for (const SkippedScene& scene : evaluation.skipped) {
    table.row({scene.scene, scene.reason, scene.remedy});
  }
  return table;
}

Table figure1_table(const Evaluation& evaluation) {
  Table table({"scene", "builder", "tree ms", "layout ms", "trace ms", "frame ms", "construction %",
               "FPS", "tree's time"});
  for (const EvaluatedScene& scene : evaluation.scenes) {
    for (const SplitRow& row : figure1_rows(scene)) {
      table.row(
          {row.scene, row.builder, fmt::format("{:.2f}", row.tree_ms),
           fmt::format("{:.2f}", row.layout_ms), fmt::format("{:.2f}", row.trace_ms),
           fmt::format("{:.2f}", row.frame_ms()), fmt::format("{:.1f}", row.construction_percent()),
           fmt::format("{:.1f}", 1000 / row.frame_ms()), row.simulated ? "simulated" : "measured"});
    }
  }
  return table;
}

Table claim_table(const Evaluation& evaluation) {
  Table table({"figure", "unit", "paper", "ours", "ratio", "reason"});
  for (const Claim& claim : evaluation.claims) {
    table.row({claim.what, claim.unit, fmt::format("{:g}", claim.paper),
               number(claim.ours, claim.digits), number(claim.ratio(), 3), claim.reason});
  }
  return table;
}

Table machine_table(const Evaluation& evaluation) {
  Table table({"scene", "machine", "MHz", "cycles", "cycles/tri", "ms", "FPS", "times paper-asic65",
               "GB/s", "mm2 at 65 nm", "W", "machine uJ", "memory uJ", "tree"});
  for (const EvaluatedScene& scene : evaluation.scenes) {
    for (const Machine machine : kTimedMachines) {
      const ExploredRun& run = scene.runs[machine];
      table.row({scene.name, run.config, fmt::format("{:g}", run.account->clock_mhz),
                 with_commas(run.cycles), fmt::format("{:.2f}", run.cycles_per_triangle),
                 fmt::format("{:.3f}", run.time_ms), fmt::format("{:.1f}", 1000 / run.time_ms),
                 fmt::format("{:.2f}", scene.runs[kAsic65].time_ms / run.time_ms),
                 fmt::format("{:.2f}", run.bandwidth_gb_s),
                 fmt::format("{:.2f}", run.area_65nm_mm2),
                 fmt::format("{:.2f}", run.machine_power_w), fmt::format("{:.1f}", run.machine_uj),
                 fmt::format("{:.1f}", run.memory_uj), run.tree_hash});
    }
  }
  return table;
}

Table stage_table(const Evaluation& evaluation) {
  Table table({"scene", "machine", "stage", "cycles", "share %", "cycles/tri", "bytes read/tri",
               "bytes written/tri"});
  for (const EvaluatedScene& scene : evaluation.scenes) {
    const auto triangles = static_cast<double>(scene.triangles);
    for (const Machine machine : kTimedMachines) {
      const ExploredRun& run = scene.runs[machine];
      for (const model::StageRecord& stage : run.account->stages) {
        const auto cycles = static_cast<double>(model::cycles_of(stage));
        table.row(
            {scene.name, run.config, stage.name, with_commas(model::cycles_of(stage)),
             fmt::format("{:.1f}", 100 * share(cycles, static_cast<double>(run.cycles))),
             fmt::format("{:.3f}", share(cycles, triangles)),
             fmt::format("{:.1f}", share(static_cast<double>(model::read_bytes(stage)), triangles)),
             fmt::format("{:.1f}",
                         share(static_cast<double>(model::write_bytes(stage)), triangles))});
      }
    }
  }
  return table;
}

Table bandwidth_table(const Evaluation& evaluation) {
  Table table({"scene", "machine", "from us", "to us", "GB/s"});
  for (const EvaluatedScene& scene : evaluation.scenes) {
    for (const Machine machine : kTimedMachines) {
      const ExploredRun& run = scene.runs[machine];
      const model::SimulationResult& account = *run.account;
      for (const model::TimelineSample& sample : account.timeline) {
        const auto us = [&](std::uint64_t cycle) {
          return fmt::format("{:.3f}", static_cast<double>(cycle) / account.clock_mhz);
        };
        table.row(
            {scene.name, run.config, us(sample.begin_cycle), us(sample.begin_cycle + sample.cycles),
             fmt::format("{:.3f}", model::gb_per_s(account, sample.bus_bytes, sample.cycles))});
      }
    }
  }
  return table;
}

Table change_table(const Sensitivity& sensitivity) {
  Table table({"key", "holds", "changed to", "time %", "area %", "energy %", "what it is"});
  for (const KeyChange& change : sensitivity.changes) {
    table.row({change.key, change.base, change.value, fmt::format("{:+.2f}", change.time_percent),
               fmt::format("{:+.2f}", change.area_percent),
               fmt::format("{:+.2f}", change.energy_percent), change.meaning});
  }
  return table;
}

std::vector<NamedTable> all_tables(const Evaluation& evaluation) {
  std::vector<NamedTable> tables = {{"scenes", scene_table(evaluation)},
                                    {"missing", skipped_table(evaluation)},
                                    {"figure1", figure1_table(evaluation)},
                                    {"table1", table_of(evaluation.table1, true)},
                                    {"table2", table_of(evaluation.table2, false, true)},
                                    {"table3", table_of(evaluation.table3, true, true)},
                                    {"table3_paper", paper_table3_table()},
                                    {"text", claim_table(evaluation)},
                                    {"machines", machine_table(evaluation)},
                                    {"stages", stage_table(evaluation)},
                                    {"bandwidth", bandwidth_table(evaluation)}};
  for (const Sensitivity& sensitivity : evaluation.sensitivities) {
    tables.push_back({"changes_" + sensitivity.config, change_table(sensitivity)});
  }
  return tables;
}

}  // namespace fasttree::app
