// SPDX-License-Identifier: Apache-2.0
// What the model counts in: cycles of the accelerator's clock, picoseconds, byte addresses.
#pragma once

#include <compare>
#include <cstdint>

namespace fasttree::model {

/// A quantity that mixes with no other. Arithmetic as of the number inside.
template <typename Tag>
struct Quantity {
  std::uint64_t value = 0;

  constexpr Quantity() = default;
  constexpr explicit Quantity(std::uint64_t v) : value(v) {}
  friend constexpr auto operator<=>(Quantity, Quantity) = default;
  constexpr Quantity& operator+=(Quantity b) {
    value += b.value;
    return *this;
  }
  constexpr Quantity& operator-=(Quantity b) {
    value -= b.value;
    return *this;
  }
  friend constexpr Quantity operator+(Quantity a, Quantity b) { return a += b; }
  friend constexpr Quantity operator-(Quantity a, Quantity b) { return a -= b; }
};

using Cycles = Quantity<struct CyclesTag>;            ///< of the accelerator's own clock
using Picoseconds = Quantity<struct PicosecondsTag>;  ///< common time of accelerator and memory
using Address = Quantity<struct AddressTag>;          ///< of a byte in off-chip memory

}  // namespace fasttree::model
