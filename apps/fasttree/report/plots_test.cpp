// SPDX-License-Identifier: Apache-2.0
#include "report/plots.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

namespace fasttree::report {
namespace {

/// The values of an attribute of all rectangles, in order.
std::vector<double> values(const std::string& html, const std::string& attribute) {
  std::vector<double> list;
  const std::string opening = " " + attribute + "=\"";
  for (std::size_t at = html.find("<rect"); at != std::string::npos;
       at = html.find("<rect", at + 1)) {
    list.push_back(std::strtod(html.c_str() + html.find(opening, at) + opening.size(), nullptr));
  }
  return list;
}

TEST(Bars, PartsLieEndToEndAndTheLongestFillsTheWidth) {
  const BarGroup group{"g", {{"a", {{0, 1}, {1, 3}}, "4", false}, {"b", {{1, 2}}, "2", false}}};
  const std::string html = stacked_bars({"x", "y"}, "ms", {group}, true);
  EXPECT_EQ(values(html, "x"), (std::vector<double>{0, 250, 0}));
  EXPECT_EQ(values(html, "width"), (std::vector<double>{250, 750, 500}));
  EXPECT_NE(html.find("aria-label=\"a: x 1.00 ms, y 3.00 ms\""), std::string::npos) << html;
}

TEST(Bars, GroupsShareAScaleOrHaveTheirOwn) {
  const std::vector<BarGroup> groups = {{"g", {{"a", {{0, 4}}, "", false}}},
                                        {"h", {{"b", {{0, 1}}, "", false}}}};
  EXPECT_EQ(values(stacked_bars({"x"}, "", groups, true), "width"),
            (std::vector<double>{1000, 250}));
  EXPECT_EQ(values(stacked_bars({"x"}, "", groups, false), "width"),
            (std::vector<double>{1000, 1000}));
}

TEST(Bars, NothingIsAsLongAsNothing) {
  const std::string html = stacked_bars({"x"}, "", {{"", {{"a", {{0, 0}}, "", false}}}}, true);
  EXPECT_EQ(values(html, "width"), (std::vector<double>{0}));
  EXPECT_EQ(html.find("nan"), std::string::npos);
}

TEST(Tornado, LessIsToTheLeftAndMoreToTheRight) {
  const std::string html =
      tornado("time", {{"key", {{"8", 50}, {"32", -25}}}, {"other", {{"on", 10}}}});
  EXPECT_EQ(values(html, "x"), (std::vector<double>{500, 250, 500}));
  EXPECT_EQ(values(html, "width"), (std::vector<double>{500, 250, 100}));
  // Two values share the height of a row.
  EXPECT_EQ(values(html, "y"), (std::vector<double>{50, 550, 100}));
  EXPECT_NE(html.find("8: +50.0 %, 32: -25.0 %"), std::string::npos);
}

TEST(Plots, LabelsAreEscaped) {
  const std::string bars =
      stacked_bars({"<l>"}, "", {{"<t>", {{"<b>", {{0, 1}}, "<v>", false}}}}, true);
  const std::string changes = tornado("time", {{"<k>", {{"<v>", 1}}}});
  for (const char* tag : {"<l>", "<t>", "<b>", "<v>", "<k>"}) {
    EXPECT_EQ((bars + changes).find(tag), std::string::npos) << tag;
  }
}

}  // namespace
}  // namespace fasttree::report
