// SPDX-License-Identifier: Apache-2.0
// Split planes on demand: the smallest float that the quantiser puts into a cell, found by trying
// floats next to where it would be without rounding. The last planes found are kept.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "model/fasttree2/registers.h"

namespace fasttree::model::ft2 {

/// The plane, and how often the quantiser was asked for it.
struct PlaneSearch {
  float plane = 0;
  std::uint32_t trials = 0;
};
PlaneSearch search_plane(const AxisQuantiser& quantiser, float hi, std::uint32_t finest_cell);

class SplitPlanes {
 public:
  explicit SplitPlanes(const Registers& registers);
  void begin();

  struct Answer {
    float plane = 0;
    std::uint32_t cycles = 0;  ///< until it is known
  };
  /// The plane below cell k of an axis.
  Answer find(std::size_t axis, std::uint32_t k);

  std::uint64_t hits() const { return hits_; }
  std::uint64_t misses() const { return misses_; }

 private:
  struct Entry {
    std::uint32_t k = 0;  ///< 0: empty, for there is no plane below cell 0
    float plane = 0;
  };
  const Registers& r_;
  std::array<std::vector<Entry>, 3> cache_;
  std::uint64_t hits_ = 0;
  std::uint64_t misses_ = 0;
};

}  // namespace fasttree::model::ft2
