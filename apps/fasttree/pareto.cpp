// SPDX-License-Identifier: Apache-2.0
#include "pareto.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "model/report/text.h"

namespace fasttree::app {
namespace {

constexpr double kPanelWidth = 560, kPanelHeight = 420;
constexpr double kLeft = 70, kRight = 530, kTop = 90, kFoot = 370;
/// Of so many points and more, labels would lie on each other.
constexpr std::size_t kMostLabels = 24;
constexpr std::size_t kMostLegend = 60;

/// An axis round the values, with a step of 1, 2 or 5 times a power of ten.
struct Axis {
  double from = 0, to = 1, step = 1;

  explicit Axis(const std::vector<double>& values) {
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    if (values.empty()) return;
    double span = *most - *least;
    if (!(span > 0)) span = std::max(std::abs(*most) * 0.2, 1e-9);
    const double power = std::pow(10.0, std::floor(std::log10(span / 5)));
    step = 10 * power;
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (span / 5 <= factor * power) {
        step = factor * power;
        break;
      }
    }
    from = step * std::floor((*least - 0.04 * span) / step);
    to = step * std::ceil((*most + 0.04 * span) / step);
  }
  double place(double value, double begin, double end) const {
    return begin + (value - from) / (to - from) * (end - begin);
  }
};

std::string panel_svg(const ParetoPanel& panel, const std::vector<std::string>& labels) {
  std::vector<double> xs, ys;
  for (const Costs& c : panel.costs) {
    xs.push_back(c.x);
    ys.push_back(c.y);
  }
  const Axis across(xs), up(ys);
  std::string body = fmt::format("<text x=\"{}\" y=\"76\" font-weight=\"bold\">{}</text>\n", kLeft,
                                 model::escaped_html(panel.title));
  const auto ticks = [](const Axis& axis) {
    return static_cast<int>(std::lround((axis.to - axis.from) / axis.step));
  };
  for (int i = 0; i <= ticks(up); ++i) {
    const double value = up.from + i * up.step, y = up.place(value, kFoot, kTop);
    body +=
        fmt::format("<path d=\"M{:.1f} {:.1f}H{:.1f}\" stroke=\"#dddddd\"/>\n", kLeft, y, kRight);
    body += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{:.6g}</text>\n",
                        kLeft - 8, y + 5, value);
  }
  for (int i = 0; i <= ticks(across); ++i) {
    const double value = across.from + i * across.step, x = across.place(value, kLeft, kRight);
    body += fmt::format("<path d=\"M{:.1f} {:.1f}v5\" stroke=\"#222222\"/>\n", x, kFoot);
    body += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{:.6g}</text>\n", x,
                        kFoot + 20, value);
  }
  body += fmt::format("<path d=\"M{0} {1}V{2}H{3}\" fill=\"none\" stroke=\"#222222\"/>\n", kLeft,
                      kTop, kFoot, kRight);
  body += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                      (kLeft + kRight) / 2, kPanelHeight - 8, model::escaped_html(panel.x_label));
  body += fmt::format(
      "<text transform=\"translate(18 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
      (kTop + kFoot) / 2, model::escaped_html(panel.y_label));

  const std::vector<bool> front = pareto_front(panel.costs);
  std::vector<std::size_t> on_front;
  for (std::size_t i = 0; i < front.size(); ++i) {
    if (front[i]) on_front.push_back(i);
  }
  std::sort(on_front.begin(), on_front.end(),
            [&](std::size_t a, std::size_t b) { return panel.costs[a].x < panel.costs[b].x; });
  std::string line;
  for (const std::size_t i : on_front) {
    line += fmt::format("{}{:.1f},{:.1f}", line.empty() ? "" : " ",
                        across.place(panel.costs[i].x, kLeft, kRight),
                        up.place(panel.costs[i].y, kFoot, kTop));
  }
  body += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"#d55e00\"/>\n", line);
  for (std::size_t i = 0; i < panel.costs.size(); ++i) {
    const double x = across.place(panel.costs[i].x, kLeft, kRight);
    const double y = up.place(panel.costs[i].y, kFoot, kTop);
    body += fmt::format(
        "<circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"{}\" "
        "stroke=\"{}\"><title>{}</title></circle>\n",
        front[i] ? "front" : "point", x, y, front[i] ? "#d55e00" : "#ffffff",
        front[i] ? "#d55e00" : "#0072b2", model::escaped_html(labels[i]));
    if (panel.costs.size() > kMostLabels && !front[i]) continue;
    // Labels of the right half stand to the left of their points.
    const bool left = x > (kLeft + kRight) / 2;
    body += fmt::format(
        "<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"11\" text-anchor=\"{}\">{}</text>\n",
        left ? x - 7 : x + 7, y - 5, left ? "end" : "start", i + 1);
  }
  return body;
}

}  // namespace

std::vector<bool> pareto_front(const std::vector<Costs>& costs) {
  std::vector<std::size_t> order(costs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return costs[a].x != costs[b].x ? costs[a].x < costs[b].x : costs[a].y < costs[b].y;
  });
  std::vector<bool> front(costs.size(), false);
  // From left to right: on the front is what is lower than everything before, and its equals.
  double lowest = std::numeric_limits<double>::infinity();
  double at = 0;
  for (const std::size_t i : order) {
    if (costs[i].y < lowest || (costs[i].y == lowest && costs[i].x == at)) {
      front[i] = true;
      lowest = costs[i].y;
      at = costs[i].x;
    }
  }
  return front;
}

std::string pareto_svg(const std::string& title, const std::vector<std::string>& labels,
                       const std::vector<ParetoPanel>& panels) {
  const std::size_t listed = std::min(labels.size(), kMostLegend);
  const double width = kPanelWidth * static_cast<double>(panels.size());
  const double height = kPanelHeight + 30 + 18 * static_cast<double>(listed + 1);
  std::string body =
      fmt::format("<text x=\"16\" y=\"34\" font-size=\"18\" font-weight=\"bold\">{}</text>\n",
                  model::escaped_html(title));
  for (std::size_t p = 0; p < panels.size(); ++p) {
    body += fmt::format("<g transform=\"translate({:.0f} 0)\">\n{}</g>\n",
                        kPanelWidth * static_cast<double>(p), panel_svg(panels[p], labels));
  }
  for (std::size_t i = 0; i < listed; ++i) {
    body += fmt::format("<text x=\"{}\" y=\"{:.0f}\" font-size=\"12\">{}  {}</text>\n", kLeft,
                        kPanelHeight + 30 + 18 * static_cast<double>(i), i + 1,
                        model::escaped_html(labels[i]));
  }
  if (listed < labels.size()) {
    body +=
        fmt::format("<text x=\"{}\" y=\"{:.0f}\" font-size=\"12\">and {} more</text>\n", kLeft,
                    kPanelHeight + 30 + 18 * static_cast<double>(listed), labels.size() - listed);
  }
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
             "viewBox=\"0 0 {0:.0f} {1:.0f}\" font-family=\"sans-serif\" font-size=\"14\" "
             "fill=\"#222222\">\n<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"#ffffff\"/>\n",
             width, height) +
         body + "</svg>\n";
}

}  // namespace fasttree::app
