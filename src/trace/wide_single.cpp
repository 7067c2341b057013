// SPDX-License-Identifier: Apache-2.0
// Rays that go their own ways: each by itself, two at a time, so that one computes while the other
// waits for memory. Compiled once for every instruction set.
#include <algorithm>
#include <bit>
#include <vector>

#include "geometry/triangle_intersection.h"
#include "trace/wide_trace.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trace/wide_single.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as Highway asks.
#include <hwy/highway.h>

#include "trace/ray_block-inl.h"
#include "trace/wide_kernels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fasttree {
namespace HWY_NAMESPACE {
#if HWY_TARGET == HWY_SCALAR

// Without vectors the kd-tree itself is the better way.
void SingleClosest(const WideScene&, const WideBatch& batch) {
  leave_all(batch);
}
void SingleOccluded(const WideScene&, const WideBatch& batch) {
  leave_all(batch);
}

#else
namespace {

constexpr std::size_t kStack = kMostWideLevels * kWide + kWide;

struct RayState {
  ShearedRay sheared;
  float t_min, t_best;
  std::array<float, 3> reciprocal, near_offset, far_offset;
  std::array<std::uint32_t, 3> near_row, far_row;  // of WideNode::bound
  std::uint32_t octant;
  std::size_t ray;
  Hit best;
  std::size_t depth;
  HWY_ALIGN float enters[kStack];
  HWY_ALIGN std::uint32_t entries[kStack];
};

HWY_INLINE void Visit(const WideNode* nodes, std::uint32_t index, RayState& s) {
  const DF d;
  const WideNode& node = nodes[index];
  const float* const bound = &node.bound[0][0][0];
  Intervals t;
  for (std::size_t k = 0, i = 0; k < Intervals::kVectors; ++k, i += hn::Lanes(d)) {
    const auto at = [&](const auto& rows, const auto& offsets, std::size_t a) HWY_ATTR {
      return hn::MulSub(hn::Load(d, bound + rows[a] + i), hn::Set(d, s.reciprocal[a]),
                        hn::Set(d, offsets[a]));
    };
    t.enter[k] =
        hn::Max(hn::Max(at(s.near_row, s.near_offset, 0), at(s.near_row, s.near_offset, 1)),
                hn::Max(at(s.near_row, s.near_offset, 2), hn::Set(d, s.t_min)));
    t.leave[k] = hn::Min(hn::Min(at(s.far_row, s.far_offset, 0), at(s.far_row, s.far_offset, 1)),
                         hn::Min(at(s.far_row, s.far_offset, 2), hn::Set(d, s.t_best)));
  }
  s.depth = Push(node, index, s.octant, t, s.entries, s.enters, s.depth);
}

// Tests the triangles of a leaf. True where any hit is enough and there is one.
template <bool kAny>
HWY_INLINE bool TestLeaf(const WideLayout& layout, std::uint32_t first, std::uint32_t n,
                         RayState& s) {
  return ForEachHit(
      layout, first, n, s.sheared, s.t_min, [&] { return s.t_best; },
      [&](std::uint32_t reference, float t, float u, float v) {
        if (kAny) {
          s.best.triangle = 0;
          return true;
        }
        const std::uint32_t id = layout.ids[reference];
        if (t < s.best.t || id < s.best.triangle) {
          s.best = {t, id, u, v};
          s.t_best = t;
        }
        return false;
      });
}

// One entry of the stack. False: the ray is done.
template <bool kAny, bool kCount>
HWY_INLINE bool Step(const WideLayout& layout, RayState& s, TraceCounters* counters) {
  do {
    if (s.depth == 0) return false;
    --s.depth;
  } while (s.enters[s.depth] > s.t_best);
  const std::uint32_t entry = s.entries[s.depth];
  const WideNode& node = layout.nodes[entry >> 4];
  const std::uint32_t slot = entry & 15;
  const std::uint32_t n = node.count[slot];
  if (n == 0) {
    if (kCount) ++counters->inner_steps;
    Visit(layout.nodes.data(), node.child[slot], s);
    return true;
  }
  if (kCount) {
    ++counters->leaf_visits;
    counters->triangle_tests += n;
  }
  return !TestLeaf<kAny>(layout, node.child[slot], n, s);
}

// Takes a ray out of a block and visits the root.
HWY_INLINE void Begin(const WideScene& scene, const RayBlock& block, std::size_t i, std::size_t ray,
                      RayState& s) {
  s.ray = ray;
  s.best = {};
  const auto k = AxesOf(block.way[i]);
  s.sheared.kx = k[0];
  s.sheared.ky = k[1];
  s.sheared.kz = k[2];
  s.sheared.sx = block.sx[i];
  s.sheared.sy = block.sy[i];
  s.sheared.sz = block.sz[i];
  s.sheared.origin = {block.origin[0][i], block.origin[1][i], block.origin[2][i]};
  s.t_min = block.t_min[i];
  s.t_best = block.t[i];
  s.octant = OctantOf(block.way[i]);
  for (std::uint32_t a = 0; a < 3; ++a) {
    s.reciprocal[a] = block.reciprocal[a][i];
    s.near_offset[a] = block.near_offset[a][i];
    s.far_offset[a] = block.far_offset[a][i];
    const std::uint32_t down = s.octant >> a & 1;
    s.near_row[a] = (3 * down + a) * kWide;
    s.far_row[a] = (3 * (1 - down) + a) * kWide;
  }
  s.depth = 0;
  Visit(scene.layout->nodes.data(), 0, s);
}

template <bool kAny, bool kCount>
void TraceBatch(const WideScene& scene, const WideBatch& batch) {
  RayBlock block;
  RayState states[2];
  std::size_t begin = 0;  // of the block
  std::uint64_t waiting = 0;
  std::size_t next_block = 0;
  const auto load = [&](RayState& s) HWY_ATTR {
    while (waiting == 0) {
      if (next_block >= batch.rays.size()) return false;
      begin = next_block;
      waiting = PrepareBlock(scene, batch, begin, block);
      next_block += kPacket;
      // Those that are traced write their results over it.
      const std::size_t count = std::min(kPacket, batch.rays.size() - begin);
      if (kAny) {
        std::fill_n(batch.flags.data() + begin, count, std::uint8_t{0});
      } else {
        std::fill_n(batch.hits.data() + begin, count, Hit{});
      }
      PrefetchRays(batch, next_block);
    }
    const auto i = static_cast<std::size_t>(std::countr_zero(waiting));
    waiting &= waiting - 1;
    Begin(scene, block, i, begin + i, s);
    if (kCount) ++batch.counters->inner_steps;
    return true;
  };
  const auto go_on = [&](RayState& s) HWY_ATTR {
    if (Step<kAny, kCount>(*scene.layout, s, batch.counters)) return true;
    if (kAny) {
      batch.flags[s.ray] = s.best.hit();
    } else {
      batch.hits[s.ray] = s.best;
    }
    return load(s);
  };
  bool first = load(states[0]), second = load(states[1]);
  while (first && second) {
    first = go_on(states[0]);
    second = go_on(states[1]);
  }
  while (first) first = go_on(states[0]);
  while (second) second = go_on(states[1]);
}

}  // namespace

void SingleClosest(const WideScene& scene, const WideBatch& batch) {
  batch.counters ? TraceBatch<false, true>(scene, batch) : TraceBatch<false, false>(scene, batch);
}
void SingleOccluded(const WideScene& scene, const WideBatch& batch) {
  batch.counters ? TraceBatch<true, true>(scene, batch) : TraceBatch<true, false>(scene, batch);
}

#endif
}  // namespace HWY_NAMESPACE
}  // namespace fasttree
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fasttree {

HWY_EXPORT(SingleClosest);
HWY_EXPORT(SingleOccluded);

void leave_all(const WideBatch& batch) {
  for (std::size_t i = 0; i < batch.rays.size(); ++i) {
    batch.wild->push_back(static_cast<std::uint32_t>(i));
  }
}

void wide_closest(const WideScene& scene, const WideBatch& batch) {
  HWY_DYNAMIC_DISPATCH(SingleClosest)(scene, batch);
}
void wide_occluded(const WideScene& scene, const WideBatch& batch) {
  HWY_DYNAMIC_DISPATCH(SingleOccluded)(scene, batch);
}

}  // namespace fasttree
#endif  // HWY_ONCE
