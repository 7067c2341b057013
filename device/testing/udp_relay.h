// SPDX-License-Identifier: Apache-2.0
// A bad network of real sockets: passes datagrams on between clients and a server, or does not.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <thread>

#include "device/net/udp_port.h"
#include "device/testing/lossy_network.h"

namespace fasttree::device::test {

class UdpRelay {
 public:
  UdpRelay(const Address& server, const Impairment& impairment, std::uint64_t seed)
      : front_(UdpPort::listen({"127.0.0.1", 0}).value()),
        back_(UdpPort::connect(server).value()),
        network_(impairment, seed),
        thread_([this] { run(); }) {}

  ~UdpRelay() {
    stop_ = true;
    thread_.join();
  }

  const Address& address() const { return front_.address(); }

 private:
  void run() {
    Peer client;
    while (!stop_) {
      const Micros now = micros_now();
      const auto pass = [&](const Peer& to) {
        return [&, to](std::span<const std::byte> bytes, const Peer&) {
          network_.send({{}, to, {bytes.begin(), bytes.end()}}, now);
        };
      };
      front_.receive([&](std::span<const std::byte> bytes, const Peer& from) {
        client = from;  // answers go to whoever spoke last; session numbers keep them apart
        pass(back_.peer())(bytes, from);
      });
      back_.receive(pass(client));
      Outbox forth, back;
      while (auto datagram = network_.receive(micros_now())) {
        const bool to_server = datagram->to == back_.peer();
        Outbox& out = to_server ? forth : back;
        if (!out.add(datagram->bytes, datagram->to)) break;
      }
      back_.send(forth);
      front_.send(back);
      front_.wait(200);
    }
  }

  UdpPort front_, back_;
  LossyNetwork network_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace fasttree::device::test
