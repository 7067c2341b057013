// SPDX-License-Identifier: Apache-2.0
// A UDP socket that takes and gives many datagrams a call. Datagrams of one size leave as one large
// piece that the kernel cuts (UDP_SEGMENT), and come as one that it has put together (UDP_GRO),
// where it can; otherwise many a call (sendmmsg, recvmmsg).
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>

#include "device/link/counts.h"
#include "device/link/outbox.h"
#include "device/net/address.h"
#include "fasttree/status.h"

namespace fasttree::device {

class UdpPort {
 public:
  /// Binds to the address; port 0: any. io_error, saying why not.
  static Result<UdpPort> listen(const Address& address);
  /// A port of its own that talks to the address alone.
  static Result<UdpPort> connect(const Address& address);

  UdpPort(UdpPort&&) noexcept;
  UdpPort& operator=(UdpPort&&) noexcept;
  ~UdpPort();

  /// Bound to, or, of a connected one, connected to.
  const Address& address() const;
  const Peer& peer() const;  ///< of a connected one
  /// Bytes that the system keeps for this socket while nobody reads it.
  std::uint64_t receive_buffer_bytes() const;

  /// Sends all. What the system does not take is lost, as on any network.
  void send(const Outbox& out);

  using Take = std::function<void(std::span<const std::byte> datagram, const Peer& from)>;
  /// Hands over what has come, at most a few hundred datagrams, without waiting. How many they
  /// were.
  std::size_t receive(const Take& take);

  /// Whether the other side's system has said that nothing listens there since the last call.
  bool was_unreachable();

  /// Until something has come or wake() was called, at most so long.
  void wait(Micros time);
  /// From any thread.
  void wake();

 private:
  struct Impl;
  explicit UdpPort(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// "127.0.0.1:4711"
std::string text_of(const Peer& peer);

/// The clock of the sessions.
Micros micros_now();

/// A session's number: random, never 0.
std::uint64_t random_session();

}  // namespace fasttree::device
