// SPDX-License-Identifier: Apache-2.0
#include "device/net/server.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace fasttree::device {
namespace {

constexpr Micros kLook = 100'000;     // for stopping, and for progress while it builds
constexpr Micros kGoodbye = 500'000;  // for the client to hear that this side stops
constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};

}  // namespace

Result<std::unique_ptr<Server>> Server::open(const ServeSettings& settings, Device& device) {
  Result<Description> description = device.describe();
  if (!description.ok()) return description.status();
  Result<UdpPort> port = UdpPort::listen(settings.listen);
  if (!port.ok()) return port.status();
  ServerSettings session;
  session.description = std::move(description).value();
  session.description.program = settings.program;
  session.description.most_scene_bytes =
      std::min(session.description.most_scene_bytes,
               settings.memory_limit_bytes > 0 ? settings.memory_limit_bytes : kNoLimit);
  session.payload = settings.payload;
  session.timeout_ms = settings.timeout_ms;
  // Half of what the system keeps, which counts more than the frames' own bytes.
  session.window_bytes = port.value().receive_buffer_bytes() / 2;
  return std::unique_ptr<Server>(new Server(std::move(port).value(), session, settings, device));
}

Server::Server(UdpPort port, const ServerSettings& session, const ServeSettings& settings,
               Device& device)
    : port_(std::move(port)), session_(session), settings_(settings), device_(&device) {}

Server::~Server() {
  end_build();
}

void Server::start_build(SceneOrder order, Micros now) {
  Order& what = order.order;
  if (settings_.memory_limit_bytes > 0) {
    const std::uint64_t left =
        std::max<std::uint64_t>(settings_.memory_limit_bytes - order.scene.bytes().size(), 1);
    what.memory_limit_bytes =
        what.memory_limit_bytes > 0 ? std::min(what.memory_limit_bytes, left) : left;
  }
  building_ = std::move(order);
  Status status = device_->write_scene(building_->view());
  if (status.ok()) status = device_->start(building_->order, [this] { port_.wake(); });
  if (status.ok()) return;
  building_.reset();
  session_.engine_ended(status, now);
}

void Server::run_engine(Micros now) {
  if (!building_) {
    if (auto order = session_.take_scene()) start_build(std::move(*order), now);
    return;
  }
  if (session_.engine_unwanted()) device_->cancel();
  const auto status = device_->wait_for(std::chrono::milliseconds(0));
  if (!status) return session_.engine_progress(device_->progress());
  building_.reset();
  session_.engine_ended(status->ok() ? device_->read_result() : Result<Outcome>(*status), now);
}

std::optional<BuildProgress> Server::progress() const {
  if (!building_) return std::nullopt;
  return device_->progress();
}

bool Server::take_in() {
  return port_.receive([&](std::span<const std::byte> datagram, const Peer& from) {
    session_.on_datagram(datagram, from, micros_now());
  }) > 0;
}

bool Server::send_out() {
  out_.clear();
  const bool more = session_.poll(micros_now(), out_);
  port_.send(out_);
  return more;
}

void Server::run(const std::function<bool()>& go_on,
                 const std::function<void(const SessionEnd&)>& ended) {
  const auto tell = [&] {
    for (const SessionEnd& end : session_.take_ends()) ended(end);
  };
  Micros look = 0;
  for (;;) {
    const bool received = take_in();
    const Micros now = micros_now();
    if (now >= look) {
      look = now + kLook;
      if (!go_on()) break;
    }
    run_engine(now);
    const bool more = send_out();
    tell();
    if (received || more) continue;
    const Micros next = std::min(session_.next_event(), look);
    const Micros then = micros_now();
    if (next > then) port_.wait(next - then);
  }
  say_goodbye();
  tell();
}

void Server::say_goodbye() {
  session_.stop(micros_now());
  device_->cancel();
  const Micros until = micros_now() + kGoodbye;
  while (session_.in_session() && micros_now() < until) {
    take_in();
    send_out();
    const Micros next = std::min(session_.next_event(), until);
    const Micros then = micros_now();
    if (next > then) port_.wait(next - then);
  }
  end_build();
}

void Server::end_build() {
  if (!building_) return;
  // The scene is not to go while the engine reads it.
  device_->cancel();
  while (!device_->wait_for(std::chrono::milliseconds(100))) {
  }
  building_.reset();
}

}  // namespace fasttree::device
