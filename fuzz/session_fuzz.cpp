// SPDX-License-Identifier: Apache-2.0
// A server and a client, and between them a script out of any bytes: frames that are lost, doubled,
// held back, and others made up, with the right checksum, number and address. Whatever comes, both
// sides are done some time after the last of it, and memory stays within what was agreed.
//
// Run: session_fuzz -max_len=1024 NEW_FINDS fuzz/corpus/session
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <span>
#include <utility>
#include <vector>

#include "device/link/client_session.h"
#include "device/link/server_session.h"

namespace {

using namespace fasttree;
using namespace fasttree::device;

constexpr std::uint64_t kMostScene = 100'000;
constexpr std::uint64_t kMostResult = 1'000'000;
constexpr std::uint64_t kSession = 7;

void expect(bool fact) {
  if (!fact) std::abort();
}

Peer peer(std::uint16_t port) {
  Peer p;
  p.port = port;
  return p;
}

class Script {
 public:
  Script(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  bool ended() const { return at_ >= size_; }
  std::uint8_t byte() { return ended() ? 0 : data_[at_++]; }
  std::span<const std::byte> bytes(std::size_t count) {
    count = std::min(count, size_ - at_);
    const auto* begin = reinterpret_cast<const std::byte*>(data_ + at_);
    at_ += count;
    return {begin, count};
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t at_ = 0;
};

class World {
 public:
  explicit World(Script& script)
      : script_(script),
        scene_(36 * (script.byte() % 64)),
        source_({scene_}),
        server_(server_settings()),
        client_(client_settings(), kSession, Order(), source_, peer(1), now_) {}

  void run() {
    while (!script_.ended()) step();
    // Silence. The client ends by its time-out; then the server by its own, and its engine ends.
    to_client_.clear();
    to_server_.clear();
    for (int i = 0; i < 200 && (!client_.ended() || server_.busy()); ++i) {
      now_ += 100'000;
      poll();
      engine(true);
      to_client_.clear();
      to_server_.clear();
    }
    expect(client_.ended());
    expect(!server_.busy());
    expect(server_.next_event() == kNever);
    if (client_.status().ok()) {
      expect(client_.result().bytes().size() <= kMostResult);
      (void)parse_result(client_.result().bytes(), client_.result().owner());
    }
    for (const SessionEnd& end : server_.take_ends()) expect(end.scene_bytes <= kMostScene);
  }

 private:
  using Datagram = std::vector<std::byte>;

  static ServerSettings server_settings() {
    ServerSettings settings;
    settings.description.most_scene_bytes = kMostScene;
    settings.timeout_ms = 1000;
    return settings;
  }
  static ClientSettings client_settings() {
    ClientSettings settings;
    settings.timeout_ms = 1000;
    settings.payload = 360;
    settings.window = 16;
    settings.most_result_bytes = kMostResult;
    return settings;
  }

  void step() {
    switch (script_.byte() % 12) {
      case 0:
      case 1:
        return deliver(to_server_, true);
      case 2:
      case 3:
        return deliver(to_client_, false);
      case 4:
        now_ += Micros{script_.byte()} * 100;
        return poll();
      case 5:
        now_ += Micros{script_.byte()} * 10'000;
        return poll();
      case 6:
        if (!to_server_.empty()) to_server_.pop_front();
        return;
      case 7:
        if (!to_client_.empty()) to_client_.pop_front();
        return;
      case 8:
        return made_up(true);
      case 9:
        return made_up(false);
      case 10:
        return engine(script_.byte() % 2 == 0);
      default:
        if (script_.byte() % 16 == 0) client_.cancel(now_);
        poll();
    }
  }

  void deliver(std::deque<Datagram>& queue, bool to_server) {
    if (queue.empty()) return poll();
    const Datagram datagram = queue.front();
    const std::uint8_t how = script_.byte();
    if (how % 4 != 1) queue.pop_front();          // else it comes again
    if (how % 8 == 2) queue.push_back(datagram);  // and again, late
    give(datagram, to_server, how % 32 == 3 ? 9 : to_server ? 2 : 1);
  }

  void give(std::span<const std::byte> datagram, bool to_server, std::uint16_t from) {
    if (to_server) {
      server_.on_datagram(datagram, peer(from), now_);
    } else {
      client_.on_datagram(datagram, peer(from), now_);
    }
    poll();
  }

  // Right in form, with any content.
  void made_up(bool to_server) {
    FrameHeader header;
    header.type = static_cast<FrameType>(script_.byte() % (kLastFrameType + 2));
    const std::uint8_t kind = script_.byte();
    header.session = kind % 8 == 0 ? 8 : kSession;
    header.sequence = script_.byte();
    if (kind % 8 == 1) header.sequence = ~header.sequence;
    header.timestamp = script_.byte();
    const std::uint8_t length = script_.byte();
    const auto body = script_.bytes(length);
    Datagram datagram(kFrameOverhead + length);
    std::copy(body.begin(), body.end(), datagram.begin() + kHeaderBytes);
    finish_frame(header, datagram);
    give(datagram, to_server, kind % 16 == 2 ? 9 : to_server ? 2 : 1);
  }

  void engine(bool well) {
    if (!building_) {
      auto order = server_.take_scene();
      if (!order) return;
      expect(order->scene.bytes().size() <= kMostScene);
      building_ = std::move(order);
      return;
    }
    building_.reset();
    server_.engine_progress({"stage", 0.5});
    if (well) {
      std::vector<std::uint32_t> ids(script_.byte() * 20u);
      Outcome outcome;
      outcome.tree = Tree(TreeInfo(), {Node::leaf(0, 0)}, std::move(ids));
      server_.engine_ended(std::move(outcome), now_);
    } else {
      server_.engine_ended(Status(StatusCode::bad_input, "no"), now_);
    }
    poll();
  }

  void poll() {
    static Outbox out;  // large: making one takes longer than a script
    for (bool more = true; more;) {
      out.clear();
      more = server_.poll(now_, out);
      for (const auto& entry : out.entries()) queue(to_client_, out.datagram(entry));
    }
    for (bool more = true; more;) {
      out.clear();
      more = client_.poll(now_, out);
      for (const auto& entry : out.entries()) queue(to_server_, out.datagram(entry));
    }
  }

  static void queue(std::deque<Datagram>& to, std::span<const std::byte> datagram) {
    Frame frame;
    expect(parse_frame(datagram, frame) == FrameFault::none);
    if (to.size() < 200) to.emplace_back(datagram.begin(), datagram.end());
  }

  Script& script_;
  Micros now_ = 1'000'000;
  std::vector<std::byte> scene_;
  PartsSource source_;
  ServerSession server_;
  ClientSession client_;
  std::optional<SceneOrder> building_;
  std::deque<Datagram> to_client_, to_server_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Script script(data, size);
  World world(script);
  world.run();
  return 0;
}
