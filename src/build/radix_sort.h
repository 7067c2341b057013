// SPDX-License-Identifier: Apache-2.0
// Step 3, fast: a stable parallel radix sort of references by their code.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace fasttree::build {

/// One of the two buffers the sort goes back and forth between.
struct ReferenceSpan {
  std::span<std::uint32_t> codes;
  std::span<std::uint32_t> ids;
};

/// Rounds a sort of `key_bits` takes: 0 where all keys are equal.
int radix_sort_rounds(int key_bits);

/// Sorts by the lowest `key_bits` bits. The input lies in `a`; the output in `a` where the number
/// of rounds is even, else in `b`. The result of a stable sort is unique, so it does not depend on
/// the number of threads. `counters` is scratch memory that is kept from call to call.
void radix_sort(ReferenceSpan a, ReferenceSpan b, int key_bits,
                std::vector<std::uint32_t>& counters);

}  // namespace fasttree::build
