// SPDX-License-Identifier: Apache-2.0
// XXH3 with 64 bits, fed piece by piece. The one place that knows of xxHash, whose header is
// compiled in, so that nothing is needed at run time.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace fasttree {

class Xxh3 {
 public:
  Xxh3() { XXH3_64bits_reset(&state_); }
  Xxh3(const Xxh3&) = delete;  // the state points into itself
  Xxh3& operator=(const Xxh3&) = delete;

  /// Bytes as they lie in memory.
  void bytes(std::span<const std::byte> data) {
    XXH3_64bits_update(&state_, data.data(), data.size());
  }

  /// A contiguous range of 32-bit words, or of structs that are nothing but such words, as
  /// little-endian bytes whatever the machine's order.
  template <typename Range>
  void little_endian_words(const Range& range) {
    const std::span items(range);
    using Item = typename decltype(items)::element_type;
    static_assert(std::has_unique_object_representations_v<Item> && sizeof(Item) % 4 == 0);
    const std::span<const std::byte> data = std::as_bytes(items);
    if constexpr (std::endian::native == std::endian::little) {
      bytes(data);
    } else {
      for (std::size_t i = 0; i < data.size(); i += 4) {
        const std::array<std::byte, 4> word{data[i + 3], data[i + 2], data[i + 1], data[i]};
        bytes(word);
      }
    }
  }

  std::uint64_t digest() const { return XXH3_64bits_digest(&state_); }

 private:
  XXH3_state_t state_;
};

}  // namespace fasttree
