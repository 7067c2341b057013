// SPDX-License-Identifier: Apache-2.0
#include "model/report/html_report.h"

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "model/report/account.h"
#include "model/report/html_plots.h"
#include "model/report/html_style.h"
#include "model/report/text.h"

namespace fasttree::model {
namespace {

// A table that scrolls by itself where the page is too narrow. Cells are HTML.
class HtmlTable {
 public:
  explicit HtmlTable(const std::vector<std::string>& header) {
    text_ = "<div class=\"scroll\"><table>\n<thead><tr>";
    for (const std::string& cell : header) {
      text_ += cell.starts_with("<th") ? cell : "<th>" + cell + "</th>";
    }
    text_ += "</tr></thead>\n<tbody>\n";
  }
  void row(const std::vector<std::string>& cells, const char* style = nullptr) {
    text_ += style != nullptr ? "<tr class=\"" + std::string(style) + "\">" : std::string("<tr>");
    for (const std::string& cell : cells) {
      // A cell that says so brings its own tag.
      text_ += cell.starts_with("<td") ? cell : "<td>" + cell + "</td>";
    }
    text_ += "</tr>\n";
  }
  std::string finish() const { return text_ + "</tbody></table></div>\n"; }

 private:
  std::string text_;
};

std::string a_triangle(double value, const SimulationResult& r, int digits) {
  return r.triangles > 0 ? fixed(value / static_cast<double>(r.triangles), digits) : "-";
}

std::string tiles(const SimulationReport& report) {
  const SimulationResult& r = report.result;
  const MemoryStatistics& m = r.memory;
  const double bandwidth = gb_per_s(r, m.read_bytes + m.write_bytes, r.cycles);
  std::vector<std::pair<std::string, std::string>> list = {
      {grouped(r.cycles), "cycles"},
      {a_triangle(static_cast<double>(r.cycles), r, 2), "cycles a triangle"},
      {fixed(r.time_ms(), 3) + " ms", "a build"},
      {frames_per_s(r) < 1000 ? fixed(frames_per_s(r), 1)
                              : grouped(static_cast<std::uint64_t>(frames_per_s(r))),
       "frames a second"},
      {fixed(bandwidth, 2) + " GB/s",
       r.memory_traits.peak_gb_s > 0
           ? percent(bandwidth, r.memory_traits.peak_gb_s) + " of the memory's peak"
           : "to and from memory"}};
  if (const std::optional<double> hits = row_hit_share(m)) {
    list.emplace_back(percent(*hits, 1), "of accesses found their row open");
  }
  std::string text = "<div class=\"tiles\">\n";
  for (const auto& [value, what] : list) {
    text += "<div><b>" + value + "</b><span>" + what + "</span></div>\n";
  }
  return text + "</div>\n";
}

std::string check_line(const SimulationReport& report) {
  if (!report.compared) return "";
  if (!report.difference.empty()) {
    return "<p class=\"bad\">Differs from the reference builder: " +
           escaped_html(report.difference) + "</p>\n";
  }
  return "<p>Every array and the tree equal the reference builder&#39;s.</p>\n";
}

std::string stage_table(const SimulationResult& r) {
  HtmlTable table({"stage", "cycles", "share", "a triangle", "read", "written", "GB/s"});
  const auto row = [&](const std::string& name, std::uint64_t cycles, std::uint64_t read,
                       std::uint64_t written, const char* style) {
    table.row(
        {name, grouped(cycles), percent(static_cast<double>(cycles), static_cast<double>(r.cycles)),
         a_triangle(static_cast<double>(cycles), r, 2), byte_count(read), byte_count(written),
         fixed(gb_per_s(r, read + written, cycles), 2)},
        style);
  };
  for (std::size_t s = 0; s < r.stages.size(); ++s) {
    const StageRecord& stage = r.stages[s];
    row("<i class=\"" + stage_class(s) + "\"></i>" + escaped_html(stage.name), cycles_of(stage),
        read_bytes(stage), write_bytes(stage), nullptr);
  }
  row("all", r.cycles, read_bytes(r), write_bytes(r), "sum");
  return table.finish();
}

void unit_row(const UnitRecord& unit, const Activity& activity, HtmlTable& table) {
  const auto all = static_cast<double>(cycles_of(activity));
  std::string on;
  for (const Wait& wait : waits(unit, activity)) {
    on += (on.empty() ? "" : ", ") + escaped_html(wait.on) + " " +
          percent(static_cast<double>(wait.cycles), all);
  }
  table.row({escaped_html(unit.name), percent(static_cast<double>(activity.busy_cycles), all),
             percent(static_cast<double>(activity.stalled()), all),
             percent(static_cast<double>(activity.idle_cycles), all),
             "<td class=\"words\">" + on + "</td>"});
}

std::string unit_tables(const SimulationResult& r) {
  const std::vector<std::string> header = {"unit", "busy", "stalled", "idle",
                                           "<th class=\"words\">stalled on</th>"};
  HtmlTable whole(header);
  for (const UnitRecord& unit : r.units) unit_row(unit, whole_run(unit), whole);
  std::string text = whole.finish();
  for (std::size_t s = 0; s < r.stages.size(); ++s) {
    HtmlTable table(header);
    for (const UnitRecord& unit : r.units) {
      const Activity& activity = unit.by_stage[s];
      if (activity.idle_cycles != cycles_of(activity)) unit_row(unit, activity, table);
    }
    text += "<details><summary>in stage " + escaped_html(r.stages[s].name) + "</summary>\n" +
            table.finish() + "</details>\n";
  }
  return text;
}

std::string traffic_table(const SimulationResult& r) {
  HtmlTable table(
      {"stage", "<th class=\"words\">purpose</th>", "bytes read", "bytes written", "a triangle"});
  const auto row = [&](const std::string& stage, const std::string& purpose, std::uint64_t read,
                       std::uint64_t written, const char* style) {
    table.row({stage, "<td class=\"name\">" + purpose + "</td>", grouped(read), grouped(written),
               a_triangle(static_cast<double>(read + written), r, 1)},
              style);
  };
  for (const StageRecord& stage : r.stages) {
    for (const Traffic& t : stage.traffic) {
      row(escaped_html(stage.name), escaped_html(t.purpose), t.read_bytes, t.write_bytes, nullptr);
    }
  }
  row("all", "", read_bytes(r), write_bytes(r), "sum");
  return table.finish();
}

std::string memory_table(const SimulationReport& report) {
  const SimulationResult& r = report.result;
  const MemoryStatistics& m = r.memory;
  HtmlTable table({"", "reads", "writes"});
  table.row({"accesses", grouped(m.reads), grouped(m.writes)});
  table.row({"bytes", grouped(m.read_bytes), grouped(m.write_bytes)});
  const CacheStatistics& c = r.mark_cache;
  if (c.reads + c.writes > 0) {
    table.row({"mark cache, accesses", grouped(c.reads), grouped(c.writes)});
    table.row({"mark cache, hits",
               percent(static_cast<double>(c.read_hits), static_cast<double>(c.reads)),
               percent(static_cast<double>(c.write_hits), static_cast<double>(c.writes))});
    table.row({"mark cache, blocks written back", "", grouped(c.write_backs)});
  }
  std::string text = table.finish();
  if (row_hit_share(m)) {
    text += "<p>Rows: " + grouped(m.row_hits) + " hits, " + grouped(m.row_misses) +
            " misses (bank closed), " + grouped(m.row_conflicts) +
            " conflicts (another row open); " + grouped(m.refreshes) + " refreshes, " +
            grouped(m.turnarounds) + " turnarounds.</p>\n";
  }
  return text;
}

std::string latency_section(const MemoryStatistics& m) {
  const std::string plot = latency_plot(m);
  if (plot.empty()) return "";
  const auto bound = [&](double share) {
    const std::optional<double> ns = read_latency_percentile_ns(m, share);
    return ns ? fixed(*ns, 0) + " ns" : std::string("more than the histogram shows");
  };
  return "<h2>Reads by latency, ns</h2>\n" + plot + "<p class=\"soft\">" +
         fixed(mean_read_latency_ns(m), 1) + " ns on average, half within " + bound(0.5) +
         ", 99 % within " + bound(0.99) + ", from acceptance to data.</p>\n";
}

std::string cost_section(const CostTable& costs) {
  std::vector<std::string> header = {"unit"};
  for (const CostTable::Column& column : costs.columns) {
    header.push_back(escaped_html(column.title));
  }
  HtmlTable table(header);
  std::vector<std::string> sum = {"all"};
  for (const CostTable::Row& row : costs.rows) {
    std::vector<std::string> cells = {escaped_html(row.unit)};
    for (std::size_t c = 0; c < costs.columns.size(); ++c) {
      cells.push_back(fixed(row.values[c], costs.columns[c].digits));
    }
    table.row(cells);
  }
  for (std::size_t c = 0; c < costs.columns.size(); ++c) {
    sum.push_back(fixed(costs.total(c), costs.columns[c].digits));
  }
  table.row(sum, "sum");
  std::string figures;
  for (const CostTable::Figure& figure : costs.figures) {
    figures += (figures.empty() ? "<p>" : "; ") + escaped_html(figure.title) + ": " +
               fixed(figure.value, figure.digits);
  }
  if (!figures.empty()) figures += ".</p>\n";
  return "<h2>" + escaped_html(costs.title) + "</h2>\n" + table.finish() + figures +
         "<p class=\"soft\">" + escaped_html(costs.basis) + "</p>\n";
}

}  // namespace

std::string html_report(const SimulationReport& report) {
  const SimulationResult& r = report.result;
  const TreeInfo& info = r.tree.info();
  const std::string title = escaped_html(report.scene + " on " + r.config);
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
      title + "</title>\n<style>" + kHtmlStyle + "</style>\n</head>\n<body>\n";
  page += "<h1>" + title + "</h1>\n<p class=\"soft\">" + grouped(r.triangles) + " triangles; " +
          fixed(r.clock_mhz, 0) + " MHz, " + escaped_html(r.memory_traits.name) + "; " +
          to_string(info.axes) + " axes, depth " + std::to_string(info.depth) + ", " +
          grouped(r.references) + " references, " + grouped(r.leaves) + " leaves; tree <code>" +
          hash_string(r.tree.hash()) + "</code></p>\n";
  page += check_line(report) + tiles(report);
  page += "<h2>Stages, over time in ms</h2>\n" + stage_bar(r) + stage_table(r);
  if (!r.timeline.empty()) {
    page += "<h2>Units over time</h2>\n" + occupancy_plot(r);
    page += "<h2>Bandwidth over time, GB/s over ms</h2>\n" + bandwidth_plot(report);
  }
  page += "<h2>Units</h2>\n" + unit_tables(r);
  page += "<h2>Bytes over the bus</h2>\n" + traffic_table(r);
  page += "<h2>Memory</h2>\n" + memory_table(report) + latency_section(r.memory);
  for (const CostTable& costs : report.costs) page += cost_section(costs);
  page += "<h2>Configuration</h2>\n<details><summary>" + escaped_html(r.config) +
          ", every key</summary>\n<pre>" + escaped_html(to_toml(report.config)) +
          "</pre></details>\n";
  page += "<p class=\"soft\">Simulated in " + fixed(report.wall_s, 2) + " s, " +
          fixed(report.wall_s > 0 ? static_cast<double>(r.cycles) / report.wall_s / 1e6 : 0, 2) +
          " million cycles a second.</p>\n</body>\n</html>\n";
  return page;
}

}  // namespace fasttree::model
