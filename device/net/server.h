// SPDX-License-Identifier: Apache-2.0
// The board's side as a program: a port, a session, and a device that builds.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "device/device.h"
#include "device/link/counts.h"
#include "device/link/server_session.h"
#include "device/net/address.h"
#include "device/net/udp_port.h"

namespace fasttree::device {

struct ServeSettings {
  Address listen;
  std::uint64_t memory_limit_bytes = 0;  ///< of scene and build of the library; 0: none
  std::uint32_t payload = kLargestPayload;
  std::uint32_t timeout_ms = 5000;
  std::string program;  ///< for the description
};

class Server {
 public:
  /// `device` has to outlive the server. io_error: the address.
  static Result<std::unique_ptr<Server>> open(const ServeSettings& settings, Device& device);

  ~Server();  ///< after the last build has ended
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  const Address& address() const { return port_.address(); }

  /// Larger ones are refused.
  std::uint64_t most_scene_bytes() const { return session_.most_scene_bytes(); }

  /// Serves until `go_on` says false, which is asked a few times a second. Tells about each session
  /// that has ended.
  void run(const std::function<bool()>& go_on, const std::function<void(const SessionEnd&)>& ended);

  /// Of the build that runs.
  std::optional<BuildProgress> progress() const;

  const LinkCounts& counts() const { return session_.counts(); }

 private:
  Server(UdpPort port, const ServerSettings& session, const ServeSettings& settings,
         Device& device);

  bool take_in();
  void run_engine(Micros now);
  void start_build(SceneOrder order, Micros now);
  bool send_out();
  void say_goodbye();
  void end_build();

  UdpPort port_;
  ServerSession session_;
  ServeSettings settings_;
  Device* device_;
  std::optional<SceneOrder> building_;
  Outbox out_;
};

}  // namespace fasttree::device
