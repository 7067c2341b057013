// SPDX-License-Identifier: Apache-2.0
#include "compare_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "chart.h"
#include "inputs.h"
#include "oracle/embree_oracle.h"
#include "views.h"

namespace fasttree::app {
namespace {

using nlohmann::ordered_json;

constexpr const char* kMedium = "embree-medium";
constexpr const char* kLow = "embree-low";

double mtriangles_per_s(const Comparison& c, const Figures& f) {
  return f.rated_ms > 0 ? c.triangles / (f.rated_ms * 1e3) : 0;
}

/// "1 thread", "2 threads"
std::string counted(std::uint64_t n, const char* what) {
  return fmt::format("{} {}{}", with_commas(n), what, n == 1 ? "" : "s");
}

std::string text_of(const std::optional<double>& ratio) {
  return ratio ? fmt::format("{:.2f}", *ratio) : "-";
}

/// Figures of the trees alone, as cells. Embrees have "-".
std::vector<std::string> tree_cells(const Comparison& c, const Record& record) {
  if (!record.tree) return std::vector<std::string>(7, "-");
  const Quality& q = record.tree->quality;
  std::vector<std::string> cells = {std::to_string(q.nodes),
                                    fmt::format("{:.3f}", q.references_per_triangle),
                                    fmt::format("{:.1f}", q.sah_cost)};
  for (const RayKind kind : {RayKind::primary, RayKind::diffuse}) {
    const auto k = static_cast<std::size_t>(kind);
    const TraceCounters& n = record.tree->counters[k];
    const double count = static_cast<double>(std::max<std::size_t>(1, c.counts[k]));
    cells.push_back(
        fmt::format("{:.1f}", static_cast<double>(n.inner_steps + n.leaf_visits) / count));
    cells.push_back(fmt::format("{:.1f}", static_cast<double>(n.triangle_tests) / count));
  }
  return cells;
}
const std::vector<std::string> kTreeColumns = {"nodes",         "refs/tri",      "SAH cost",
                                               "nodes/primary", "tests/primary", "nodes/diffuse",
                                               "tests/diffuse"};

/// Times and rates: of each kind of rays singly, and the fastest packets and their width.
std::vector<std::string> speed_cells(const Figures& f) {
  std::vector<std::string> cells = {fmt::format("{:.2f}", f.build_ms),
                                    f.layout_ms > 0 ? fmt::format("{:.2f}", f.layout_ms) : "-",
                                    fmt::format("{:.2f}", f.frame_ms)};
  for (const KindFigures& kind : f.kinds) {
    cells.push_back(fmt::format("{:.3f}", kind.mrays_per_s(0)));
    cells.push_back(fmt::format("{:.3f}", kind.mrays_per_s(kind.best_packet)));
  }
  return cells;
}

std::vector<std::string> joined(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

void print_ratios(Output& output, const Comparison& c) {
  const HeadToHead& duel = c.duel;
  if (duel.each.empty()) {
    output.line("no ratios: {}", c.no_embree);
    return;
  }
  output.line("{} over Embree, how many times as fast (below 1: Embree is faster)", duel.tree.name);
  output.line("");
  std::vector<std::string> header = {"against", "build", "frame"};
  for (const RayKind kind : kRayKinds) {
    header.push_back(fmt::format("{} single", to_string(kind)));
    header.push_back("packet");
  }
  Table table(header);
  for (const Ratios& ratios : duel.each) {
    std::vector<std::string> row = {ratios.against, text_of(ratios.build), text_of(ratios.frame)};
    for (std::size_t k = 0; k < kRayKinds.size(); ++k) {
      row.push_back(text_of(ratios.single[k]));
      row.push_back(text_of(ratios.packet[k]));
    }
    table.row(row);
  }
  table.print(output);
  output.line("");
  output.line(
      "build  {} of Embree's fastest rebuild ({}){}", text_of(duel.build), duel.build_against,
      duel.tree.rated_ms < duel.tree.build_ms ? ", the kd-tree without the tracer's layout" : "");
  output.line("frame  {} of Embree's best frame ({})", text_of(duel.frame), duel.frame_against);
}

ordered_json json_of(const std::optional<double>& ratio) {
  return ratio ? ordered_json(*ratio) : ordered_json(nullptr);
}

/// The same keys whether there are ratios or not.
ordered_json ray_ratios(const Ratios* ratios) {
  ordered_json json;
  for (std::size_t k = 0; k < kRayKinds.size(); ++k) {
    json[fmt::format("{}_single", to_string(kRayKinds[k]))] =
        json_of(ratios != nullptr ? ratios->single[k] : std::nullopt);
  }
  for (std::size_t k = 0; k < kRayKinds.size(); ++k) {
    json[fmt::format("{}_packet", to_string(kRayKinds[k]))] =
        json_of(ratios != nullptr ? ratios->packet[k] : std::nullopt);
  }
  return json;
}

ordered_json ratio_json(const HeadToHead& duel) {
  const bool any = !duel.each.empty();
  const auto name = [&](const std::string& text) {
    return any ? ordered_json(text) : ordered_json(nullptr);
  };
  ordered_json json = {{"of", duel.tree.name},
                       {"build", json_of(duel.build)},
                       {"build_against", name(duel.build_against)},
                       {"frame", json_of(duel.frame)},
                       {"frame_against", name(duel.frame_against)}};
  json.update(ray_ratios(duel.find(kMedium)));
  for (const auto& [key, embree] : {std::pair{"low", kLow}, std::pair{"medium", kMedium}}) {
    const Ratios* ratios = duel.find(embree);
    ordered_json one = {{"build", json_of(ratios != nullptr ? ratios->build : std::nullopt)},
                        {"frame", json_of(ratios != nullptr ? ratios->frame : std::nullopt)}};
    one.update(ray_ratios(ratios));
    json[key] = one;
  }
  return json;
}

ordered_json kind_json(const Record& record, const Figures& f, std::size_t k) {
  const KindFigures& kind = f.kinds[k];
  ordered_json json = {{"rays", kind.rays},
                       {"way", record.ways[kind.best]},
                       {"trace_ms", kind.ms[kind.best]},
                       {"mrays_per_s", kind.mrays_per_s(kind.best)}};
  for (std::size_t way = 0; way < record.ways.size(); ++way) {
    json["ways"][record.ways[way]] = {{"trace_ms", kind.ms[way]},
                                      {"trace_ms_all", record.trace_ms[k][way]},
                                      {"mrays_per_s", kind.mrays_per_s(way)}};
  }
  if (record.tree) {
    const TraceCounters& n = record.tree->counters[k];
    const double count = static_cast<double>(std::max<std::size_t>(1, kind.rays));
    json["inner_steps_per_ray"] = static_cast<double>(n.inner_steps) / count;
    json["leaf_visits_per_ray"] = static_cast<double>(n.leaf_visits) / count;
    json["triangle_tests_per_ray"] = static_cast<double>(n.triangle_tests) / count;
  } else {
    json["other_outcomes"] = record.other_outcomes[k];
  }
  return json;
}

ordered_json contender_json(const Comparison& c, const Record& record, const Figures& f) {
  ordered_json json = {{"builder", record.name},
                       {"build_ms", f.build_ms},
                       {"build_ms_all", record.build_ms},
                       {"rated_build_ms", f.rated_ms},
                       {"build_mtriangles_per_s", mtriangles_per_s(c, f)},
                       {"frame_ms", f.frame_ms}};
  for (std::size_t k = 0; k < kRayKinds.size(); ++k) {
    const KindFigures& kind = f.kinds[k];
    json[fmt::format("{}_mrays_per_s", to_string(kRayKinds[k]))] = kind.mrays_per_s(kind.best);
  }
  if (record.tree) {
    json["layout_ms"] = median(record.tree->layout_ms);
    json["depth"] = record.tree->depth;
    json["tree_hash"] = hash_string(record.tree->hash);
    json["quality"] = app::json_of(record.tree->quality);
  }
  for (std::size_t k = 0; k < kRayKinds.size(); ++k) {
    json[to_string(kRayKinds[k])] = kind_json(record, f, k);
  }
  return json;
}

}  // namespace

void print(Output& output, const Comparison& c) {
  output.line("{}: {} triangles; {} primary, {} shadow, {} diffuse rays; {}", c.scene,
              with_commas(c.triangles), with_commas(c.counts[0]), with_commas(c.counts[1]),
              with_commas(c.counts[2]), counted(static_cast<std::uint64_t>(c.threads), "thread"));
  output.line("medians of {}, after one that warms up and does not count",
              counted(c.rounds, "round"));
  output.line("layout: the tracer's part of the build; frame: build, primary and shadow rays");
  output.line("rays in Mray/s; packet: the fastest packets");
  output.line("");
  std::vector<std::string> header = {"builder", "build ms", "layout", "frame ms"};
  for (const RayKind kind : kRayKinds) {
    header.push_back(fmt::format("{} single", to_string(kind)));
    header.push_back("packet");
  }
  Table speed(header);
  for (const Figures& f : c.figures) speed.row(joined({f.name}, speed_cells(f)));
  speed.print(output);
  output.line("");
  Table trees(joined({"tree"}, kTreeColumns));
  for (const Record& record : c.records) {
    if (record.tree) trees.row(joined({record.name}, tree_cells(c, record)));
  }
  trees.print(output);
  output.line("");
  print_ratios(output, c);
  for (const Record& record : c.records) {
    for (std::size_t k = 0; k < kRayKinds.size(); ++k) {
      // Its rounding is another; more than that would mean that it traced something else.
      if (record.other_outcomes[k] * 1000 <= c.counts[k]) continue;
      output.line("note: {} of {}'s {} rays hit where the trees' miss, or the reverse",
                  with_commas(record.other_outcomes[k]), record.name, to_string(kRayKinds[k]));
    }
  }
}

std::string csv_of(const Comparison& c) {
  std::vector<std::string> header = {"builder", "build ms", "layout", "frame ms"};
  for (const RayKind kind : kRayKinds) {
    header.push_back(fmt::format("{} single Mray/s", to_string(kind)));
    header.push_back(fmt::format("{} packet Mray/s", to_string(kind)));
  }
  Table table(joined(header, kTreeColumns));
  for (std::size_t i = 0; i < c.records.size(); ++i) {
    table.row(joined(joined({c.records[i].name}, speed_cells(c.figures[i])),
                     tree_cells(c, c.records[i])));
  }
  return table.csv();
}

std::string svg_of(const Comparison& c) {
  std::vector<ChartPanel> panels;
  const auto times = [&](const char* title, double Figures::*figure) {
    ChartPanel panel{title, {}};
    for (const Figures& f : c.figures) {
      panel.bars.push_back({f.name, f.*figure, fmt::format("{:.2f} ms", f.*figure)});
    }
    panels.push_back(panel);
  };
  times("Build time in ms (shorter is better)", &Figures::build_ms);
  for (std::size_t k = 0; k < kRayKinds.size(); ++k) {
    ChartPanel panel{
        fmt::format("Millions of {} rays a second (longer is better)", to_string(kRayKinds[k])),
        {}};
    for (std::size_t i = 0; i < c.records.size(); ++i) {
      const KindFigures& kind = c.figures[i].kinds[k];
      const double rate = kind.mrays_per_s(kind.best);
      panel.bars.push_back({c.records[i].name, rate,
                            fmt::format("{:.2f} ({})", rate, c.records[i].ways[kind.best])});
    }
    panels.push_back(panel);
  }
  times("Frame: build, primary and shadow rays in ms (shorter is better)", &Figures::frame_ms);
  return bar_chart_svg(fmt::format("{}, {}, {}", c.scene, counted(c.triangles, "triangle"),
                                   counted(static_cast<std::uint64_t>(c.threads), "thread")),
                       panels);
}

ordered_json json_of(const Comparison& c) {
  ordered_json list = ordered_json::array();
  for (std::size_t i = 0; i < c.records.size(); ++i) {
    list.push_back(contender_json(c, c.records[i], c.figures[i]));
  }
  ordered_json json = json_of_program();
  json["scene"] = c.scene;
  json["source"] = c.source;
  json["triangles"] = c.triangles;
  json["threads"] = c.threads;
  json["rounds"] = c.rounds;
  json["width"] = c.width;
  json["height"] = c.height;
  json["camera"] = app::json_of(c.camera);
  json["light"] = app::json_of(c.light);
  json["embree"] =
      oracle::embree_available() ? ordered_json(oracle::embree_version()) : ordered_json(nullptr);
  json["same_hits"] = c.wrong.empty();
  json["builders"] = list;
  json["ratio"] = ratio_json(c.duel);
  return json;
}

}  // namespace fasttree::app
