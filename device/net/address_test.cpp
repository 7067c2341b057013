// SPDX-License-Identifier: Apache-2.0
#include "device/net/address.h"

#include <gtest/gtest.h>

namespace fasttree::device {
namespace {

TEST(Address, FormsOfIt) {
  const auto parsed = [](const char* text) { return parse_address(text).value().text(); };
  EXPECT_EQ(parsed("udp://10.0.0.7:4711"), "10.0.0.7:4711");
  EXPECT_EQ(parsed("udp://10.0.0.7:4711/"), "10.0.0.7:4711");
  EXPECT_EQ(parsed("board.local"), "board.local:18004");
  EXPECT_EQ(parsed(":0"), "127.0.0.1:0");
  EXPECT_EQ(parsed("[::1]:65535"), "[::1]:65535");
  EXPECT_EQ(parsed("udp://[fe80::1]"), "[fe80::1]:18004");
}

TEST(Address, WhatIsNone) {
  for (const char* text : {"", "udp://", "a:b", "a:", "a:65536", "a:-1", "a:1:2", "::1", "[::1",
                           "[]", "[::1]4", "tcp://a:1", "a b:1", "http://a/b"}) {
    const auto parsed = parse_address(text);
    ASSERT_FALSE(parsed.ok()) << text;
    EXPECT_EQ(parsed.status().code(), StatusCode::invalid_argument);
    EXPECT_NE(parsed.status().message().find("HOST:PORT"), std::string::npos);
  }
}

}  // namespace
}  // namespace fasttree::device
