// SPDX-License-Identifier: Apache-2.0
#include "scene/formats/text_scanner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>

namespace fasttree::scene {
namespace {

// "line:word word|line:word ..."
std::string rows_of(std::string_view text, TextScanner::Options options = {}) {
  TextScanner scanner(text, options);
  std::ostringstream out;
  for (bool first = true; scanner.next_row(); first = false) {
    out << (first ? "" : "|") << scanner.line() << ':';
    std::string_view word;
    for (bool first_word = true; scanner.word(word); first_word = false) {
      out << (first_word ? "" : " ") << word;
    }
  }
  return out.str();
}

TEST(TextScanner, EndsLinesInLfCrLfOrCr) {
  EXPECT_EQ(rows_of("a b\nc\n\n d "), "1:a b|2:c|4:d");
  EXPECT_EQ(rows_of("a b\r\nc\r\n\r\n d "), "1:a b|2:c|4:d");
  EXPECT_EQ(rows_of("a b\rc\r\r d "), "1:a b|2:c|4:d");
  EXPECT_EQ(rows_of(""), "");
  EXPECT_EQ(rows_of(" \n\t\n"), "");
}

TEST(TextScanner, SkipsAByteOrderMark) {
  EXPECT_EQ(rows_of("\xef\xbb\xbfv 1"), "1:v 1");
}

TEST(TextScanner, JoinsLinesAndDropsComments) {
  TextScanner::Options options;
  options.backslash_joins_lines = true;
  options.comment = '#';
  EXPECT_EQ(rows_of("a \\\nb\\\r\n c # d \\\ne\n#f\ng\\h", options), "1:a b c|4:e|6:g\\h");
  EXPECT_EQ(rows_of("a\\", options), "1:a\\");
  EXPECT_EQ(rows_of("\\\n\\\na", options), "3:a");
}

TEST(TextScanner, SkipsTheRestOfARowWithItsJoinedLines) {
  TextScanner::Options options;
  options.backslash_joins_lines = true;
  options.comment = '#';
  TextScanner scanner("a b \\\n c\\\r\n d\ne # \\\nf\n", options);
  std::string_view word;
  ASSERT_TRUE(scanner.next_row());
  ASSERT_TRUE(scanner.word(word));
  ASSERT_TRUE(scanner.next_row());
  ASSERT_TRUE(scanner.word(word));
  EXPECT_EQ(word, "e");
  EXPECT_EQ(scanner.line(), 4u);
  ASSERT_TRUE(scanner.next_row());
  ASSERT_TRUE(scanner.word(word));
  EXPECT_EQ(word, "f");
  EXPECT_EQ(scanner.line(), 5u);
  EXPECT_FALSE(scanner.next_row());
}

TEST(ParseFloat, TakesWholeWordsOnly) {
  float x = 0;
  EXPECT_TRUE(parse_float("+1.5e1", x));
  EXPECT_EQ(x, 15.0f);
  EXPECT_TRUE(parse_float("-.25", x));
  EXPECT_EQ(x, -0.25f);
  EXPECT_TRUE(parse_float("nan", x));
  EXPECT_TRUE(std::isnan(x));
  EXPECT_TRUE(parse_float("-inf", x));
  EXPECT_EQ(x, -INFINITY);
  EXPECT_TRUE(parse_float("1e99", x));
  EXPECT_EQ(x, INFINITY);
  EXPECT_TRUE(parse_float("1e-99", x));
  EXPECT_EQ(x, 0.0f);
  for (const char* bad : {"", "+", "-", "1,5", "1.5f", "0x10", "+-1", "1 ", "e5", "--1"}) {
    EXPECT_FALSE(parse_float(bad, x)) << bad;
  }
}

TEST(ParseInteger, TakesWholeWordsOnly) {
  std::int64_t i = 0;
  EXPECT_TRUE(parse_integer("-9223372036854775808", i));
  EXPECT_EQ(i, INT64_MIN);
  EXPECT_TRUE(parse_integer("+7", i));
  EXPECT_EQ(i, 7);
  for (const char* bad : {"", "+", "+-1", "1.0", "9223372036854775808", "7a", " 7"}) {
    EXPECT_FALSE(parse_integer(bad, i)) << bad;
  }
}

}  // namespace
}  // namespace fasttree::scene
