// SPDX-License-Identifier: Apache-2.0
// A sender and a receiver with a network between them, and each alone against what should not be.
#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

#include "device/link/receiver.h"
#include "device/link/sender.h"
#include "device/link/wire.h"
#include "device/testing/lossy_network.h"

namespace fasttree::device {
namespace {

using test::Impairment;
using test::LossyNetwork;

constexpr std::uint64_t kSession = 1;
constexpr Micros kSilence = 5'000'000;

Peer peer(std::uint16_t port) {
  Peer p;
  p.port = port;
  return p;
}

std::vector<std::byte> random_bytes(std::size_t size) {
  std::mt19937 random(static_cast<std::uint32_t>(size));
  std::vector<std::byte> bytes(size);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random());
  return bytes;
}

struct Transfer {
  LinkCounts counts;
  Micros time = 0;
  bool complete = false;
};

Transfer transfer(std::size_t bytes, std::uint32_t payload, std::uint32_t window,
                  const Impairment& impairment, std::uint64_t seed) {
  const std::vector<std::byte> from = random_bytes(bytes);
  std::vector<std::byte> to(bytes);
  const PartsSource source({from});
  Sender sender(source, payload, window, kSilence);
  Receiver receiver(to, payload, window);
  LossyNetwork network(impairment, seed);
  Outbox out;
  Transfer result;
  Micros now = 1000;
  for (int step = 0; step < 10'000'000 && !sender.complete() && !sender.failed(); ++step) {
    now = std::max(now, std::min(network.next(), sender.next_event()));
    if (now == kNever) break;
    while (auto datagram = network.receive(now)) {
      Frame frame;
      if (parse_frame(datagram->bytes, frame) != FrameFault::none) continue;
      if (datagram->to == peer(2)) {
        receiver.on_data(frame, result.counts);
      } else {
        EXPECT_TRUE(sender.on_ack(frame, now));
      }
    }
    if (receiver.owes_ack()) {
      out.clear();
      receiver.write_ack(kSession, peer(1), out);
      network.send(peer(2), out, now);
    }
    bool more = true;
    while (more) {
      out.clear();
      more = sender.poll(kSession, peer(2), now, out, result.counts);
      network.send(peer(1), out, now);
    }
  }
  result.time = now;
  result.complete = sender.complete() && receiver.complete() && from == to;
  return result;
}

TEST(Stream, ComesWholeWithoutLoss) {
  for (const std::size_t bytes : {0, 1, 35, 36, 1439, 1440, 1441, 100'000, 3'000'000}) {
    const Transfer t = transfer(bytes, kEthernetPayload, kMostWindow, {}, 1);
    EXPECT_TRUE(t.complete) << bytes;
    EXPECT_EQ(t.counts.retransmitted, 0u) << bytes;
    EXPECT_EQ(t.counts.data_bytes_sent, bytes);
    EXPECT_EQ(t.counts.data_bytes_received, bytes);
  }
}

TEST(Stream, ComesWholeWithEveryKindOfDamage) {
  for (const double chance : {0.01, 0.05, 0.15, 0.3}) {
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
      Impairment impairment = Impairment::all(chance);
      impairment.corrupt = impairment.truncate = chance / 4;
      const Transfer t = transfer(200'000 + seed, seed % 2 == 0 ? kEthernetPayload : 360,
                                  seed % 3 == 0 ? kLeastWindow : kMostWindow, impairment, seed);
      EXPECT_TRUE(t.complete) << chance << ' ' << seed;
      EXPECT_GT(t.counts.retransmitted, 0u);
    }
  }
}

TEST(Stream, LossCostsAboutWhatIsLost) {
  Impairment impairment;
  impairment.lose = 0.02;
  const Transfer t = transfer(3'000'000, kEthernetPayload, kMostWindow, impairment, 3);
  ASSERT_TRUE(t.complete);
  // 2,084 frames; 42 get lost on average. Waiting for timers would be seen in the time.
  EXPECT_LT(t.counts.retransmitted, 100u);
  EXPECT_LT(t.time, 500'000u);
}

TEST(Stream, GivesUpWhereNothingComes) {
  Impairment impairment;
  impairment.lose = 1;
  const Transfer t = transfer(10'000, kEthernetPayload, kMostWindow, impairment, 1);
  EXPECT_FALSE(t.complete);
  EXPECT_GE(t.counts.timeouts, kMostTries - 1u);
  EXPECT_LT(t.time, 20'000'000u);
}

TEST(Stream, NoMoreThanTheWindowIsUnderWay) {
  const std::vector<std::byte> bytes(1'000'000);
  const PartsSource source({bytes});
  for (const std::uint32_t window : {0u, 1u, 8u, 20u}) {
    Sender sender(source, kEthernetPayload, window, kSilence);
    Outbox out;
    LinkCounts counts;
    while (sender.poll(kSession, peer(2), 1000, out, counts)) out.clear();
    EXPECT_EQ(out.entries().size(), window);
  }
}

Frame data_frame(std::uint32_t sequence, std::span<const std::byte> body) {
  Frame frame;
  frame.header.type = FrameType::data;
  frame.header.sequence = sequence;
  frame.body = body;
  return frame;
}

TEST(Receiver, WritesNothingThatDoesNotFit) {
  std::vector<std::byte> to(3 * 36 + 10);
  const std::vector<std::byte> body(64, std::byte{1});
  Receiver receiver(to, 36, 2);
  LinkCounts counts;
  const auto piece = [&](std::size_t size) { return std::span(body).first(size); };
  receiver.on_data(data_frame(2, piece(36)), counts);  // window is [0, 2)
  receiver.on_data(data_frame(4, piece(10)), counts);  // there is no such frame
  receiver.on_data(data_frame(~0u, piece(36)), counts);
  EXPECT_EQ(counts.out_of_window, 3u);
  receiver.on_data(data_frame(0, piece(35)), counts);
  receiver.on_data(data_frame(0, piece(37)), counts);
  receiver.on_data(data_frame(0, piece(0)), counts);
  EXPECT_EQ(counts.bad_length, 3u);
  EXPECT_FALSE(receiver.owes_ack());
  EXPECT_EQ(to, std::vector<std::byte>(to.size()));
  receiver.on_data(data_frame(1, piece(36)), counts);
  receiver.on_data(data_frame(1, piece(36)), counts);
  EXPECT_EQ(counts.duplicates, 1u);
  receiver.on_data(data_frame(0, piece(36)), counts);
  receiver.on_data(data_frame(3, piece(36)), counts);  // the last one is shorter
  EXPECT_EQ(counts.bad_length, 4u);
  receiver.on_data(data_frame(3, piece(10)), counts);
  receiver.on_data(data_frame(2, piece(36)), counts);
  EXPECT_TRUE(receiver.complete());
  receiver.on_data(data_frame(0, piece(36)), counts);
  EXPECT_EQ(counts.duplicates, 2u);
  EXPECT_EQ(to, std::vector<std::byte>(to.size(), std::byte{1}));
}

TEST(Receiver, AcksSayWhatCame) {
  std::vector<std::byte> to(100 * 36);
  const std::vector<std::byte> body(36);
  Receiver receiver(to, 36, 64);
  LinkCounts counts;
  for (const std::uint32_t s : {0u, 1u, 3u, 40u}) receiver.on_data(data_frame(s, body), counts);
  Outbox out;
  ASSERT_TRUE(receiver.owes_ack());
  receiver.write_ack(kSession, peer(1), out);
  EXPECT_FALSE(receiver.owes_ack());
  Frame ack;
  ASSERT_EQ(parse_frame(out.datagram(out.entries()[0]), ack), FrameFault::none);
  EXPECT_EQ(ack.header.sequence, 2u);
  ASSERT_EQ(ack.body.size(), 4u + 2 * 4u);
  EXPECT_EQ(get<std::uint32_t>(ack.body, 0), 2u + 64u);
  EXPECT_EQ(get<std::uint32_t>(ack.body, 4), 1u << 1);          // frame 3
  EXPECT_EQ(get<std::uint32_t>(ack.body, 8), 1u << (38 - 32));  // frame 40
}

class SenderAlone : public testing::Test {
 protected:
  SenderAlone() { sender_.poll(kSession, peer(2), 1000, out_, counts_); }

  bool ack(std::uint32_t sequence, std::uint32_t limit, std::vector<std::uint32_t> words = {}) {
    std::vector<std::byte> body(4 + 4 * words.size());
    put(Body(body), 0, limit);
    for (std::size_t i = 0; i < words.size(); ++i) put(Body(body), 4 + 4 * i, words[i]);
    Frame frame;
    frame.header.type = FrameType::ack;
    frame.header.sequence = sequence;
    frame.header.timestamp = 1000;
    frame.body = body;
    return sender_.on_ack(frame, 2000);
  }

  std::vector<std::byte> bytes_ = std::vector<std::byte>(10 * kEthernetPayload);
  PartsSource source_{{bytes_}};
  Sender sender_{source_, kEthernetPayload, 6, kSilence};
  Outbox out_;
  LinkCounts counts_;
};

TEST_F(SenderAlone, AcksThatCannotBeAreNotBelieved) {
  ASSERT_EQ(out_.entries().size(), 6u);
  EXPECT_FALSE(ack(7, 20));                   // of a frame that was never sent
  EXPECT_FALSE(ack(2, 1));                    // the window ends before it begins
  EXPECT_FALSE(ack(2, 2 + kMostWindow + 1));  // too large a window
  EXPECT_FALSE(ack(2, 20, {1}));              // frame 2 has and has not come
  EXPECT_FALSE(ack(2, 20, {1u << 30}));       // frame 32 was never sent
  EXPECT_FALSE(ack(2, 20, std::vector<std::uint32_t>(kMostWindow / 32 + 1)));
  EXPECT_FALSE(sender_.complete());
  EXPECT_TRUE(ack(6, 20));
  EXPECT_TRUE(ack(3, 20));  // an old one, which changes nothing
  out_.clear();
  sender_.poll(kSession, peer(2), 2000, out_, counts_);
  EXPECT_EQ(out_.entries().size(), 4u);
  EXPECT_TRUE(ack(10, 20));
  EXPECT_TRUE(sender_.complete());
  EXPECT_EQ(sender_.next_event(), kNever);
}

TEST_F(SenderAlone, WhatWasOvertakenIsSentAgainAndNothingElse) {
  const auto sent_at = [&](Micros now) {
    out_.clear();
    sender_.poll(kSession, peer(2), now, out_, counts_);
    std::vector<std::uint32_t> sequences;
    for (const auto& entry : out_.entries()) {
      Frame frame;
      EXPECT_EQ(parse_frame(out_.datagram(entry), frame), FrameFault::none);
      sequences.push_back(frame.header.sequence);
    }
    return sequences;
  };
  EXPECT_TRUE(ack(0, 20, {0b111110}));  // all but frame 0, which may only be late
  EXPECT_EQ(sent_at(2000), (std::vector<std::uint32_t>{6, 7, 8, 9}));
  EXPECT_EQ(sender_.next_event(), 2500u);  // round trip 1000, variation 500
  EXPECT_EQ(sent_at(2499), std::vector<std::uint32_t>());
  EXPECT_EQ(sent_at(2500), std::vector<std::uint32_t>{0});
  EXPECT_EQ(counts_.retransmitted, 1u);
  EXPECT_EQ(counts_.timeouts, 0u);
}

}  // namespace
}  // namespace fasttree::device
