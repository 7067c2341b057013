// SPDX-License-Identifier: Apache-2.0
// A network that misbehaves by dice, the same way for the same seed.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <queue>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "device/link/counts.h"
#include "device/link/outbox.h"

namespace fasttree::device::test {

/// Chances for a datagram, and times in microseconds.
struct Impairment {
  double lose = 0;
  double duplicate = 0;
  double reorder = 0;  ///< comes `late` later than it should
  double corrupt = 0;  ///< one to four bytes
  double truncate = 0;
  Micros delay = 50;
  Micros jitter = 20;
  Micros late = 2000;

  static Impairment all(double chance) {
    Impairment impairment;
    impairment.lose = impairment.duplicate = impairment.reorder = chance;
    return impairment;
  }
};

struct Datagram {
  Peer from;
  Peer to;
  std::vector<std::byte> bytes;
};

class LossyNetwork {
 public:
  LossyNetwork(const Impairment& impairment, std::uint64_t seed)
      : impairment_(impairment), random_(seed) {}

  void set(const Impairment& impairment) { impairment_ = impairment; }

  void send(const Peer& from, const Outbox& out, Micros now) {
    for (const Outbox::Entry& entry : out.entries()) {
      const auto bytes = out.datagram(entry);
      send({from, entry.peer, {bytes.begin(), bytes.end()}}, now);
    }
  }

  void send(Datagram datagram, Micros now) {
    if (chance(impairment_.lose)) return;
    if (chance(impairment_.duplicate)) deliver(datagram, now);
    if (chance(impairment_.truncate) && !datagram.bytes.empty()) {
      datagram.bytes.resize(below(datagram.bytes.size()));
    }
    if (chance(impairment_.corrupt)) {
      for (std::size_t n = 1 + below(4); n > 0 && !datagram.bytes.empty(); --n) {
        datagram.bytes[below(datagram.bytes.size())] ^= static_cast<std::byte>(1 + below(255));
      }
    }
    deliver(std::move(datagram), now);
  }

  Micros next() const { return queue_.empty() ? kNever : queue_.top().time; }

  /// What has come by now, one by one.
  std::optional<Datagram> receive(Micros now) {
    if (queue_.empty() || queue_.top().time > now) return std::nullopt;
    Datagram datagram = std::move(const_cast<Flight&>(queue_.top()).datagram);
    queue_.pop();
    return datagram;
  }

  bool chance(double p) { return p > 0 && std::uniform_real_distribution<>(0, 1)(random_) < p; }
  std::size_t below(std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_);
  }

 private:
  struct Flight {
    Micros time;
    std::uint64_t order;
    Datagram datagram;
    friend bool operator<(const Flight& a, const Flight& b) {
      return a.time != b.time ? a.time > b.time : a.order > b.order;
    }
  };

  void deliver(Datagram datagram, Micros now) {
    Micros time = now + impairment_.delay + below(impairment_.jitter + 1);
    if (chance(impairment_.reorder)) time += below(impairment_.late + 1);
    queue_.push({time, order_++, std::move(datagram)});
  }

  Impairment impairment_;
  std::mt19937_64 random_;
  std::priority_queue<Flight> queue_;
  std::uint64_t order_ = 0;
};

}  // namespace fasttree::device::test
