// SPDX-License-Identifier: Apache-2.0
#include "device/net/remote_device.h"

#include <algorithm>
#include <utility>

#include "device/link/admission.h"
#include "device/link/byte_source.h"
#include "device/link/result.h"
#include "device/net/udp_port.h"

namespace fasttree::device {
namespace {

constexpr Micros kLook = 50'000;            // for cancelling and progress
constexpr std::uint32_t kUnreachables = 3;  // then nobody is taken to be there
constexpr Micros kDescribeWait = 50'000, kMostDescribeWait = 500'000;

}  // namespace

RemoteDevice::RemoteDevice(const Address& address, const ClientSettings& settings)
    : address_(address), settings_(settings) {}

Status RemoteDevice::at_device(const Status& status) const {
  if (status.ok() || status.code() == StatusCode::cancelled) return status;
  return {status.code(), "device " + address_.text() + ": " + status.message()};
}

Result<Description> RemoteDevice::describe() {
  Result<UdpPort> opened = UdpPort::connect(address_);
  if (!opened.ok()) return opened.status();
  UdpPort& port = opened.value();
  const std::uint64_t number = random_session();
  std::optional<Description> answer;
  LinkCounts ignored;
  Outbox out;
  Repeat ask;
  Micros now = micros_now();
  ask.start(now, kDescribeWait, kMostDescribeWait);
  const Micros until = now + Micros{settings_.timeout_ms} * 1000;
  std::uint32_t unreachable = 0;
  for (; !answer && now < until && unreachable < kUnreachables; now = micros_now()) {
    if (ask.due(now)) {
      out.clear();
      const Body body = out.body(kDescriptionBytes);
      std::fill(body.begin(), body.end(), std::byte{0});
      out.commit({FrameType::describe, number, 0, 0}, kDescriptionBytes, port.peer());
      port.send(out);
      ask.done(now);
    }
    port.wait(std::min(ask.next(), until) - std::min(now, std::min(ask.next(), until)));
    port.receive([&](std::span<const std::byte> datagram, const Peer&) {
      Frame frame;
      if (admit(datagram, frame, ignored) && frame.header.session == number &&
          frame.header.type == FrameType::description) {
        answer = read_description(frame.body);
      }
    });
    if (port.was_unreachable()) ++unreachable;
  }
  if (answer) return *answer;
  if (unreachable >= kUnreachables) {
    return at_device({StatusCode::io_error,
                      "nothing listens there; is fasttree serve running, and at this port?"});
  }
  return at_device({StatusCode::io_error,
                    "does not say what it is; is fasttree serve running there, and does UDP get "
                    "through?"});
}

Status RemoteDevice::write_scene(const MeshView& mesh) {
  if (job_.runs()) return {StatusCode::invalid_argument, "a build still runs on the device"};
  if (Status s = validate(mesh); !s.ok()) return s;
  mesh_ = mesh;
  return {};
}

Status RemoteDevice::start(const Order& order, std::function<void()> ended) {
  if (job_.runs()) return {StatusCode::invalid_argument, "a build still runs on the device"};
  if (!mesh_) return {StatusCode::invalid_argument, "the device has no scene; write one first"};
  outcome_.reset();
  job_.start(
      [this, order](const ProgressCallback& progress) {
        return at_device(run_session(order, progress));
      },
      std::move(ended));
  return {};
}

Status RemoteDevice::run_session(const Order& order, const ProgressCallback& progress) {
  Result<UdpPort> opened = UdpPort::connect(address_);
  if (!opened.ok()) return {opened.status().code(), opened.status().message()};
  UdpPort& port = opened.value();
  ClientSettings settings = settings_;
  // Half of what the system keeps, which counts more than the frames' own bytes.
  const std::uint64_t fit = port.receive_buffer_bytes() / 2 / settings.payload;
  settings.window =
      static_cast<std::uint32_t>(std::clamp<std::uint64_t>(fit, kLeastWindow, settings.window));
  const SceneSource scene(*mesh_);
  ClientSession session(settings, random_session(), order, scene, port.peer(), micros_now());
  const auto take = [&](std::span<const std::byte> datagram, const Peer& from) {
    session.on_datagram(datagram, from, micros_now());
  };
  Outbox out;
  Micros look = 0;
  while (!session.ended()) {
    const std::size_t received = port.receive(take);
    if (port.was_unreachable()) session.on_unreachable();
    const Micros now = micros_now();
    if (now >= look) {
      look = now + kLook;
      const BuildProgress state = session.progress();
      if (!progress(state.stage.c_str(), state.fraction)) session.cancel(now);
    }
    out.clear();
    const bool more = session.poll(now, out);
    port.send(out);
    if (received > 0 || more || session.ended()) continue;
    const Micros next = std::min(session.next_event(), look);
    const Micros then = micros_now();
    if (next > then) port.wait(next - then);
  }
  counts_ += session.counts();
  if (!session.status().ok()) return session.status();
  Result<Outcome> outcome = parse_result(session.result().bytes(), session.result().owner());
  if (!outcome.ok()) return outcome.status();
  if (outcome.value().tree.info().triangle_count != mesh_->triangle_count) {
    return {StatusCode::bad_input,
            "its tree is for " + std::to_string(outcome.value().tree.info().triangle_count) +
                " triangles, and the scene has " + std::to_string(mesh_->triangle_count)};
  }
  outcome_ = std::move(outcome).value();
  return {};
}

std::optional<Status> RemoteDevice::wait_for(std::chrono::milliseconds time) {
  return job_.wait_for(time);
}

Result<Outcome> RemoteDevice::read_result() {
  if (job_.runs() || !outcome_) {
    return Status(StatusCode::invalid_argument, "the device has no result to read");
  }
  Outcome outcome = std::move(*outcome_);
  outcome_.reset();
  return outcome;
}

}  // namespace fasttree::device
