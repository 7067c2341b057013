// SPDX-License-Identifier: Apache-2.0
// What every test of a verilated unit needs: a clock, reset, random back-pressure, assertions seen.
#pragma once

#include <verilated.h>

#include <cstdint>
#include <memory>
#include <random>
#include <string>

#include "rtl/bench/coverage.h"

namespace fasttree::rtl {

/// A verilated unit with its clock. Inputs are set between cycles; combinational outputs are looked
/// at after settle().
template <typename Model>
class Bench {
 public:
  explicit Bench(std::uint32_t seed = 1) : context_(seed), random_(seed), unit(&context_) {
    reset();
  }
  ~Bench() {
    unit.final();
    add_coverage(context_);
    // A model's destructor goes to the thread's context, which may be a later bench's.
    Verilated::threadContextp(&context_);
  }

  void reset() {
    if constexpr (requires(Model m) { m.rst = 1; }) unit.rst = 1;
    for (int i = 0; i < 2; ++i) cycle();
    if constexpr (requires(Model m) { m.rst = 1; }) unit.rst = 0;
    settle();
  }

  /// Combinational outputs follow the inputs.
  void settle() { unit.eval(); }

  /// One rising edge.
  void cycle() {
    unit.clk = 0;
    unit.eval();
    unit.clk = 1;
    unit.eval();
    ++cycles_;
  }

  std::uint64_t cycles() const { return cycles_; }

  /// True with a probability of `percent` in a hundred.
  bool chance(unsigned percent) { return random_() % 100 < percent; }
  std::uint32_t random() { return random_(); }

  /// Assertions of the RTL that have failed so far.
  int failed_assertions() const { return context_.errorCount(); }

 private:
  /// Set before the unit is made, whose registers begin at random.
  struct Context : VerilatedContext {
    explicit Context(std::uint32_t seed) {
      randReset(2);
      randSeed(static_cast<int>(seed));
      fatalOnError(false);
    }
  };
  Context context_;
  std::mt19937 random_;
  std::uint64_t cycles_ = 0;

 public:
  Model unit;
};

/// Word i of a wide port, whatever Verilator made of it.
template <typename Port>
void set_word(Port& port, std::size_t i, std::uint32_t value) {
  if constexpr (std::is_integral_v<Port>) {
    if constexpr (sizeof(Port) == 8) {
      port = (port & ~(std::uint64_t{0xffffffff} << (32 * i))) | std::uint64_t{value} << (32 * i);
    } else {
      port = static_cast<Port>(value);
    }
  } else {
    port[i] = value;
  }
}
template <typename Port>
std::uint32_t get_word(const Port& port, std::size_t i) {
  if constexpr (std::is_integral_v<Port>) {
    return static_cast<std::uint32_t>(static_cast<std::uint64_t>(port) >> (32 * i));
  } else {
    return port[i];
  }
}

}  // namespace fasttree::rtl
