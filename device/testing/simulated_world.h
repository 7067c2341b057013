// SPDX-License-Identifier: Apache-2.0
// A server and its clients with a lossy network between them and a clock that jumps from event to
// event. Nothing waits, so thousands of sessions take seconds.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "device/link/client_session.h"
#include "device/link/server_session.h"
#include "device/testing/lossy_network.h"
#include "fasttree/build.h"

namespace fasttree::device::test {

inline Peer peer(std::uint16_t port) {
  Peer p;
  p.address[15] = 1;
  p.port = port;
  return p;
}

inline Result<Outcome> build_outcome(const SceneOrder& order) {
  Builder builder;
  Result<Tree> tree = builder.build(order.view(), settings_of(order.order));
  if (!tree.ok()) return tree.status();
  Outcome outcome;
  outcome.tree = std::move(tree).value();
  outcome.counters.build_ms = 1;
  return outcome;
}

class SimulatedWorld {
 public:
  SimulatedWorld(const ServerSettings& settings, const Impairment& impairment, std::uint64_t seed)
      : settings_(settings), network(impairment, seed), server(std::in_place, settings) {
    settings_.description.most_scene_bytes = settings.description.most_scene_bytes;
  }

  /// Moves everything on to the next event, at most to `until`. False where nothing is left to do.
  bool step(std::span<ClientSession* const> clients, Micros until = kNever) {
    Micros next = network.next();
    if (server) next = std::min(next, server->next_event());
    if (engine_due_) next = std::min(next, *engine_due_);
    for (const ClientSession* client : clients) {
      if (client != nullptr && !client->ended()) next = std::min(next, client->next_event());
    }
    if (next == kNever || (next > until && now >= until)) return false;
    now = std::max(now, std::min(next, until));
    while (auto datagram = network.receive(now)) {
      if (datagram->to == server_peer()) {
        if (server) server->on_datagram(datagram->bytes, datagram->from, now);
        continue;
      }
      for (std::size_t i = 0; i < clients.size(); ++i) {
        if (clients[i] != nullptr && datagram->to == client_peer(i)) {
          clients[i]->on_datagram(datagram->bytes, datagram->from, now);
        }
      }
    }
    if (server) run_server();
    for (std::size_t i = 0; i < clients.size(); ++i) {
      if (clients[i] == nullptr || clients[i]->ended()) continue;
      bool more = true;
      while (more) {
        outbox_.clear();
        more = clients[i]->poll(now, outbox_);
        network.send(client_peer(i), outbox_, now);
      }
    }
    return true;
  }

  void run(ClientSession& client) {
    ClientSession* one[] = {&client};
    while (!client.ended() && step(one)) {
    }
  }

  /// Lets time pass with nobody there but the server.
  void pass(Micros time) {
    const Micros until = now + time;
    while (step({}, until)) {
    }
    now = std::max(now, until);
  }

  void kill_server() {
    server.reset();
    engine_due_.reset();
    scene_.reset();
  }
  void start_server() { server.emplace(settings_); }

  static Peer server_peer() { return peer(18004); }
  static Peer client_peer(std::size_t i) { return peer(static_cast<std::uint16_t>(40000 + i)); }

 private:
  ServerSettings settings_;

 public:
  Micros now = 1'000'000;
  LossyNetwork network;
  std::optional<ServerSession> server;
  Micros build_time = 300;
  Micros cancel_time = 100;  ///< until the engine has noticed
  std::function<Result<Outcome>(const SceneOrder&)> engine = build_outcome;

 private:
  void run_server() {
    if (auto order = server->take_scene()) {
      scene_ = std::move(*order);
      engine_due_ = now + build_time;
    }
    if (engine_due_ && server->engine_unwanted()) {
      engine_due_ = std::min(*engine_due_, now + cancel_time);
    }
    if (engine_due_ && now >= *engine_due_) {
      engine_due_.reset();
      server->engine_ended(engine(*scene_), now);
      scene_.reset();
    }
    bool more = true;
    while (more) {
      outbox_.clear();
      more = server->poll(now, outbox_);
      network.send(server_peer(), outbox_, now);
    }
  }

  std::optional<SceneOrder> scene_;
  std::optional<Micros> engine_due_;
  Outbox outbox_;
};

}  // namespace fasttree::device::test
