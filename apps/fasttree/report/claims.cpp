// SPDX-License-Identifier: Apache-2.0
// Xingyu Liu, Yangdong Deng, Yufei Ni, Zonghui Li: FastTree. DATE 2015, sections IV and V.
#include "report/claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "model/report/account.h"
#include "report/evaluation.h"

namespace fasttree::app {
namespace {

constexpr std::uint64_t kSmallScene = 300'000;  // triangles, "less than 300K"

double fps(const ExploredRun& run) {
  return 1000 / run.time_ms;
}

const EvaluatedScene* find(const Evaluation& evaluation, std::string_view file) {
  for (const EvaluatedScene& scene : evaluation.scenes) {
    if (scene.paper != nullptr && scene.paper->file == file) return &scene;
  }
  return nullptr;
}

Claim clock(const Evaluation& evaluation) {
  return {"Clock of the FPGA prototype",
          "MHz",
          kPaperFpgaMhz,
          evaluation.table1.back().mhz,
          0,
          "ours is the slowest unit by a table of delays, without place and route (Table I)"};
}

/// The slowest of the scenes that the paper's sentence is about.
Claim small_scenes(const Evaluation& evaluation) {
  Claim claim{"Frames a second on scenes with less than 300,000 triangles, at least",
              "1/s",
              58,
              {},
              0,
              "no such scene is here"};
  const EvaluatedScene* slowest = nullptr;
  for (const EvaluatedScene& scene : evaluation.scenes) {
    if (scene.triangles >= kSmallScene) continue;
    if (slowest == nullptr || fps(scene.runs[kAsic65]) < fps(slowest->runs[kAsic65])) {
      slowest = &scene;
    }
  }
  if (slowest == nullptr) return claim;
  claim.ours = fps(slowest->runs[kAsic65]);
  claim.comparable = slowest->paper != nullptr;
  claim.reason = fmt::format("the slowest here is {} with {} triangles; the paper's is Conference",
                             slowest->name, with_commas(slowest->triangles));
  return claim;
}

Claim frames(const Evaluation& evaluation, const char* file, const char* what, double paper) {
  Claim claim{fmt::format("Frames a second on {}, at least", what),
              "1/s",
              paper,
              {},
              1,
              "the scene is not here"};
  if (const EvaluatedScene* scene = find(evaluation, file)) {
    claim.ours = fps(scene->runs[kAsic65]);
    claim.reason = "with the timing of its own memory, which the paper leaves out";
  }
  return claim;
}

Claim bandwidth(const Evaluation& evaluation) {
  Claim claim{"Memory bandwidth needed", "GB/s", 1.15, {}, 2, ""};
  const EvaluatedScene* most = nullptr;
  for (const EvaluatedScene& scene : evaluation.scenes) {
    if (most == nullptr ||
        scene.runs[kAsic65].bandwidth_gb_s > most->runs[kAsic65].bandwidth_gb_s) {
      most = &scene;
    }
  }
  const model::SimulationResult& account = *most->runs[kAsic65].account;
  std::uint64_t all = 0, sorting = 0;
  for (const model::StageRecord& stage : account.stages) {
    const std::uint64_t bytes = model::read_bytes(stage) + model::write_bytes(stage);
    all += bytes;
    if (stage.name == "radix_sort") sorting += bytes;
  }
  const double rest = model::gb_per_s(account, all - sorting, account.cycles);
  claim.ours = most->runs[kAsic65].bandwidth_gb_s;
  claim.comparable = most->paper != nullptr;
  claim.reason = fmt::format(
      "{}, the most of all scenes; {:.0f} % of it are the pairs of the sort, which eight rounds "
      "read and write: without them {:.2f} GB/s. The paper's figure is about two reads of the "
      "scene",
      most->name, all > 0 ? 100.0 * static_cast<double>(sorting) / static_cast<double>(all) : 0,
      rest);
  return claim;
}

Claim speed_over_raycore(const Evaluation& evaluation) {
  Claim claim{"Times as fast as RayCore, on Bunny", "", 3.9, {}, 2, "Bunny is not here"};
  if (const EvaluatedScene* bunny = find(evaluation, "bunny")) {
    claim.ours = kRayCoreMs / bunny->runs[kAsic65].time_ms;
    const double scaled =
        bunny->runs[kFpga].time_ms * kPaperFpgaMhz / kPaperAsicMhz;  // as the paper does
    claim.reason = fmt::format(
        "with the timing of its own memory; with the prototype's cycles at 500 MHz, as the paper "
        "has it, {:.2f}. RayCore's time is as published, for a scene of 64,000 triangles",
        kRayCoreMs / scaled);
  }
  return claim;
}

std::vector<Claim> costs(const Evaluation& evaluation) {
  const ExploredRun& asic = evaluation.scenes.front().runs[kAsic65];
  const char* calibrated = "calibrated on this very figure: no evidence";
  double power = 0;
  for (const EvaluatedScene& scene : evaluation.scenes) {
    power = std::max(power, scene.runs[kAsic65].machine_power_w);
  }
  return {{"Area at 65 nm", "mm2", 5.4, asic.area_65nm_mm2, 2, calibrated},
          {"Area scaled to 28 nm, at most", "mm2", 1.4, asic.area_28nm_mm2, 2, calibrated},
          {"Power at 65 nm", "W", 3.9, power, 2,
           "ours is the mean of a run, the largest of all scenes; with every unit busy it is the "
           "paper's, on which it is calibrated"}};
}

}  // namespace

std::vector<Claim> claims_of(const Evaluation& evaluation) {
  std::vector<Claim> claims = {clock(evaluation),
                               small_scenes(evaluation),
                               frames(evaluation, "dragon", "Dragon", 19),
                               frames(evaluation, "happy_buddha", "Happy Buddha", 15),
                               bandwidth(evaluation),
                               speed_over_raycore(evaluation)};
  for (Claim& claim : costs(evaluation)) claims.push_back(std::move(claim));
  return claims;
}

}  // namespace fasttree::app
