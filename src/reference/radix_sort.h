// SPDX-License-Identifier: Apache-2.0
// Step 3 of 6, Morton code sort (RSU over PSUs). Docs: docs/radix_sort.md.
#pragma once

#include <cstdint>
#include <functional>

#include "reference/morton_code.h"

namespace fasttree::reference {

inline constexpr int kDigitBits = 4;
inline constexpr int kRadix = 1 << kDigitBits;
inline constexpr int kRounds = 32 / kDigitBits;

/// Stable sort by code: eight rounds of counting sort, least significant digit first, each a prefix
/// sum. `after_round`, where given, is told each round's number (0 to 7) and returns false to stop,
/// which leaves the references sorted by the digits so far.
References radix_sort(References references,
                      const std::function<bool(int round)>& after_round = nullptr);

/// One round: a stable counting sort by digit `round` of the codes, from `in` into `out`, which has
/// the same size.
void radix_sort_round(const References& in, References& out, int round);

}  // namespace fasttree::reference
