// SPDX-License-Identifier: Apache-2.0
#include "simulate_report.h"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "model/report/account.h"
#include "model/report/text.h"

namespace fasttree::app {
namespace {

using namespace model;

std::string waits_text(const UnitRecord& unit, const Activity& activity, std::uint64_t cycles) {
  std::string text;
  for (const Wait& wait : waits(unit, activity)) {
    text += (text.empty() ? "" : ", ") + wait.on + " " +
            percent(static_cast<double>(wait.cycles), static_cast<double>(cycles));
  }
  return text;
}

void print_headline(Output& output, const SimulationReport& report) {
  const SimulationResult& r = report.result;
  const TreeInfo& info = r.tree.info();
  output.line("scene                {} ({} triangles)", report.scene, with_commas(r.triangles));
  output.line("machine              {}, {} MHz, {}{}", r.config, r.clock_mhz, r.memory_traits.name,
              r.memory_traits.peak_gb_s > 0
                  ? fmt::format(" ({:.1f} GB/s peak)", r.memory_traits.peak_gb_s)
                  : "");
  output.line("engine               {}",
              report.engine == "rtl" ? "RTL (SystemVerilog, verilated)" : "cycle-level model");
  output.line("cycles               {}{}", with_commas(r.cycles),
              r.triangles > 0 ? fmt::format(", {:.2f} a triangle", cycles_per_triangle(r)) : "");
  output.line("time                 {:.4f} ms, {:.1f} frames a second", r.time_ms(),
              frames_per_s(r));
  output.line("tree                 {} axes, depth {}, {} references, {} leaves",
              to_string(info.axes), info.depth, with_commas(r.references), with_commas(r.leaves));
  output.line("hash                 {}", hash_string(r.tree.hash()));
}

void print_stages(Output& output, const SimulationReport& report) {
  const SimulationResult& r = report.result;
  const auto all = static_cast<double>(r.cycles);
  output.line("");
  Table table({"stage", "cycles", "share", "a triangle", "read", "written", "GB/s", "of peak"});
  const auto row = [&](const std::string& name, std::uint64_t cycles, std::uint64_t read,
                       std::uint64_t written) {
    const double bandwidth = gb_per_s(r, read + written, cycles);
    table.row({name, with_commas(cycles), percent(static_cast<double>(cycles), all),
               r.triangles > 0
                   ? fixed(static_cast<double>(cycles) / static_cast<double>(r.triangles), 2)
                   : "-",
               bytes_text(read), bytes_text(written), fixed(bandwidth, 2),
               percent(bandwidth, r.memory_traits.peak_gb_s)});
  };
  for (const StageRecord& stage : r.stages) {
    row(stage.name, cycles_of(stage), read_bytes(stage), write_bytes(stage));
  }
  row("all", r.cycles, read_bytes(r), write_bytes(r));
  table.print(output);
}

void print_units(Output& output, const SimulationResult& r) {
  output.line("");
  output.line("Units, by stage; those that are idle all through a stage are left out");
  Table table({"unit", "busy", "stalled", "idle", "stalled on"});
  table.words(4);
  const auto row = [&](const std::string& name, const UnitRecord& unit, const Activity& activity) {
    const std::uint64_t cycles = cycles_of(activity);
    const auto all = static_cast<double>(cycles);
    table.row({name, percent(static_cast<double>(activity.busy_cycles), all),
               percent(static_cast<double>(activity.stalled()), all),
               percent(static_cast<double>(activity.idle_cycles), all),
               waits_text(unit, activity, cycles)});
  };
  for (std::size_t s = 0; s < r.stages.size(); ++s) {
    table.row({r.stages[s].name});
    for (const UnitRecord& unit : r.units) {
      const Activity& activity = unit.by_stage[s];
      if (activity.idle_cycles != cycles_of(activity)) row("  " + unit.name, unit, activity);
    }
  }
  table.row({"all"});
  for (const UnitRecord& unit : r.units) row("  " + unit.name, unit, whole_run(unit));
  table.print(output);
}

void print_traffic(Output& output, const SimulationResult& r) {
  output.line("");
  Table table({"bytes over the bus", "read", "written", "a triangle"});
  const auto row = [&](const std::string& name, std::uint64_t read, std::uint64_t written) {
    table.row(
        {name, with_commas(read), with_commas(written),
         r.triangles > 0
             ? fixed(static_cast<double>(read + written) / static_cast<double>(r.triangles), 1)
             : "-"});
  };
  for (const StageRecord& stage : r.stages) {
    for (const Traffic& t : stage.traffic) {
      row(stage.name + ", " + t.purpose, t.read_bytes, t.write_bytes);
    }
  }
  row("all", read_bytes(r), write_bytes(r));
  table.print(output);
}

void print_latencies(Output& output, const MemoryStatistics& m) {
  const std::vector<std::uint64_t>& buckets = m.read_latency_8ns;
  const std::uint64_t most =
      buckets.empty() ? 0 : *std::max_element(buckets.begin(), buckets.end());
  if (most == 0) return;
  output.line("");
  Table table({"read latency, ns", "reads", "share", ""});
  table.words(3);
  for (std::size_t i = 0; i < buckets.size(); ++i) {
    // Less than one read in a thousand says nothing here; the JSON has them all.
    if (buckets[i] * 1000 < m.reads) continue;
    const std::string range = i + 1 < buckets.size() ? fmt::format("{} to {}", 8 * i, 8 * (i + 1))
                                                     : fmt::format("{} and more", 8 * i);
    constexpr std::size_t kWidth = 40;
    const std::string bar(std::max<std::size_t>(1, buckets[i] * kWidth / most), '#');
    table.row({range, with_commas(buckets[i]),
               percent(static_cast<double>(buckets[i]), static_cast<double>(m.reads)), bar});
  }
  table.print(output);
}

void print_memory(Output& output, const SimulationReport& report) {
  const SimulationResult& r = report.result;
  const MemoryStatistics& m = r.memory;
  const double bandwidth = gb_per_s(r, m.read_bytes + m.write_bytes, r.cycles);
  output.line("");
  output.line("memory               {} read, {} written; {:.2f} GB/s{}", bytes_text(m.read_bytes),
              bytes_text(m.write_bytes), bandwidth,
              r.memory_traits.peak_gb_s > 0
                  ? ", " + percent(bandwidth, r.memory_traits.peak_gb_s) + " of the peak"
                  : "");
  if (const std::optional<double> peak = bus_peak_gb_s(report.config)) {
    const double bus = gb_per_s(r, read_bytes(r) + write_bytes(r), r.cycles);
    output.line("bus                  {:.2f} GB/s, {} of its own peak of {:.1f}", bus,
                percent(bus, *peak), *peak);
  }
  if (const std::optional<double> hits = row_hit_share(m)) {
    output.line("rows                 {} found open; {} hits, {} misses, {} conflicts",
                percent(*hits, 1), with_commas(m.row_hits), with_commas(m.row_misses),
                with_commas(m.row_conflicts));
    output.line("                     {} refreshes, {} turnarounds", with_commas(m.refreshes),
                with_commas(m.turnarounds));
  }
  if (m.reads > 0) {
    const auto bound = [&](double share) {
      const std::optional<double> ns = read_latency_percentile_ns(m, share);
      return ns ? fmt::format("{:.0f} ns", *ns) : std::string("beyond the histogram");
    };
    output.line("read latency         {:.1f} ns on average, half within {}, 99 % within {}",
                mean_read_latency_ns(m), bound(0.5), bound(0.99));
  }
  const CacheStatistics& c = r.mark_cache;
  if (c.reads + c.writes > 0) {
    output.line("mark cache           {} of {} reads hit, {} of {} writes; {} written back",
                percent(static_cast<double>(c.read_hits), static_cast<double>(c.reads)),
                with_commas(c.reads),
                percent(static_cast<double>(c.write_hits), static_cast<double>(c.writes)),
                with_commas(c.writes), with_commas(c.write_backs));
  }
}

void print_costs(Output& output, const CostTable& costs) {
  output.line("");
  std::vector<std::string> header = {costs.title};
  for (const CostTable::Column& column : costs.columns) header.push_back(column.title);
  Table table(header);
  for (const CostTable::Row& row : costs.rows) {
    std::vector<std::string> cells = {row.unit};
    for (std::size_t c = 0; c < costs.columns.size(); ++c) {
      cells.push_back(fixed(row.values[c], costs.columns[c].digits));
    }
    table.row(cells);
  }
  std::vector<std::string> sum = {"all"};
  for (std::size_t c = 0; c < costs.columns.size(); ++c) {
    sum.push_back(fixed(costs.total(c), costs.columns[c].digits));
  }
  table.row(sum);
  table.print(output);
  for (const CostTable::Figure& figure : costs.figures) {
    output.line("{}: {}", figure.title, fixed(figure.value, figure.digits));
  }
  if (!costs.basis.empty()) output.line("{}", costs.basis);
}

}  // namespace

void print_simulation(Output& output, const SimulationReport& report) {
  print_headline(output, report);
  print_stages(output, report);
  print_units(output, report.result);
  print_traffic(output, report.result);
  print_memory(output, report);
  print_latencies(output, report.result.memory);
  for (const CostTable& costs : report.costs) print_costs(output, costs);
  output.line("");
  output.line(
      "simulated            in {:.2f} s, {:.2f} million cycles a second", report.wall_s,
      report.wall_s > 0 ? static_cast<double>(report.result.cycles) / report.wall_s / 1e6 : 0.0);
  if (report.compared) {
    output.line("check                {}",
                report.difference.empty() ? "every array and the tree equal the reference builder's"
                                          : "DIFFERS: " + report.difference);
  }
}

}  // namespace fasttree::app
