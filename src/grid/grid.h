// SPDX-License-Identifier: Apache-2.0
// The regular division of the scene's bounds that all embodiments share: cells, Morton codes,
// planes, the number of references at every depth, and the rule that picks a depth.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "fasttree/build.h"
#include "fasttree/mesh.h"
#include "fasttree/tree.h"
#include "grid/axis_schedule.h"
#include "grid/quantiser.h"

namespace fasttree {

/// A cell by its coordinates, or the corner of a box of cells.
using Cell = std::array<std::uint32_t, 3>;

/// A box of cells, both corners included.
struct CellBox {
  Cell lo{};
  Cell hi{};

  std::uint64_t count() const {
    return std::uint64_t{hi[0] - lo[0] + 1} * (hi[1] - lo[1] + 1) * (hi[2] - lo[2] + 1);
  }
};

/// The grid of one depth over given bounds.
class Grid {
 public:
  Grid() : Grid(Box3{{0, 0, 0}, {0, 0, 0}}, AxisSchedule::cyclic, 0) {}

  /// `depth` is lowered to the levels the bounds allow (AxisLevels::levels).
  Grid(const Box3& bounds, AxisSchedule schedule, int depth);

  const Box3& bounds() const { return bounds_; }
  AxisSchedule schedule() const { return schedule_; }
  int depth() const { return depth_; }
  int axis_of_level(int level) const { return levels_.axis[static_cast<std::size_t>(level)]; }
  const std::array<std::uint8_t, 3>& bits() const { return bits_; }
  const AxisQuantiser& quantiser(std::size_t axis) const { return quantisers_[axis]; }

  /// q(v) at this depth.
  std::uint32_t quantise(std::size_t axis, float v) const {
    return quantisers_[axis](v) >> (kMaxAxisBits - bits_[axis]);
  }

  /// The cells of a triangle's box.
  CellBox cells_of(const std::array<Vec3, 3>& triangle) const;

  /// The Morton code of a cell: level l is bit depth-1-l and holds the next bit of its axis.
  std::uint32_t morton_code(const Cell& cell) const {
    return spread_[0][cell[0]] | spread_[1][cell[1]] | spread_[2][cell[2]];
  }

  /// The cell with a Morton code, and its coordinate on one axis.
  Cell cell_of(std::uint32_t code) const {
    return {coordinate_of(code, 0), coordinate_of(code, 1), coordinate_of(code, 2)};
  }
  std::uint32_t coordinate_of(std::uint32_t code, std::size_t axis) const {
    const auto& gather = gather_[axis];
    return static_cast<std::uint32_t>(gather[0][code & 255] | gather[1][code >> 8 & 255] |
                                      gather[2][code >> 16 & 255] | gather[3][code >> 24]);
  }

  /// The plane below cell k of an axis, 1 <= k < 2^bits.
  float plane(std::size_t axis, std::uint32_t k) const { return planes_[axis][k]; }

  /// The split of the internal node between leaf codes a < b whose highest different bit is m.
  struct Split {
    std::uint32_t axis = 0;
    float position = 0.0f;
  };
  Split split_below(std::uint32_t upper_code, int m) const;

  /// The part of a tree's info that the grid knows.
  TreeInfo tree_info(std::uint32_t triangle_count) const;

 private:
  Box3 bounds_;
  AxisSchedule schedule_;
  AxisLevels levels_;
  int depth_;
  std::array<std::uint8_t, 3> bits_;
  std::array<AxisQuantiser, 3> quantisers_;
  std::array<std::vector<std::uint32_t>, 3> spread_;  // cell coordinate to its bits of the code
  // Each byte of a code to its bits of an axis' coordinate.
  std::array<std::array<std::array<std::uint16_t, 256>, 4>, 3> gather_{};
  std::array<std::vector<float>, 3> planes_;
};

/// M(D) for every depth of a schedule.
struct ReferenceCounts {
  std::array<std::uint64_t, kMaxDepth + 1> at{};  ///< at[D], D <= levels
  int levels = 0;

  void add(const AxisLevels& schedule, const CellBox& finest);
  void add(const ReferenceCounts& other);
};

/// A triangle's cells at the finest grid, 15 bits an axis; those of a depth are its shifts.
CellBox finest_cells_of(const std::array<AxisQuantiser, 3>& quantisers,
                        const std::array<Vec3, 3>& triangle);

/// Counts without emitting: one pass over the triangles, 64-bit counters.
ReferenceCounts count_references(const MeshView& mesh, const Box3& bounds, AxisSchedule schedule);

/// The depth to build with, or why not: settings.depth where it is given (lowered to the levels
/// there are), else the smaller of ceil(log2 N) + k and the largest D with M(D) <= growth * N, at
/// most 27. resource_limit where M(D) exceeds what 32-bit first indices can name;
/// invalid_argument for settings out of range.
Result<int> choose_depth(const ReferenceCounts& counts, std::uint32_t triangle_count,
                         const BuildSettings& settings);

}  // namespace fasttree
