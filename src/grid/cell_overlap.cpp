// SPDX-License-Identifier: Apache-2.0
#include "grid/cell_overlap.h"

namespace fasttree {

// In a file of its own: once GCC has put it into a loop, it makes no vectors of it any more.
bool CellOverlap::at(float x, float y, float z) const {
  if (!tested_) return true;
  // All lines at once and in two loops, which compilers make vectors of: what leaving early would
  // save is less than what mispredicting it costs.
  std::array<float, kLines> value;
  for (std::size_t i = 0; i < kLines; ++i) {
    value[i] = ((x_[i] * x + y_[i] * y) + z_[i] * z) + base_[i];
  }
  std::uint32_t any = 0;
  for (std::size_t i = 0; i < kLines; ++i) any |= value[i] < 0.0f ? 1u : 0u;
  return any == 0;
}

}  // namespace fasttree
