// SPDX-License-Identifier: Apache-2.0
#include "device/link/messages.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "device/link/wire.h"

namespace fasttree::device {
namespace {

template <std::size_t kBytes, typename Write>
std::vector<std::byte> body_of(Write write) {
  std::vector<std::byte> body(kBytes, std::byte{0xAA});
  write(body);
  return body;
}

std::vector<std::byte> hello_body(const Hello& hello) {
  return body_of<kHelloBytes>([&](Body body) { write_hello(hello, body); });
}

TEST(Messages, HelloComesBack) {
  Hello hello;
  hello.scene_bytes = 36 * 5'000'000'000ull;
  hello.most_result_bytes = 1ull << 40;
  hello.payload = kJumboPayload;
  hello.window = 77;
  hello.timeout_ms = 1234;
  hello.order = {Profile::paper, AxisSchedule::longest,     17,          -3, 4.5, 1ull << 33,
                 {7, 9},         Implementation::reference, Simd::scalar};
  const auto read = read_hello(hello_body(hello));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->scene_bytes, hello.scene_bytes);
  EXPECT_EQ(read->most_result_bytes, hello.most_result_bytes);
  EXPECT_EQ(read->payload, kJumboPayload);
  EXPECT_EQ(read->window, 77u);
  EXPECT_EQ(read->timeout_ms, 1234u);
  const Order& order = read->order;
  EXPECT_EQ(order.profile, Profile::paper);
  EXPECT_EQ(order.axes, AxisSchedule::longest);
  EXPECT_EQ(order.depth, 17);
  EXPECT_EQ(order.extra_depth, -3);
  EXPECT_EQ(order.max_growth, 4.5);
  EXPECT_EQ(order.memory_limit_bytes, 1ull << 33);
  EXPECT_EQ(order.sah_costs.traversal, 7);
  EXPECT_EQ(order.sah_costs.intersection, 9);
  EXPECT_EQ(order.implementation, Implementation::reference);
  EXPECT_EQ(order.simd, Simd::scalar);
}

TEST(Messages, AnAutomaticDepthIsKept) {
  const auto read = read_hello(hello_body(Hello()));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->order.depth, kAutoDepth);
}

TEST(Messages, HellosThatCannotBeAreRefused) {
  const auto refused = [](auto change) {
    Hello hello;
    change(hello);
    return !read_hello(hello_body(hello));
  };
  EXPECT_FALSE(refused([](Hello&) {}));
  EXPECT_TRUE(refused([](Hello& h) { h.scene_bytes = 35; }));
  EXPECT_TRUE(refused([](Hello& h) { h.payload = 0; }));
  EXPECT_TRUE(refused([](Hello& h) { h.payload = 1441; }));
  EXPECT_TRUE(refused([](Hello& h) { h.payload = kLargestPayload + 36; }));
  EXPECT_TRUE(refused([](Hello& h) { h.window = 0; }));
  EXPECT_TRUE(refused([](Hello& h) { h.window = kMostWindow + 1; }));
  EXPECT_TRUE(refused([](Hello& h) { h.timeout_ms = 0; }));
  EXPECT_TRUE(refused([](Hello& h) { h.timeout_ms = ~0u; }));
  EXPECT_TRUE(refused([](Hello& h) { h.order.profile = static_cast<Profile>(9); }));
  EXPECT_TRUE(refused([](Hello& h) { h.order.axes = static_cast<AxisSchedule>(2); }));
  EXPECT_TRUE(refused([](Hello& h) { h.order.simd = static_cast<Simd>(2); }));
  EXPECT_TRUE(refused([](Hello& h) { h.order.max_growth = std::nan(""); }));
  EXPECT_TRUE(refused(
      [](Hello& h) { h.order.sah_costs.traversal = std::numeric_limits<double>::infinity(); }));
  auto body = hello_body(Hello());
  body.pop_back();
  EXPECT_FALSE(read_hello(body));
}

TEST(Messages, DescriptionComesBackAndIsCutAndCleaned) {
  Description description;
  description.engine = "rtl";
  description.config = std::string(100, 'c');
  description.program = "fasttree\n0.1\x1b[31m";
  description.most_scene_bytes = 123456789;
  description.busy = true;
  const auto read = read_description(
      body_of<kDescriptionBytes>([&](Body body) { write_description(description, body); }));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->engine, "rtl");
  EXPECT_EQ(read->config, std::string(64, 'c'));
  EXPECT_EQ(read->program, "fasttree?0.1?[31m");
  EXPECT_EQ(read->most_scene_bytes, 123456789u);
  EXPECT_TRUE(read->busy);
}

TEST(Messages, FaultsComeBackCutWhereTheyAreLong) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{20}, std::size_t{5000}}) {
    const Status status(StatusCode::bad_input, std::string(size, 'x'));
    std::vector<std::byte> body(fault_bytes(status));
    write_fault(status, body);
    const auto read = read_fault(body);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->code(), StatusCode::bad_input);
    EXPECT_EQ(read->message(), std::string(std::min(size, kMostMessageBytes), 'x'));
    put(Body(body), 0, std::uint32_t{0});  // "ok" is no fault
    EXPECT_FALSE(read_fault(body));
    put(Body(body), 0, std::uint32_t{99});
    EXPECT_FALSE(read_fault(body));
  }
}

TEST(Messages, TheSmallOnesComeBack) {
  const auto accept = read_accept(body_of<kAcceptBytes>([](Body body) {
    write_accept({360, 9, 700}, body);
  }));
  ASSERT_TRUE(accept);
  EXPECT_EQ(accept->payload, 360u);
  EXPECT_EQ(accept->window, 9u);
  EXPECT_EQ(accept->timeout_ms, 700u);
  const auto refuse = read_refuse(body_of<kRefuseBytes>([](Body body) {
    write_refuse({Refusal::scene_too_large, 1ull << 35}, body);
  }));
  ASSERT_TRUE(refuse);
  EXPECT_EQ(refuse->reason, Refusal::scene_too_large);
  EXPECT_EQ(refuse->limit, 1ull << 35);
  const auto progress = read_progress(body_of<kProgressBytes>([](Body body) {
    write_progress({"radix_sort", 0.25}, body);
  }));
  ASSERT_TRUE(progress);
  EXPECT_EQ(progress->stage, "radix_sort");
  EXPECT_EQ(progress->fraction, 0.25);
  EXPECT_EQ(read_offer(body_of<kOfferBytes>([](Body body) { write_offer(99, body); })), 99u);
  const auto close = body_of<kCloseBytes>([](Body body) { write_close(Closing::broken, body); });
  EXPECT_EQ(read_close(close), Closing::broken);
  EXPECT_FALSE(read_close(std::vector<std::byte>(4, std::byte{9})));
}

}  // namespace
}  // namespace fasttree::device
