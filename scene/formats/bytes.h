// SPDX-License-Identifier: Apache-2.0
// Numbers in a file's bytes, of either byte order and any alignment.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

namespace fasttree::scene {

/// The T at `from`, stored in byte order `Order`. The caller makes sure that its bytes are there.
template <typename T, std::endian Order = std::endian::little>
T load(const std::byte* from) {
  std::array<std::byte, sizeof(T)> raw;
  std::memcpy(raw.data(), from, raw.size());
  if constexpr (Order != std::endian::native) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<T>(raw);
}

}  // namespace fasttree::scene
