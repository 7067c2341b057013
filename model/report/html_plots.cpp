// SPDX-License-Identifier: Apache-2.0
#include "model/report/html_plots.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>

#include "model/report/account.h"
#include "model/report/text.h"

namespace fasttree::model {
namespace {

// Pictures are drawn on this square and stretched.
constexpr double kSide = 1000;
// More columns than a wide screen shows apart only make the page larger.
constexpr std::size_t kColumns = 400;
constexpr std::size_t kStageClasses = 8;

std::string svg(const std::string& style, const std::string& label, const std::string& body) {
  return "<svg class=\"" + style +
         "\" viewBox=\"0 0 1000 1000\" preserveAspectRatio=\"none\" role=\"img\" aria-label=\"" +
         escaped_html(label) + "\">" + body + "</svg>\n";
}

/// A coordinate on the square, with as few characters as it needs.
std::string coordinate(double part) {
  std::string text = fixed(std::clamp(part, 0.0, 1.0) * kSide, 1);
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text;
}

double part_of(std::uint64_t cycle, const SimulationResult& result) {
  return result.cycles > 0 ? static_cast<double>(cycle) / static_cast<double>(result.cycles) : 0;
}

/// The timeline with at most kColumns samples: neighbours are added up.
std::vector<TimelineSample> columns(const std::vector<TimelineSample>& timeline) {
  const std::size_t group = (timeline.size() + kColumns - 1) / kColumns;
  std::vector<TimelineSample> merged;
  for (std::size_t i = 0; i < timeline.size(); ++i) {
    const TimelineSample& sample = timeline[i];
    if (i % group == 0) {
      merged.push_back(sample);
      continue;
    }
    TimelineSample& sum = merged.back();
    sum.cycles += sample.cycles;
    sum.bus_bytes += sample.bus_bytes;
    for (std::size_t u = 0; u < sample.busy_cycles.size(); ++u) {
      sum.busy_cycles[u] += sample.busy_cycles[u];
      sum.stalled_cycles[u] += sample.stalled_cycles[u];
    }
  }
  return merged;
}

/// The area under a line with a step a sample, `height` of each from 0 to 1.
std::string steps(const SimulationResult& result, const std::vector<TimelineSample>& samples,
                  const char* style, const std::function<double(const TimelineSample&)>& height) {
  std::string path = "M0 1000";
  std::string last = "1000";
  std::string x;
  for (const TimelineSample& sample : samples) {
    const std::string y = coordinate(1 - height(sample));
    if (y != last) path += (x.empty() ? "" : "H" + x) + "V" + y;
    last = y;
    x = coordinate(part_of(sample.begin_cycle + sample.cycles, result));
  }
  path += "H" + (x.empty() ? "0" : x) + "V1000Z";
  return "<path class=\"" + std::string(style) + "\" d=\"" + path + "\"/>";
}

/// Where one stage ends and the next begins.
std::string stage_lines(const SimulationResult& result) {
  std::string path;
  for (std::size_t s = 1; s < result.stages.size(); ++s) {
    path += "M" + coordinate(part_of(result.stages[s].begin_cycle, result)) + " 0V1000";
  }
  return "<path class=\"border\" d=\"" + path + "\"/>";
}

/// A step of 1, 2 or 5 times a power of ten, so that `most` is reached in at most `count`.
double tick_step(double most, int count) {
  if (!(most > 0)) return 1;
  const double power = std::pow(10.0, std::floor(std::log10(most / count)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (most / count <= factor * power * (1 + 1e-9)) return factor * power;
  }
  return 10 * power;
}

/// Labels near the right end stay inside.
std::string axis_label(double part, const std::string& text) {
  return "<span" + std::string(part > 0.95 ? " class=\"end\"" : "") +
         " style=\"left:" + fixed(100 * part, 2) + "%\">" + text + "</span>";
}

/// Labels under a plot, in milliseconds of the machine.
std::string time_axis(const SimulationResult& result) {
  const double most = result.time_ms();
  const double step = tick_step(most, 5);
  const int digits = std::max(0, static_cast<int>(-std::floor(std::log10(step))));
  std::string text = "<div class=\"axis\">";
  for (int i = 0; i * step <= most * (1 + 1e-9) && most > 0; ++i) {
    text += axis_label(i * step / most, fixed(i * step, digits));
  }
  return text + "</div>\n";
}

std::string key(const char* style, const std::string& text) {
  return "<span class=\"key\"><i class=\"" + std::string(style) + "\"></i>" + escaped_html(text) +
         "</span>";
}

}  // namespace

std::string stage_class(std::size_t stage) {
  return "s" + std::to_string(stage % kStageClasses);
}

std::string stage_bar(const SimulationResult& result) {
  std::string body;
  for (std::size_t s = 0; s < result.stages.size(); ++s) {
    const StageRecord& stage = result.stages[s];
    const double begin = part_of(stage.begin_cycle, result);
    body += "<rect class=\"" + stage_class(s) + "\" x=\"" + coordinate(begin) +
            "\" y=\"0\" width=\"" + coordinate(part_of(stage.end_cycle, result) - begin) +
            "\" height=\"1000\"><title>" + escaped_html(stage.name) + ": " +
            grouped(cycles_of(stage)) + " cycles, " +
            percent(static_cast<double>(cycles_of(stage)), static_cast<double>(result.cycles)) +
            "</title></rect>";
  }
  return "<div class=\"plot\">" + svg("bar", "Stages over time", body) + time_axis(result) +
         "</div>\n";
}

std::string occupancy_plot(const SimulationResult& result) {
  const std::vector<TimelineSample> samples = columns(result.timeline);
  const std::string lines = stage_lines(result);
  std::string text = "<p class=\"keys\">" + key("busy", "busy") + key("stalled", "stalled") +
                     "</p>\n<div class=\"rows\">\n";
  for (std::size_t u = 0; u < result.units.size(); ++u) {
    const UnitRecord& unit = result.units[u];
    const auto share = [](std::uint64_t cycles, const TimelineSample& sample) {
      return sample.cycles > 0 ? static_cast<double>(cycles) / sample.cycles : 0;
    };
    const std::string body =
        steps(result, samples, "stalled",
              [&](const TimelineSample& s) {
                return share(std::uint64_t{s.busy_cycles[u]} + s.stalled_cycles[u], s);
              }) +
        steps(result, samples, "busy",
              [&](const TimelineSample& s) { return share(s.busy_cycles[u], s); }) +
        lines;
    const Activity sum = whole_run(unit);
    text += "<span>" + escaped_html(unit.name) + "</span>" +
            svg("strip", unit.name + ": busy and stalled over time", body) + "<span>" +
            percent(static_cast<double>(sum.busy_cycles), static_cast<double>(result.cycles)) +
            "</span>\n";
  }
  return text + "<span>ms</span>" + time_axis(result) + "<span>busy</span>\n</div>\n";
}

std::string bandwidth_plot(const SimulationReport& report) {
  const SimulationResult& result = report.result;
  const std::vector<TimelineSample> samples = columns(result.timeline);
  const double memory_peak = result.memory_traits.peak_gb_s;
  const std::optional<double> bus_peak = bus_peak_gb_s(report.config);
  double most = std::max(memory_peak, bus_peak.value_or(0));
  for (const TimelineSample& s : samples) {
    most = std::max(most, gb_per_s(result, s.bus_bytes, s.cycles));
  }
  const double step = tick_step(most, 5);
  const double top = step * std::max(1.0, std::ceil(most / step * (1 - 1e-9)));
  const int digits = std::max(0, static_cast<int>(-std::floor(std::log10(step))));

  std::string grid, labels;
  for (int i = 0; i * step <= top * (1 + 1e-9); ++i) {
    const double part = 1 - i * step / top;
    grid += "M0 " + coordinate(part) + "H1000";
    labels +=
        "<span style=\"top:" + fixed(100 * part, 2) + "%\">" + fixed(i * step, digits) + "</span>";
  }
  std::string body = "<path class=\"grid\" d=\"" + grid + "\"/>" +
                     steps(result, samples, "bandwidth",
                           [&](const TimelineSample& s) {
                             return gb_per_s(result, s.bus_bytes, s.cycles) / top;
                           }) +
                     stage_lines(result);
  const auto level = [&](const char* style, double value) {
    body += "<path class=\"" + std::string(style) + "\" d=\"M0 " + coordinate(1 - value / top) +
            "H1000\"/>";
  };
  std::string keys = key("bandwidth", "over the bus");
  if (memory_peak > 0) {
    level("memorypeak", memory_peak);
    keys += key("memorypeak", "memory's peak, " + fixed(memory_peak, 1) + " GB/s");
  }
  if (bus_peak) {
    level("buspeak", *bus_peak);
    keys += key("buspeak", "bus's peak, " + fixed(*bus_peak, 1) + " GB/s");
  }
  return "<p class=\"keys\">" + keys + "</p>\n<div class=\"chart\"><div class=\"scale\">" + labels +
         "</div><div class=\"plot\">" + svg("area", "Bandwidth over time, GB/s", body) +
         time_axis(result) + "</div></div>\n";
}

std::string latency_plot(const MemoryStatistics& memory) {
  const std::vector<std::uint64_t>& buckets = memory.read_latency_8ns;
  const std::uint64_t most =
      buckets.empty() ? 0 : *std::max_element(buckets.begin(), buckets.end());
  if (most == 0) return "";
  std::size_t count = buckets.size();
  while (buckets[count - 1] == 0) --count;
  const double width = 1.0 / static_cast<double>(count);
  std::string body;
  for (std::size_t i = 0; i < count; ++i) {
    if (buckets[i] == 0) continue;
    // Something is to be seen of each read there is.
    const double height =
        std::max(0.005, static_cast<double>(buckets[i]) / static_cast<double>(most));
    body += "<rect class=\"busy\" x=\"" + coordinate(static_cast<double>(i) * width) + "\" y=\"" +
            coordinate(1 - height) + "\" width=\"" + coordinate(0.9 * width) + "\" height=\"" +
            coordinate(height) + "\"><title>" + std::to_string(8 * i) +
            (i + 1 < buckets.size() ? " to " + std::to_string(8 * i + 8) : " and more") +
            " ns: " + grouped(buckets[i]) + " reads</title></rect>";
  }
  std::string axis = "<div class=\"axis\">";
  const double end = 8.0 * static_cast<double>(count);
  const double step = std::max(8.0, tick_step(end, 6));
  for (int i = 0; i * step <= end; ++i) {
    axis += axis_label(i * step / end, fixed(i * step, 0));
  }
  return "<div class=\"plot\">" + svg("area", "Reads by latency", body) + axis + "</div></div>\n";
}

}  // namespace fasttree::model
