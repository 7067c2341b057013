// SPDX-License-Identifier: Apache-2.0
#include "figures.h"

#include <algorithm>

#include "inputs.h"

namespace fasttree::app {
namespace {

std::optional<double> ratio(double ours, double theirs) {
  if (ours > 0 && theirs > 0) return ours / theirs;
  return std::nullopt;
}

template <typename Figure>
const Figures& least(const std::vector<Figures>& figures, Figure figure) {
  return *std::min_element(figures.begin(), figures.end(), [&](const Figures& a, const Figures& b) {
    return figure(a) < figure(b);
  });
}

}  // namespace

RayCounts count_of(const MeasuredRays& rays) {
  RayCounts counts;
  for (std::size_t k = 0; k < counts.size(); ++k) counts[k] = rays.rays[k].size();
  return counts;
}

double KindFigures::mrays_per_s(std::size_t way) const {
  return ms[way] > 0 ? static_cast<double>(rays) / (ms[way] * 1e3) : 0;
}

Figures figures_of(const Record& record, const RayCounts& counts) {
  Figures figures;
  figures.name = record.name;
  figures.build_ms = median(record.build_ms);
  figures.rated_ms = figures.build_ms;
  if (record.tree) {
    const std::vector<double>& layout = record.tree->layout_ms;
    figures.layout_ms = median(layout);
    if (record.tree->profile != Profile::realtime) {
      std::vector<double> alone = record.build_ms;
      for (std::size_t i = 0; i < alone.size(); ++i) alone[i] -= layout[i];
      figures.rated_ms = median(alone);
    }
  }
  for (std::size_t k = 0; k < counts.size(); ++k) {
    KindFigures& kind = figures.kinds[k];
    kind.rays = counts[k];
    for (const auto& rounds : record.trace_ms[k]) kind.ms.push_back(median(rounds));
    const auto fastest = [&](std::ptrdiff_t from) {
      const auto begin = kind.ms.begin();
      return static_cast<std::size_t>(std::min_element(begin + from, kind.ms.end()) - begin);
    };
    kind.best = fastest(0);
    kind.best_packet = fastest(1);
  }
  const auto best_ms = [&](RayKind kind) { return figures.of(kind).ms[figures.of(kind).best]; };
  figures.frame_ms = figures.build_ms + best_ms(RayKind::primary) + best_ms(RayKind::shadow);
  return figures;
}

Ratios ratios_of(const Figures& tree, const Figures& embree) {
  Ratios ratios;
  ratios.against = embree.name;
  ratios.build = ratio(embree.build_ms, tree.rated_ms);
  ratios.frame = ratio(embree.frame_ms, tree.frame_ms);
  for (std::size_t k = 0; k < kRayKinds.size(); ++k) {
    const KindFigures& ours = tree.kinds[k];
    const KindFigures& theirs = embree.kinds[k];
    ratios.single[k] = ratio(ours.mrays_per_s(0), theirs.mrays_per_s(0));
    ratios.packet[k] =
        ratio(ours.mrays_per_s(ours.best_packet), theirs.mrays_per_s(theirs.best_packet));
  }
  return ratios;
}

const Ratios* HeadToHead::find(const std::string& name) const {
  for (const Ratios& ratios : each) {
    if (ratios.against == name) return &ratios;
  }
  return nullptr;
}

HeadToHead head_to_head(const Figures& tree, const std::vector<Figures>& embrees) {
  HeadToHead result;
  result.tree = tree;
  if (embrees.empty()) return result;
  for (const Figures& embree : embrees) result.each.push_back(ratios_of(tree, embree));
  const Figures& build = least(embrees, [](const Figures& f) { return f.build_ms; });
  const Figures& frame = least(embrees, [](const Figures& f) { return f.frame_ms; });
  result.build = ratio(build.build_ms, tree.rated_ms);
  result.build_against = build.name;
  result.frame = ratio(frame.frame_ms, tree.frame_ms);
  result.frame_against = frame.name;
  return result;
}

}  // namespace fasttree::app
