// SPDX-License-Identifier: Apache-2.0
#include "grid/grid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

namespace fasttree {

Grid::Grid(const Box3& bounds, AxisSchedule schedule, int depth)
    : bounds_(bounds),
      schedule_(schedule),
      levels_(make_axis_levels(bounds, schedule)),
      depth_(std::clamp(depth, 0, levels_.levels)),
      bits_(levels_.bits(depth_)) {
  for (std::size_t a = 0; a < 3; ++a) {
    quantisers_[a] = make_axis_quantiser(bounds, levels_, a);
    planes_[a] = make_planes(quantisers_[a], bounds.hi[a], bits_[a]);
    spread_[a].assign(std::size_t{1} << bits_[a], 0);
  }
  // Going over the levels from the last, each finds the next bit of its axis' coordinate.
  std::array<int, 3> bit{};
  for (int level = depth_ - 1; level >= 0; --level) {
    const auto a = static_cast<std::size_t>(axis_of_level(level));
    for (std::uint32_t k = 0; k < spread_[a].size(); ++k) {
      spread_[a][k] |= (k >> bit[a] & 1u) << (depth_ - 1 - level);
    }
    const int code_bit = depth_ - 1 - level;
    auto& gather = gather_[a][static_cast<std::size_t>(code_bit / 8)];
    for (std::uint32_t byte = 0; byte < 256; ++byte) {
      if (byte >> (code_bit % 8) & 1u) gather[byte] |= static_cast<std::uint16_t>(1u << bit[a]);
    }
    ++bit[a];
  }
}

CellBox Grid::cells_of(const std::array<Vec3, 3>& triangle) const {
  CellBox box = finest_cells_of(quantisers_, triangle);
  for (std::size_t a = 0; a < 3; ++a) {
    box.lo[a] >>= kMaxAxisBits - bits_[a];
    box.hi[a] >>= kMaxAxisBits - bits_[a];
  }
  return box;
}

Grid::Split Grid::split_below(std::uint32_t upper_code, int m) const {
  // The upper half begins at the cell whose code has the bits of upper_code down to m, then zeros.
  const auto a = static_cast<std::size_t>(axis_of_level(depth_ - 1 - m));
  const std::uint32_t k = coordinate_of(upper_code >> m << m, a);
  return {static_cast<std::uint32_t>(a), plane(a, k)};
}

TreeInfo Grid::tree_info(std::uint32_t triangle_count) const {
  TreeInfo info;
  info.profile = Profile::paper;
  info.axes = schedule_;
  info.depth = static_cast<std::uint8_t>(depth_);
  info.bits = bits_;
  info.triangle_count = triangle_count;
  info.bounds = bounds_;
  return info;
}

void ReferenceCounts::add(const AxisLevels& schedule, const CellBox& finest) {
  // Before the first halving the box is one cell; each level refines one axis.
  std::array<int, 3> bits{};
  std::array<std::uint64_t, 3> cells{1, 1, 1};
  at[0] += 1;
  for (int level = 0; level < schedule.levels; ++level) {
    const std::size_t a = schedule.axis[static_cast<std::size_t>(level)];
    const int shift = kMaxAxisBits - ++bits[a];
    cells[a] = (finest.hi[a] >> shift) - (finest.lo[a] >> shift) + 1;
    at[static_cast<std::size_t>(level) + 1] += cells[0] * cells[1] * cells[2];
  }
}

void ReferenceCounts::add(const ReferenceCounts& other) {
  for (std::size_t d = 0; d < at.size(); ++d) at[d] += other.at[d];
}

CellBox finest_cells_of(const std::array<AxisQuantiser, 3>& quantisers,
                        const std::array<Vec3, 3>& triangle) {
  CellBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint32_t q0 = quantisers[a](triangle[0][a]);
    const std::uint32_t q1 = quantisers[a](triangle[1][a]);
    const std::uint32_t q2 = quantisers[a](triangle[2][a]);
    box.lo[a] = std::min({q0, q1, q2});
    box.hi[a] = std::max({q0, q1, q2});
  }
  return box;
}

ReferenceCounts count_references(const MeshView& mesh, const Box3& bounds, AxisSchedule schedule) {
  const AxisLevels levels = make_axis_levels(bounds, schedule);
  const std::array<AxisQuantiser, 3> quantisers{make_axis_quantiser(bounds, levels, 0),
                                                make_axis_quantiser(bounds, levels, 1),
                                                make_axis_quantiser(bounds, levels, 2)};
  ReferenceCounts counts;
  counts.levels = levels.levels;
  for (std::uint32_t t = 0; t < mesh.triangle_count; ++t) {
    counts.add(levels, finest_cells_of(quantisers, mesh.triangle(t)));
  }
  return counts;
}

Result<int> choose_depth(const ReferenceCounts& counts, std::uint32_t triangle_count,
                         const BuildSettings& settings) {
  if (settings.depth != kAutoDepth && (settings.depth < 0 || settings.depth > kMaxDepth)) {
    return Status(StatusCode::invalid_argument,
                  "depth " + std::to_string(settings.depth) + " is outside 0 to " +
                      std::to_string(kMaxDepth) + "; leave it automatic or choose one inside");
  }
  if (!(settings.max_growth >= 1.0)) {
    return Status(StatusCode::invalid_argument,
                  "max_growth " + std::to_string(settings.max_growth) +
                      " is under 1, but every triangle has at least one reference");
  }
  const auto references = [&](int depth) { return counts.at[static_cast<std::size_t>(depth)]; };

  int depth = 0;
  if (settings.depth != kAutoDepth) {
    depth = std::min(settings.depth, counts.levels);
  } else if (triangle_count > 0) {
    const int log2 = std::bit_width(triangle_count - 1);  // ceil(log2 N)
    const int extra = std::clamp(settings.extra_depth, -kMaxDepth, kMaxDepth);
    const int most = std::min({std::max(log2 + extra, 0), counts.levels, kMaxAutoDepth});
    const double limit = settings.max_growth * triangle_count;
    while (depth < most && static_cast<double>(references(depth + 1)) <= limit) ++depth;
  }

  // The first index of a leaf has 32 bits; L <= M keeps the nodes within their 30 bits only where
  // M does, so that is the stricter limit: 2 L - 1 nodes.
  if (references(depth) > kMaxNodes / 2) {
    return Status(StatusCode::resource_limit,
                  "depth " + std::to_string(depth) + " makes " + std::to_string(references(depth)) +
                      " references of " + std::to_string(triangle_count) +
                      " triangles; a tree holds at most " + std::to_string(kMaxNodes / 2) +
                      ". Ask for a smaller depth.");
  }
  return depth;
}

}  // namespace fasttree
