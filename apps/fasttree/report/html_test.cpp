// SPDX-License-Identifier: Apache-2.0
#include "report/html.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

namespace fasttree::report {
namespace {

const char* const kNasty = "<script>\"&'</script>";

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

TEST(Html, NothingThatIsPutInBecomesATag) {
  HtmlTable table(kNasty, {kNasty, kNasty});
  table.row({kNasty, kNasty});
  const std::string page =
      html_page(kNasty, "",
                {{"a", kNasty,
                  table.html() + figure("", kNasty) + tiles({{kNasty, kNasty}}) +
                      picture("data:image/png;base64,", kNasty, 1, 1)}});
  EXPECT_EQ(count(page, "<script"), 0u);
  EXPECT_EQ(count(page, ">\"&"), 0u) << "an attribute would end there";
  EXPECT_GE(count(page, "&lt;script&gt;&quot;&amp;'&lt;/script&gt;"), 10u);
}

TEST(Html, EveryHeaderCellSaysWhatItHeads) {
  const std::string table =
      html_table("c", {{"name", "x", "y"}, {"first", "1", "2"}, {"second", "3", "4"}}, {2});
  EXPECT_EQ(count(table, "<th scope=\"col\""), 3u);
  EXPECT_EQ(count(table, "<th scope=\"row\""), 2u);
  EXPECT_EQ(count(table, "<th"), count(table, "scope=") + count(table, "<thead"));
  EXPECT_EQ(count(table, "<td"), 4u);
  EXPECT_EQ(count(table, " class=\"words\""), 3u);
  EXPECT_EQ(count(table, "<caption>c</caption>"), 1u);
}

TEST(Html, MeasuredRowsAreLinesOfTheirOwn) {
  const std::string table =
      html_table("c", {{"name", "ms"}, {"model", "1"}, {"machine", "2"}}, {}, {false, true});
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_EQ(line.find("machine") != std::string::npos, line.find(kMeasured) != std::string::npos)
        << line;
  }
}

TEST(Html, ContentsLeadToEverySection) {
  const std::string page = html_page("t", "<p>lead</p>", {{"one", "One", ""}, {"two", "Two", ""}});
  for (const char* id : {"one", "two"}) {
    EXPECT_EQ(count(page, std::string("href=\"#") + id + "\""), 1u);
    EXPECT_EQ(count(page, std::string("<section id=\"") + id + "\""), 1u);
  }
}

TEST(Html, APageLoadsNothing) {
  const std::string page = html_page("t", "", {});
  EXPECT_EQ(count(page, "default-src 'none'"), 1u);
  for (const char* loads : {"<script", "<link", "@import", "url(", "http:", "https:"}) {
    EXPECT_EQ(count(page, loads), 0u) << loads;
  }
}

}  // namespace
}  // namespace fasttree::report
