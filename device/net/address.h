// SPDX-License-Identifier: Apache-2.0
// Where a device is: HOST:PORT, udp://HOST:PORT.
#pragma once

#include <cstdint>
#include <string>

#include "fasttree/status.h"

namespace fasttree::device {

inline constexpr std::uint16_t kDefaultPort = 18004;

struct Address {
  std::string host = "127.0.0.1";  ///< a name, an IPv4 or an IPv6 address
  std::uint16_t port = kDefaultPort;

  std::string text() const;
};

/// "HOST", "HOST:PORT", "[IPV6]:PORT", ":PORT" (loopback), with or without "udp://" before it.
/// invalid_argument where it is none of them.
Result<Address> parse_address(const std::string& text);

}  // namespace fasttree::device
