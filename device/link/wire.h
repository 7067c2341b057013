// SPDX-License-Identifier: Apache-2.0
// Numbers at fixed places of a byte span, little-endian, at any alignment.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

namespace fasttree::device {

// Coordinates, nodes and ids cross as they lie in memory.
static_assert(std::endian::native == std::endian::little, "the wire is little-endian");

template <typename T>
void put(std::span<std::byte> to, std::size_t at, T value) {
  std::memcpy(to.data() + at, &value, sizeof value);
}

template <typename T>
T get(std::span<const std::byte> from, std::size_t at) {
  T value;
  std::memcpy(&value, from.data() + at, sizeof value);
  return value;
}

/// Text in a field of fixed size: cut where it is too long, zeros behind.
inline void put_text(std::span<std::byte> to, std::size_t at, std::size_t size,
                     std::string_view text) {
  const std::size_t used = text.size() < size ? text.size() : size;
  std::memset(to.data() + at, 0, size);
  if (used > 0) std::memcpy(to.data() + at, text.data(), used);
}

/// Up to the first zero. Bytes that are no printable ASCII become '?': it will be shown to people.
inline std::string get_text(std::span<const std::byte> from, std::size_t at, std::size_t size) {
  std::string text;
  for (std::size_t i = 0; i < size && from[at + i] != std::byte{0}; ++i) {
    const char c = static_cast<char>(from[at + i]);
    text += c >= ' ' && c <= '~' ? c : '?';
  }
  return text;
}

}  // namespace fasttree::device
