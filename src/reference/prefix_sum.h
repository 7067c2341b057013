// SPDX-License-Identifier: Apache-2.0
// Prefix sums in sections of 32 (PSU), shared by steps 2 and 3. Docs: docs/prefix_sum.md.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace fasttree::reference {

inline constexpr std::size_t kSection = 32;

/// One section in place: up-sweep, then down-sweep (Blelloch). Exclusive; returns the total.
/// Sums are modulo 2^32, as in the hardware's registers.
std::uint32_t prefix_sum_section(std::array<std::uint32_t, kSection>& section);

/// A whole array in place: each section by itself, the sections' totals the same way, then each
/// total added to its section as an offset. Exclusive; returns the total.
std::uint32_t prefix_sum(std::span<std::uint32_t> values);

}  // namespace fasttree::reference
