// SPDX-License-Identifier: Apache-2.0
// Compiled once for every instruction set by Highway's foreach_target; the plain C++ forms and the
// choice between them stand at the end.
#include "build/triangle_block.h"

#include <algorithm>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "build/triangle_block.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as Highway asks.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace fasttree::build {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

bool SceneBound(const TriangleBlock& block, Box3& bounds) {
  const hn::ScalableTag<float> d;
  const std::size_t lanes = std::min<std::size_t>(hn::Lanes(d), kBlock);
  const std::size_t count = block.count;
  const auto largest = hn::Set(d, std::numeric_limits<float>::max());
  auto outside = hn::MaskFromVec(hn::Zero(d));
  for (std::size_t a = 0; a < 3; ++a) {
    auto lo = hn::Set(d, std::numeric_limits<float>::infinity());
    auto hi = hn::Set(d, -std::numeric_limits<float>::infinity());
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < count; i += lanes) {
        const auto v = hn::Load(d, &block.corner[c][a][i]);
        outside = hn::Or(outside, hn::Not(hn::Le(hn::Abs(v), largest)));
        lo = hn::Min(lo, v);
        hi = hn::Max(hi, v);
      }
    }
    bounds.lo[a] = std::min(bounds.lo[a], hn::GetLane(hn::MinOfLanes(d, lo)));
    bounds.hi[a] = std::max(bounds.hi[a], hn::GetLane(hn::MaxOfLanes(d, hi)));
  }
  return hn::AllFalse(d, outside);
}

void Quantise(const TriangleBlock& block, const std::array<AxisQuantiser, 3>& quantisers,
              BoxBlock& boxes) {
  const hn::ScalableTag<float> d;
  const hn::RebindToSigned<decltype(d)> di;
  const hn::RebindToUnsigned<decltype(d)> du;
  const std::size_t lanes = std::min<std::size_t>(hn::Lanes(d), kBlock);
  const auto last = hn::Set(d, static_cast<float>(kFinestCells - 1));
  for (std::size_t a = 0; a < 3; ++a) {
    const auto origin = hn::Set(d, quantisers[a].lo);
    const auto scale = hn::Set(d, quantisers[a].scale);
    for (std::size_t i = 0; i < block.count; i += lanes) {
      const auto v0 = hn::Load(d, &block.corner[0][a][i]);
      const auto v1 = hn::Load(d, &block.corner[1][a][i]);
      const auto v2 = hn::Load(d, &block.corner[2][a][i]);
      // The quantiser is monotone, so the box can be taken first: two roundings instead of three.
      const auto q = [&](auto v) {
        const auto x = hn::Mul(hn::Sub(v, origin), scale);
        return hn::BitCast(du, hn::ConvertTo(di, hn::Min(hn::Max(x, hn::Zero(d)), last)));
      };
      hn::Store(q(hn::Min(v0, hn::Min(v1, v2))), du, &boxes.lo[a][i]);
      hn::Store(q(hn::Max(v0, hn::Max(v1, v2))), du, &boxes.hi[a][i]);
    }
  }
  boxes.count = block.count;
}

// Plain loops: the compiler vectorises them for the target this is compiled for.
void CountReferences(const BoxBlock& boxes, const AxisLevels& schedule, int levels,
                     ReferenceCounts& counts) {
  std::uint32_t cells[3][kBlock];
  for (auto& axis : cells) std::fill(axis, axis + kBlock, 1u);
  std::array<int, 3> bits{};
  counts.at[0] += boxes.count;
  for (int level = 0; level < levels; ++level) {
    const std::size_t a = schedule.axis[static_cast<std::size_t>(level)];
    const int shift = kMaxAxisBits - ++bits[a];
    std::uint64_t sum = 0;
    for (std::uint32_t i = 0; i < boxes.count; ++i) {
      cells[a][i] = (boxes.hi[a][i] >> shift) - (boxes.lo[a][i] >> shift) + 1;
      sum += cells[0][i] * cells[1][i] * cells[2][i];  // at most 2^30
    }
    counts.at[static_cast<std::size_t>(level) + 1] += sum;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace fasttree::build
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fasttree::build {

HWY_EXPORT(SceneBound);
HWY_EXPORT(Quantise);
HWY_EXPORT(CountReferences);

void gather(const MeshView& mesh, std::uint32_t first, std::uint32_t count, TriangleBlock& block) {
  const auto put = [&](std::uint32_t i, const std::array<Vec3, 3>& corners) {
    for (std::size_t c = 0; c < 3; ++c) {
      block.corner[c][0][i] = corners[c].x;
      block.corner[c][1][i] = corners[c].y;
      block.corner[c][2][i] = corners[c].z;
    }
  };
  block.count = count;
  for (std::uint32_t i = 0; i < count; ++i) put(i, mesh.triangle(first + i));
  if (count == 0 || count == kBlock) return;
  const auto last = mesh.triangle(first + count - 1);
  for (std::uint32_t i = count; i < kBlock; ++i) put(i, last);
}

bool scene_bound(Simd simd, const TriangleBlock& block, Box3& bounds) {
  if (simd == Simd::widest) return HWY_DYNAMIC_DISPATCH(SceneBound)(block, bounds);
  bool finite = true;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::uint32_t i = 0; i < block.count; ++i) {
      const Vec3 p{block.corner[c][0][i], block.corner[c][1][i], block.corner[c][2][i]};
      finite = finite && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
      bounds.include(p);
    }
  }
  return finite;
}

void quantise(Simd simd, const TriangleBlock& block, const std::array<AxisQuantiser, 3>& quantisers,
              BoxBlock& boxes) {
  if (simd == Simd::widest) return HWY_DYNAMIC_DISPATCH(Quantise)(block, quantisers, boxes);
  boxes.count = block.count;
  for (std::uint32_t i = 0; i < block.count; ++i) {
    std::array<Vec3, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) {
      corners[c] = {block.corner[c][0][i], block.corner[c][1][i], block.corner[c][2][i]};
    }
    const CellBox box = finest_cells_of(quantisers, corners);
    for (std::size_t a = 0; a < 3; ++a) {
      boxes.lo[a][i] = box.lo[a];
      boxes.hi[a][i] = box.hi[a];
    }
  }
}

void count_references(Simd simd, const BoxBlock& boxes, const AxisLevels& schedule, int levels,
                      ReferenceCounts& counts) {
  if (simd == Simd::widest) {
    return HWY_DYNAMIC_DISPATCH(CountReferences)(boxes, schedule, levels, counts);
  }
  AxisLevels first_levels = schedule;
  first_levels.levels = levels;
  for (std::uint32_t i = 0; i < boxes.count; ++i) {
    counts.add(first_levels, {{boxes.lo[0][i], boxes.lo[1][i], boxes.lo[2][i]},
                              {boxes.hi[0][i], boxes.hi[1][i], boxes.hi[2][i]}});
  }
}

const char* widest_simd_name() {
  // The lowest bit is the widest set.
  return hwy::TargetName(hwy::SupportedTargets() & -hwy::SupportedTargets());
}

}  // namespace fasttree::build
#endif  // HWY_ONCE
