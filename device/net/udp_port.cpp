// SPDX-License-Identifier: Apache-2.0
#include "device/net/udp_port.h"

#include <netinet/udp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <asio/io_context.hpp>
#include <asio/ip/udp.hpp>
#include <asio/post.hpp>
#include <asio/steady_timer.hpp>
#include <asio/system_error.hpp>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <random>
#include <utility>
#include <vector>

// Headers of older systems lack them; the kernel says whether it has them.
#ifndef UDP_SEGMENT
#define UDP_SEGMENT 103
#endif
#ifndef UDP_GRO
#define UDP_GRO 104
#endif

namespace fasttree::device {
namespace {

using asio::ip::udp;

constexpr int kSocketBuffer = 4 << 20;
constexpr Micros kFineWait = 20'000;
constexpr std::size_t kMessages = 32;       // a system call
constexpr std::size_t kPiece = 65'536;      // largest datagram, or train of them
constexpr std::size_t kMostSegments = 64;   // of a train
constexpr std::size_t kMostTrain = 65'000;  // bytes of a train, with room for headers

Status network(const std::string& what, const std::string& why) {
  return {StatusCode::io_error, what + ": " + why};
}

Peer peer_of(const udp::endpoint& endpoint) {
  Peer peer;
  peer.port = endpoint.port();
  if (endpoint.address().is_v4()) {
    const auto bytes = endpoint.address().to_v4().to_bytes();
    peer.address[10] = peer.address[11] = 0xFF;
    std::copy(bytes.begin(), bytes.end(), peer.address.begin() + 12);
  } else {
    const auto v6 = endpoint.address().to_v6();
    const auto bytes = v6.to_bytes();
    std::copy(bytes.begin(), bytes.end(), peer.address.begin());
    peer.scope = static_cast<std::uint32_t>(v6.scope_id());
  }
  return peer;
}

bool is_v4(const Peer& peer) {
  return std::all_of(peer.address.begin(), peer.address.begin() + 10,
                     [](std::uint8_t b) { return b == 0; }) &&
         peer.address[10] == 0xFF && peer.address[11] == 0xFF;
}

udp::endpoint endpoint_of(const Peer& peer) {
  if (is_v4(peer)) {
    asio::ip::address_v4::bytes_type bytes;
    std::copy(peer.address.begin() + 12, peer.address.end(), bytes.begin());
    return {asio::ip::address_v4(bytes), peer.port};
  }
  asio::ip::address_v6::bytes_type bytes;
  std::copy(peer.address.begin(), peer.address.end(), bytes.begin());
  return {asio::ip::address_v6(bytes, peer.scope), peer.port};
}

Address address_of(const udp::endpoint& endpoint) {
  return {endpoint.address().to_string(), endpoint.port()};
}

// One message of a system call: where it goes to, its bytes, and the size of its segments.
struct Message {
  iovec bytes{};
  udp::endpoint endpoint;
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control{};
};

Result<udp::endpoint> resolve(asio::io_context& io, const Address& address) {
  asio::error_code error;
  udp::resolver resolver(io);
  const auto found = resolver.resolve(address.host, std::to_string(address.port), error);
  if (error || found.empty()) {
    return network(address.text(), "there is no such host (" + error.message() + ")");
  }
  // IPv4 first: it is what boards speak, and what "localhost" means to most.
  for (const auto& entry : found) {
    if (entry.endpoint().address().is_v4()) return entry.endpoint();
  }
  return found.begin()->endpoint();
}

}  // namespace

struct UdpPort::Impl {
  // Asio throws where there are no descriptors left for it.
  static Result<std::unique_ptr<Impl>> make(const Address& to) {
    try {
      auto impl = std::make_unique<Impl>();
      impl->address = to;
      return impl;
    } catch (const asio::system_error& error) {
      return network(to.text(), std::string("cannot open a socket: ") + error.what());
    }
  }

  asio::io_context io{1};
  udp::socket socket{io};
  asio::steady_timer timer{io};
  Address address;
  Peer peer;
  bool connected = false;
  bool waits = false;
  bool segments = true;  // until the kernel says no
  std::atomic<bool> woken{false};
  bool unreachable = false;
  std::vector<Message> messages{kMessages};
  std::vector<mmsghdr> headers{kMessages};
  std::vector<std::byte> memory{std::vector<std::byte>(kMessages * kPiece)};

  ~Impl() {
    // The socket's pending wait is cancelled and its handler dropped with the context.
    asio::error_code ignored;
    socket.close(ignored);
  }

  Status set_up(const udp::endpoint& endpoint) {
    asio::error_code error;
    socket.open(endpoint.protocol(), error);
    if (error) return network(address.text(), "cannot open a socket: " + error.message());
    // Less than was asked for is no failure: the window follows what was given.
    socket.set_option(udp::socket::receive_buffer_size(kSocketBuffer), error);
    socket.set_option(udp::socket::send_buffer_size(kSocketBuffer), error);
    const int on = 1;
    ::setsockopt(socket.native_handle(), IPPROTO_UDP, UDP_GRO, &on, sizeof on);
    socket.non_blocking(true, error);
    return {};
  }

  // Sends messages[0, count). False where the kernel knows no segments.
  bool send_messages(std::size_t count) {
    std::size_t sent = 0;
    while (sent < count) {
      const int n = ::sendmmsg(socket.native_handle(), headers.data() + sent,
                               static_cast<unsigned>(count - sent), 0);
      if (n > 0) {
        sent += static_cast<std::size_t>(n);
        continue;
      }
      if (errno == EINTR) continue;
      if (errno == EAGAIN || errno == EWOULDBLOCK) {
        pollfd ready{socket.native_handle(), POLLOUT, 0};
        if (::poll(&ready, 1, 20) > 0) continue;
        return true;  // the rest is lost
      }
      if (errno == ECONNREFUSED) {
        unreachable = true;
        continue;  // of an earlier datagram; the error is cleared by telling
      }
      const bool was_train = headers[sent].msg_hdr.msg_controllen > 0;
      if (was_train && (errno == EIO || errno == EINVAL || errno == EOPNOTSUPP)) return false;
      ++sent;  // this one is lost
    }
    return true;
  }

  void prepare(std::size_t i, std::span<const std::byte> bytes, const Peer& to,
               std::size_t segment) {
    Message& message = messages[i];
    message.bytes = {const_cast<std::byte*>(bytes.data()), bytes.size()};
    msghdr& header = headers[i].msg_hdr;
    header = {};
    header.msg_iov = &message.bytes;
    header.msg_iovlen = 1;
    if (!connected) {
      message.endpoint = endpoint_of(to);
      header.msg_name = message.endpoint.data();
      header.msg_namelen = static_cast<socklen_t>(message.endpoint.size());
    }
    if (segment == 0) return;
    header.msg_control = message.control.data();
    header.msg_controllen = CMSG_SPACE(sizeof(std::uint16_t));
    cmsghdr* control = CMSG_FIRSTHDR(&header);
    control->cmsg_level = IPPROTO_UDP;
    control->cmsg_type = UDP_SEGMENT;
    control->cmsg_len = CMSG_LEN(sizeof(std::uint16_t));
    const auto size = static_cast<std::uint16_t>(segment);
    std::memcpy(CMSG_DATA(control), &size, sizeof size);
  }

  void send(const Outbox& out) {
    const auto entries = out.entries();
    for (std::size_t at = 0; at < entries.size();) {
      const std::size_t begin = at;
      std::size_t count = 0;
      for (; count < kMessages && at < entries.size(); ++count) {
        const Outbox::Entry& first = entries[at];
        std::size_t end = at + 1, bytes = first.bytes;
        // Equal frames to one peer, and a shorter one at the end.
        while (segments && end < entries.size() && end - at < kMostSegments &&
               entries[end - 1].bytes == first.bytes && entries[end].bytes <= first.bytes &&
               entries[end].peer == first.peer && bytes + entries[end].bytes <= kMostTrain) {
          bytes += entries[end++].bytes;
        }
        const std::span train(out.datagram(first).data(), bytes);
        prepare(count, train, first.peer, end - at > 1 ? first.bytes : 0);
        at = end;
      }
      if (!send_messages(count)) {
        segments = false;
        at = begin;  // those that went already come twice, which does no harm
      }
    }
  }

  std::size_t receive(const Take& take) {
    for (std::size_t i = 0; i < kMessages; ++i) {
      Message& message = messages[i];
      message.bytes = {memory.data() + i * kPiece, kPiece};
      msghdr& header = headers[i].msg_hdr;
      header = {};
      header.msg_iov = &message.bytes;
      header.msg_iovlen = 1;
      header.msg_control = message.control.data();
      header.msg_controllen = message.control.size();
      header.msg_name = message.endpoint.data();
      header.msg_namelen = static_cast<socklen_t>(message.endpoint.capacity());
    }
    const int n =
        ::recvmmsg(socket.native_handle(), headers.data(), kMessages, MSG_DONTWAIT, nullptr);
    if (n < 0 && errno == ECONNREFUSED) unreachable = true;
    std::size_t datagrams = 0;
    for (int i = 0; i < n; ++i) {
      const auto index = static_cast<std::size_t>(i);
      datagrams += split(messages[index], headers[index], take);
    }
    return datagrams;
  }

  std::size_t split(Message& message, mmsghdr& received, const Take& take) const {
    msghdr& header = received.msg_hdr;
    const std::size_t bytes = received.msg_len;
    std::size_t segment = bytes;
    for (cmsghdr* c = CMSG_FIRSTHDR(&header); c != nullptr; c = CMSG_NXTHDR(&header, c)) {
      if (c->cmsg_level != IPPROTO_UDP || c->cmsg_type != UDP_GRO) continue;
      int size = 0;
      std::memcpy(&size, CMSG_DATA(c), sizeof size);
      if (size > 0) segment = static_cast<std::size_t>(size);
    }
    message.endpoint.resize(header.msg_namelen);
    const Peer from = connected ? peer : peer_of(message.endpoint);
    const std::span<const std::byte> all(static_cast<const std::byte*>(message.bytes.iov_base),
                                         bytes);
    if (bytes == 0) {
      take(all, from);
      return 1;
    }
    std::size_t datagrams = 0;
    for (std::size_t at = 0; at < bytes; at += segment, ++datagrams) {
      take(all.subspan(at, std::min(segment, bytes - at)), from);
    }
    return datagrams;
  }

  void wait(Micros time) {
    if (woken.exchange(false)) return;
    if (!waits) {
      waits = true;
      socket.async_wait(udp::socket::wait_read, [this](const asio::error_code&) { waits = false; });
    }
    io.restart();
    // Waiting for events is good to a millisecond, which is long on a fast link; timers are better.
    if (time < kFineWait) {
      timer.expires_after(std::chrono::microseconds(time));
      timer.async_wait([](const asio::error_code&) {});
      io.run_one();
      timer.cancel();
      io.poll();  // its handler is not to end the next wait
    } else {
      io.run_one_for(std::chrono::microseconds(std::min<Micros>(time, 1'000'000)));
    }
    woken = false;
  }
};

UdpPort::UdpPort(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
UdpPort::UdpPort(UdpPort&&) noexcept = default;
UdpPort& UdpPort::operator=(UdpPort&&) noexcept = default;
UdpPort::~UdpPort() = default;

Result<UdpPort> UdpPort::listen(const Address& address) {
  Result<std::unique_ptr<Impl>> made = Impl::make(address);
  if (!made.ok()) return made.status();
  std::unique_ptr<Impl> impl = std::move(made).value();
  const Result<udp::endpoint> endpoint = resolve(impl->io, address);
  if (!endpoint.ok()) return endpoint.status();
  if (Status s = impl->set_up(endpoint.value()); !s.ok()) return s;
  asio::error_code error;
  impl->socket.bind(endpoint.value(), error);
  if (error) {
    return network(address.text(), "cannot listen there: " + error.message() +
                                       "; is another server running, or the address not this "
                                       "machine's?");
  }
  impl->address = address_of(impl->socket.local_endpoint(error));
  return UdpPort(std::move(impl));
}

Result<UdpPort> UdpPort::connect(const Address& address) {
  Result<std::unique_ptr<Impl>> made = Impl::make(address);
  if (!made.ok()) return made.status();
  std::unique_ptr<Impl> impl = std::move(made).value();
  const Result<udp::endpoint> endpoint = resolve(impl->io, address);
  if (!endpoint.ok()) return endpoint.status();
  if (Status s = impl->set_up(endpoint.value()); !s.ok()) return s;
  asio::error_code error;
  impl->socket.connect(endpoint.value(), error);
  if (error) return network(address.text(), "cannot be reached: " + error.message());
  impl->connected = true;
  impl->peer = peer_of(endpoint.value());
  return UdpPort(std::move(impl));
}

const Address& UdpPort::address() const {
  return impl_->address;
}

const Peer& UdpPort::peer() const {
  return impl_->peer;
}

std::uint64_t UdpPort::receive_buffer_bytes() const {
  asio::error_code error;
  udp::socket::receive_buffer_size size;
  impl_->socket.get_option(size, error);
  return error ? 0 : static_cast<std::uint64_t>(std::max(size.value(), 0));
}

void UdpPort::send(const Outbox& out) {
  impl_->send(out);
}

std::size_t UdpPort::receive(const Take& take) {
  return impl_->receive(take);
}

bool UdpPort::was_unreachable() {
  return std::exchange(impl_->unreachable, false);
}

void UdpPort::wait(Micros time) {
  impl_->wait(time);
}

void UdpPort::wake() {
  impl_->woken = true;
  asio::post(impl_->io, [] {});
}

std::string text_of(const Peer& peer) {
  return address_of(endpoint_of(peer)).text();
}

Micros micros_now() {
  return static_cast<Micros>(std::chrono::duration_cast<std::chrono::microseconds>(
                                 std::chrono::steady_clock::now().time_since_epoch())
                                 .count());
}

std::uint64_t random_session() {
  std::random_device device;
  std::uint64_t session = 0;
  while (session == 0) session = std::uint64_t{device()} << 32 | device();
  return session;
}

}  // namespace fasttree::device
