// SPDX-License-Identifier: Apache-2.0
#include "build/radix_sort.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <utility>

namespace fasttree::build {
namespace {

constexpr int kDigitBits = 8;
constexpr std::size_t kRadix = std::size_t{1} << kDigitBits;
// References that one task counts and scatters in order. Large enough for the counters to be few.
constexpr std::size_t kChunk = std::size_t{1} << 15;

}  // namespace

int radix_sort_rounds(int key_bits) {
  return (key_bits + kDigitBits - 1) / kDigitBits;
}

void radix_sort(ReferenceSpan a, ReferenceSpan b, int key_bits,
                std::vector<std::uint32_t>& counters) {
  const std::size_t size = a.codes.size();
  const std::size_t chunks = (size + kChunk - 1) / kChunk;
  const int rounds = radix_sort_rounds(key_bits);
  counters.resize(chunks * kRadix);
  for (int round = 0; round < rounds; ++round) {
    // Digits of equal width keep the scatter's streams few.
    const int bits = (key_bits + rounds - 1) / rounds;
    const int shift = round * bits;
    const std::size_t radix = std::size_t{1} << bits;
    const std::uint32_t mask = static_cast<std::uint32_t>(radix - 1);

    tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
      std::uint32_t* const count = &counters[chunk * kRadix];
      std::fill_n(count, radix, 0u);
      const std::size_t end = std::min(size, (chunk + 1) * kChunk);
      for (std::size_t i = chunk * kChunk; i < end; ++i) ++count[a.codes[i] >> shift & mask];
    });

    // Digit by digit, chunk by chunk: where each chunk's references of a digit begin.
    std::uint32_t begin = 0;
    for (std::size_t digit = 0; digit < radix; ++digit) {
      for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        begin += std::exchange(counters[chunk * kRadix + digit], begin);
      }
    }

    tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
      std::uint32_t* const place = &counters[chunk * kRadix];
      const std::size_t end = std::min(size, (chunk + 1) * kChunk);
      for (std::size_t i = chunk * kChunk; i < end; ++i) {
        const std::uint32_t to = place[a.codes[i] >> shift & mask]++;
        b.codes[to] = a.codes[i];
        b.ids[to] = a.ids[i];
      }
    });
    std::swap(a, b);
  }
}

}  // namespace fasttree::build
