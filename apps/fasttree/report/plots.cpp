// SPDX-License-Identifier: Apache-2.0
#include "report/plots.h"

#include <algorithm>
#include <cmath>

#include "model/report/html_plots.h"
#include "model/report/text.h"
#include "report/html.h"

namespace fasttree::report {
namespace {

using model::escaped_html;
using model::fixed;

// Pictures are drawn on this square and stretched.
constexpr double kSide = 1000;

std::string strip(const std::string& label, const std::string& body) {
  return "<svg class=\"strip\" viewBox=\"0 0 1000 1000\" preserveAspectRatio=\"none\" role=\"img\" "
         "aria-label=\"" +
         escaped_html(label) + "\">" + body + "</svg>";
}

std::string rectangle(const std::string& style, double x, double width, double y, double height,
                      const std::string& title) {
  return "<rect class=\"" + style + "\" x=\"" + fixed(x, 1) + "\" y=\"" + fixed(y, 0) +
         "\" width=\"" + fixed(width, 1) + "\" height=\"" + fixed(height, 0) + "\"><title>" +
         escaped_html(title) + "</title></rect>";
}

double length_of(const Bar& bar) {
  double sum = 0;
  for (const BarPart& part : bar.parts) sum += part.value;
  return sum;
}

double longest(const BarGroup& group) {
  double most = 0;
  for (const Bar& bar : group.bars) most = std::max(most, length_of(bar));
  return most;
}

std::string row_of(const Bar& bar, double most, const std::vector<std::string>& legend,
                   const std::string& unit) {
  std::string body, words;
  double begin = 0;
  for (const BarPart& part : bar.parts) {
    const double width = most > 0 ? part.value / most * kSide : 0;
    const std::string what =
        legend[part.colour] + " " + fixed(part.value, 2) + (unit.empty() ? "" : " " + unit);
    body += rectangle(model::stage_class(part.colour), begin, width, 0, kSide, what);
    words += (words.empty() ? "" : ", ") + what;
    begin += width;
  }
  return std::string("<div class=\"bar\"") + (bar.measured ? std::string(" ") + kMeasured : "") +
         "><span>" + escaped_html(bar.label) + "</span>" + strip(bar.label + ": " + words, body) +
         "<span>" + escaped_html(bar.text) + "</span></div>\n";
}

std::string signed_percent(double percent) {
  return (percent >= 0 ? "+" : "") + fixed(percent, 1) + " %";
}

}  // namespace

std::string stacked_bars(const std::vector<std::string>& legend, const std::string& unit,
                         const std::vector<BarGroup>& groups, bool one_scale) {
  double most_of_all = 0;
  for (const BarGroup& group : groups) most_of_all = std::max(most_of_all, longest(group));
  std::string text = "<p class=\"keys\">";
  for (std::size_t i = 0; i < legend.size(); ++i) {
    if (legend[i].empty()) continue;
    text += "<span class=\"key\"><i class=\"" + model::stage_class(i) + "\"></i>" +
            escaped_html(legend[i]) + "</span>";
  }
  text += "</p>\n<div class=\"bars\">\n";
  for (const BarGroup& group : groups) {
    if (!group.title.empty()) {
      text += "<p class=\"group\">" + escaped_html(group.title) + "</p>\n";
    }
    const double most = one_scale ? most_of_all : longest(group);
    for (const Bar& bar : group.bars) text += row_of(bar, most, legend, unit);
  }
  return text + "</div>\n";
}

std::string tornado(const std::string& what, const std::vector<TornadoRow>& rows) {
  double most = 0;
  for (const TornadoRow& row : rows) {
    for (const TornadoBar& bar : row.bars) most = std::max(most, std::abs(bar.percent));
  }
  std::string text = "<div class=\"bars tornado\">\n";
  for (const TornadoRow& row : rows) {
    std::string body = "<path class=\"middle\" d=\"M500 0V1000\"/>";
    std::string words;
    const double height = kSide / static_cast<double>(row.bars.size());
    for (std::size_t i = 0; i < row.bars.size(); ++i) {
      const TornadoBar& bar = row.bars[i];
      const double width = most > 0 ? std::abs(bar.percent) / most * kSide / 2 : 0;
      const std::string effect = bar.value + ": " + signed_percent(bar.percent);
      body += rectangle(bar.percent < 0 ? "less" : "more",
                        bar.percent < 0 ? kSide / 2 - width : kSide / 2, width,
                        height * (static_cast<double>(i) + 0.1), 0.8 * height, effect);
      words += (words.empty() ? "" : ", ") + effect;
    }
    text += "<div class=\"bar\"><span>" + escaped_html(row.label) + "</span>" +
            strip(row.label + ", " + what + ": " + words, body) + "<span>" + escaped_html(words) +
            "</span></div>\n";
  }
  return text + "</div>\n";
}

}  // namespace fasttree::report
