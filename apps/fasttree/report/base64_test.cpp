// SPDX-License-Identifier: Apache-2.0
#include "report/base64.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

namespace fasttree::report {
namespace {

std::string of(const std::string& text) {
  return base64(std::as_bytes(std::span(text.data(), text.size())));
}

TEST(Base64, TheStandardsOwnExamples) {
  EXPECT_EQ(of(""), "");
  EXPECT_EQ(of("f"), "Zg==");
  EXPECT_EQ(of("fo"), "Zm8=");
  EXPECT_EQ(of("foo"), "Zm9v");
  EXPECT_EQ(of("foob"), "Zm9vYg==");
  EXPECT_EQ(of("fooba"), "Zm9vYmE=");
  EXPECT_EQ(of("foobar"), "Zm9vYmFy");
}

/// Backwards, by another way: digit by digit.
std::vector<std::uint8_t> decoded(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes.push_back(static_cast<std::uint8_t>(bits >> count));
    }
  }
  return bytes;
}

RC_GTEST_PROP(Base64, ThereAndBack, (const std::vector<std::uint8_t>& bytes)) {
  const std::string text = base64(std::as_bytes(std::span(bytes)));
  RC_ASSERT(text.size() == (bytes.size() + 2) / 3 * 4);
  RC_ASSERT(decoded(text) == bytes);
}

TEST(Base64, APictureIsADataUri) {
  const std::vector<std::byte> bytes(3);
  EXPECT_EQ(png_uri(bytes), "data:image/png;base64,AAAA");
}

}  // namespace
}  // namespace fasttree::report
