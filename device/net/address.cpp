// SPDX-License-Identifier: Apache-2.0
#include "device/net/address.h"

#include <charconv>
#include <string_view>

namespace fasttree::device {
namespace {

Status wrong(const std::string& text) {
  return {StatusCode::invalid_argument,
          "'" + text + "' is not an address; give HOST, HOST:PORT or [IPV6]:PORT, such as " +
              "127.0.0.1:" + std::to_string(kDefaultPort)};
}

}  // namespace

std::string Address::text() const {
  const bool v6 = host.find(':') != std::string::npos;
  return (v6 ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

Result<Address> parse_address(const std::string& text) {
  constexpr std::string_view kScheme = "udp://";
  std::string_view rest = text;
  if (rest.starts_with(kScheme)) rest.remove_prefix(kScheme.size());
  if (rest.ends_with('/')) rest.remove_suffix(1);
  Address address;
  std::string_view port;
  bool has_port = false;
  if (rest.starts_with('[')) {
    const std::size_t end = rest.find(']');
    if (end == std::string_view::npos || end == 1) return wrong(text);
    address.host = rest.substr(1, end - 1);
    rest.remove_prefix(end + 1);
    has_port = rest.starts_with(':');
    if (!rest.empty() && !has_port) return wrong(text);
    port = rest.substr(rest.empty() ? 0 : 1);
  } else {
    const std::size_t colon = rest.rfind(':');
    if (colon != std::string_view::npos && rest.find(':') != colon) return wrong(text);
    has_port = colon != std::string_view::npos;
    const std::string_view host = rest.substr(0, colon);
    if (!host.empty()) address.host = host;
    if (host.empty() && !has_port) return wrong(text);
    if (has_port) port = rest.substr(colon + 1);
  }
  if (address.host.find_first_of(" /@?#") != std::string::npos) return wrong(text);
  if (has_port) {
    const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), address.port);
    if (error != std::errc() || end != port.data() + port.size() || port.empty()) {
      return wrong(text);
    }
  }
  return address;
}

}  // namespace fasttree::device
