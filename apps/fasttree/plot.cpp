// SPDX-License-Identifier: Apache-2.0
#include "plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "model/report/text.h"

namespace fasttree::app {
namespace {

// Colours that stay apart for the colour-blind (Okabe and Ito), and dashes for who sees none.
constexpr std::array kColours = {"#0072b2", "#d55e00", "#555555", "#009e73"};
constexpr std::array kDashes = {"", " stroke-dasharray=\"7 3\"", " stroke-dasharray=\"2 3\"",
                                " stroke-dasharray=\"9 3 2 3\""};

/// A step of 1, 2 or 5 times a power of ten, so that `most` is reached in at most `steps`.
double tick_step(double most, int steps) {
  const double least = most / steps;
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (least <= factor * power * (1 + 1e-9)) return factor * power;
  }
  return 10 * power;
}

}  // namespace

std::string line_plot_svg(const std::string& title, const std::string& x_label,
                          const std::string& y_label, const std::vector<PlotLine>& lines) {
  constexpr double kWidth = 760, kHeight = 420;
  constexpr double kLeft = 64, kRight = 740, kTop = 84, kFoot = 366;
  double most = 0;
  std::size_t count = 0;
  for (const PlotLine& line : lines) {
    count = std::max(count, line.values.size());
    for (const double value : line.values) most = std::max(most, value);
  }
  if (!(most > 0)) most = 1;
  const double step = tick_step(most, 6);
  const double top = step * std::ceil(most / step * (1 - 1e-9));
  const double last = count > 1 ? static_cast<double>(count - 1) : 1.0;
  const auto x_of = [&](double x) { return kLeft + x / last * (kRight - kLeft); };
  const auto y_of = [&](double y) { return kFoot - y / top * (kFoot - kTop); };

  std::string body =
      fmt::format("<text x=\"16\" y=\"34\" font-size=\"18\" font-weight=\"bold\">{}</text>\n",
                  model::escaped_html(title));
  for (int i = 0; i * step <= top * (1 + 1e-9); ++i) {
    const double y = y_of(i * step);
    body += fmt::format(
        "<path d=\"M{:.1f} {:.1f}H{:.1f}\" stroke=\"#dddddd\"/>\n"
        "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{:g}</text>\n",
        kLeft, y, kRight, kLeft - 8, y + 5, i * step);
  }
  const double x_step = std::max(1.0, tick_step(last, 12));
  for (int i = 0; i * x_step <= static_cast<double>(std::max<std::size_t>(count, 1) - 1); ++i) {
    const double x = x_of(i * x_step);
    body += fmt::format(
        "<path d=\"M{0:.1f} {1:.1f}v5\" stroke=\"#222222\"/>\n"
        "<text x=\"{0:.1f}\" y=\"{2:.1f}\" text-anchor=\"middle\">{3:g}</text>\n",
        x, kFoot, kFoot + 20, i * x_step);
  }
  body += fmt::format("<path d=\"M{0} {1}V{2}H{3}\" fill=\"none\" stroke=\"#222222\"/>\n", kLeft,
                      kTop, kFoot, kRight);
  body += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                      (kLeft + kRight) / 2, kHeight - 12, model::escaped_html(x_label));
  body += fmt::format(
      "<text transform=\"translate(20 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
      (kTop + kFoot) / 2, model::escaped_html(y_label));

  double legend = kLeft;
  for (std::size_t l = 0; l < lines.size(); ++l) {
    const char* colour = kColours[l % kColours.size()];
    const char* dash = kDashes[l % kDashes.size()];
    std::string points;
    for (std::size_t i = 0; i < lines[l].values.size(); ++i) {
      points += fmt::format("{}{:.1f},{:.1f}", i > 0 ? " " : "", x_of(static_cast<double>(i)),
                            y_of(lines[l].values[i]));
    }
    body +=
        fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"{}/>\n",
                    points, colour, dash);
    // One frame makes no line.
    if (lines[l].values.size() == 1) {
      body += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", x_of(0),
                          y_of(lines[l].values[0]), colour);
    }
    body += fmt::format(
        "<path d=\"M{:.0f} 58h26\" stroke=\"{}\" stroke-width=\"2\"{}/>\n"
        "<text x=\"{:.0f}\" y=\"63\">{}</text>\n",
        legend, colour, dash, legend + 32, model::escaped_html(lines[l].label));
    legend += 56 + 8.0 * static_cast<double>(lines[l].label.size());
  }
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
             "viewBox=\"0 0 {0:.0f} {1:.0f}\" font-family=\"sans-serif\" font-size=\"14\" "
             "fill=\"#222222\">\n<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"#ffffff\"/>\n",
             kWidth, kHeight) +
         body + "</svg>\n";
}

}  // namespace fasttree::app
