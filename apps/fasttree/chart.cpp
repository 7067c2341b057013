// SPDX-License-Identifier: Apache-2.0
#include "chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>

#include "model/report/text.h"

namespace fasttree::app {
namespace {

// Colours that stay apart for the colour-blind (Okabe and Ito).
constexpr std::array kColours = {"#0072b2", "#56b4e9", "#e69f00", "#d55e00",
                                 "#999999", "#009e73", "#cc79a7"};

}  // namespace

std::string bar_chart_svg(const std::string& title, const std::vector<ChartPanel>& panels) {
  constexpr int kWidth = 760;
  constexpr int kLabels = 150;
  constexpr int kLongest = 470;
  constexpr int kBar = 20;
  constexpr int kStep = 26;
  std::string body;
  int y = 34;
  body += fmt::format("<text x=\"16\" y=\"{}\" font-size=\"18\" font-weight=\"bold\">{}</text>\n",
                      y, model::escaped_html(title));
  for (const ChartPanel& panel : panels) {
    y += 36;
    body += fmt::format("<text x=\"16\" y=\"{}\" font-weight=\"bold\">{}</text>\n", y,
                        model::escaped_html(panel.title));
    y += 10;
    double most = 0;
    for (const auto& bar : panel.bars) most = std::max(most, bar.value);
    for (std::size_t i = 0; i < panel.bars.size(); ++i) {
      const auto& bar = panel.bars[i];
      const double length = most > 0 ? std::max(1.0, bar.value / most * kLongest) : 1.0;
      body += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>\n", kLabels - 8,
                          y + 15, model::escaped_html(bar.label));
      body += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{:.1f}\" height=\"{}\" fill=\"{}\"/>\n",
                          kLabels, y, length, kBar, kColours[i % kColours.size()]);
      body += fmt::format("<text x=\"{:.1f}\" y=\"{}\">{}</text>\n", kLabels + length + 6, y + 15,
                          model::escaped_html(bar.text));
      y += kStep;
    }
  }
  y += 10;
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
             "viewBox=\"0 0 {0} {1}\" font-family=\"sans-serif\" font-size=\"14\" "
             "fill=\"#222222\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n",
             kWidth, y) +
         body + "</svg>\n";
}

}  // namespace fasttree::app
