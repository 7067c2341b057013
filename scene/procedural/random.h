// SPDX-License-Identifier: Apache-2.0
// Random numbers by counter: number i of a stream needs no number before it, so that scenes are the
// same on every machine and for every number of threads.
#pragma once

#include <cstdint>

namespace fasttree::scene {

/// The finaliser of SplitMix64 (Steele, Lea and Flood 2014): 64 well-mixed bits of a counter.
inline std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// Uniform in [0, 1), 53 bits: number `index` of stream `stream`.
inline double uniform(std::uint64_t stream, std::uint64_t index) {
  return static_cast<double>(mix(mix(stream) ^ index) >> 11) * 0x1p-53;
}

}  // namespace fasttree::scene
