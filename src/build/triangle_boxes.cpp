// SPDX-License-Identifier: Apache-2.0
// Compiled once for every instruction set, as vertex_codes.cpp is.
#include "build/triangle_boxes.h"

#include <tbb/blocked_range.h>
#include <tbb/combinable.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "build/triangle_boxes.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as Highway asks.
#include <hwy/highway.h>

#include "build/bit_spread-inl.h"

#ifndef FASTTREE_BUILD_TRIANGLE_BOXES_ONCE_
#define FASTTREE_BUILD_TRIANGLE_BOXES_ONCE_
namespace fasttree::build {

/// Triangles whose corners' codes are fetched together; whole vectors of any instruction set.
inline constexpr std::uint32_t kTrianglesPerBlock = 256;

/// What one task works on.
struct BoxTask {
  const MeshView& mesh;
  const Box3& bounds;
  std::span<const std::uint32_t> codes;
  const CodeAxes& axes;
  CodeBox* boxes;
  BoxPass found;

  /// Which sides the marked vertices of triangles first ... end - 1 touch.
  void look_at_touches(std::uint32_t first, std::uint32_t end) {
    for (std::uint32_t t = first; t < end; ++t) {
      for (std::uint32_t corner = 0; corner < 3; ++corner) {
        const std::uint32_t v = mesh.vertex_index(t, corner);
        if ((codes[v] & kTouchesBounds) == 0) continue;
        const Vec3 p = mesh.position(v);
        for (std::size_t a = 0; a < 3; ++a) {
          if (p[a] == bounds.lo[a]) found.touches |= 1u << a;
          if (p[a] == bounds.hi[a]) found.touches |= 8u << a;
        }
      }
    }
  }
};

}  // namespace fasttree::build
#endif

HWY_BEFORE_NAMESPACE();
namespace fasttree::build {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Takes whole vectors of triangles from `first` on and returns the first that is left.
#if HWY_TARGET == HWY_SCALAR
std::uint32_t BoxVectors(BoxTask&, std::uint32_t first, std::uint32_t) {
  return first;
}
#else
std::uint32_t BoxVectors(BoxTask& task, std::uint32_t first, std::uint32_t end) {
  const hn::ScalableTag<std::uint32_t> d;
  const hn::Repartition<std::uint64_t, decltype(d)> d64;
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
  const CodeAxes axes = task.axes;  // a copy: what `boxes` points to is not it
  const std::uint32_t* const codes = task.codes.data();
  const auto vertices = hn::Set(d, static_cast<std::uint32_t>(task.codes.size()));
  const auto touch = hn::Set(d, kTouchesBounds);
  const auto outside = hn::Set(d, kOutside);
  auto references = hn::Zero(d64);
  HWY_ALIGN std::uint32_t corners[3 * kTrianglesPerBlock];
  while (first + lanes <= end) {
    // The codes are fetched one by one into a block that stays in the cache: that many loads are
    // under way at once, where gathers wait for one another.
    const std::uint32_t* const indices = task.mesh.indices + std::size_t{3} * first;
    const std::uint32_t block = std::min(kTrianglesPerBlock, (end - first) / lanes * lanes);
    auto largest = hn::Zero(d);
    for (std::uint32_t i = 0; i < 3 * block; i += lanes) {
      largest = hn::Max(largest, hn::LoadU(d, indices + i));
    }
    if (!hn::AllTrue(d, hn::Lt(largest, vertices))) {
      task.found.indices_ok = false;
      return end;
    }
    for (std::uint32_t i = 0; i < 3 * block; ++i) corners[i] = codes[indices[i]];
    auto flags = hn::Zero(d);
    for (std::uint32_t t = 0; t < block; t += lanes) {
      auto c0 = hn::Zero(d), c1 = c0, c2 = c0;
      hn::LoadInterleaved3(d, corners + 3 * t, c0, c1, c2);
      auto lo = hn::Zero(d), hi = lo;
      for (std::size_t a = 0; a < 3; ++a) {
        const auto mask = hn::Set(d, axes.axis[a].mask());
        const auto a0 = hn::And(c0, mask), a1 = hn::And(c1, mask), a2 = hn::And(c2, mask);
        lo = hn::Or(lo, hn::Min(a0, hn::Min(a1, a2)));
        hi = hn::Or(hi, hn::Max(a0, hn::Max(a1, a2)));
      }
      hn::StoreInterleaved2(lo, hi, d, &task.boxes[first + t].lo);
      references = AddWide(references, Cells(d, lo, hi, axes));
      const auto all = hn::Or(c0, hn::Or(c1, c2));
      flags = hn::Or(flags, all);
      if (task.found.touches != kTouchesAll &&
          !hn::AllFalse(d, hn::Ne(hn::And(all, touch), hn::Zero(d)))) {
        task.look_at_touches(first + t, first + t + lanes);
      }
    }
    if (!hn::AllFalse(d, hn::Ne(hn::And(flags, outside), hn::Zero(d)))) task.found.inside = false;
    first += block;
  }
  task.found.references += hn::GetLane(hn::SumOfLanes(d64, references));
  return first;
}
#endif

}  // namespace HWY_NAMESPACE
}  // namespace fasttree::build
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fasttree::build {

HWY_EXPORT(BoxVectors);

namespace {

constexpr std::uint32_t kTrianglesPerTask = 4096;

void box_one_by_one(BoxTask& task, std::uint32_t first, std::uint32_t end) {
  for (std::uint32_t t = first; t < end; ++t) {
    const std::uint32_t v0 = task.mesh.vertex_index(t, 0);
    const std::uint32_t v1 = task.mesh.vertex_index(t, 1);
    const std::uint32_t v2 = task.mesh.vertex_index(t, 2);
    if (std::max({v0, v1, v2}) >= task.codes.size()) {
      task.found.indices_ok = false;
      return;
    }
    const std::uint32_t c0 = task.codes[v0], c1 = task.codes[v1], c2 = task.codes[v2];
    CodeBox box{0, 0};
    for (const BitSpread& a : task.axes.axis) {
      box.lo |= std::min({c0 & a.mask(), c1 & a.mask(), c2 & a.mask()});
      box.hi |= std::max({c0 & a.mask(), c1 & a.mask(), c2 & a.mask()});
    }
    task.boxes[t] = box;
    task.found.references += task.axes.cells(box.lo, box.hi);
    if (((c0 | c1 | c2) & kOutside) != 0) task.found.inside = false;
    if (((c0 | c1 | c2) & kTouchesBounds) != 0 && task.found.touches != kTouchesAll) {
      task.look_at_touches(t, t + 1);
    }
  }
}

template <typename Work>
void for_each_range(std::uint32_t triangles, const Work& work) {
  tbb::parallel_for(
      tbb::blocked_range<std::uint32_t>(0, triangles, kTrianglesPerTask),
      [&](const tbb::blocked_range<std::uint32_t>& range) { work(range.begin(), range.end()); });
}

// Every vertex touches both sides of an axis without extent.
Touches touches_of_flat_axes(const Box3& bounds) {
  Touches touches = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    if (bounds.lo[a] == bounds.hi[a]) touches |= 9u << a;
  }
  return touches;
}

}  // namespace

BoxPass box_triangles(const MeshView& mesh, const Box3& bounds,
                      std::span<const std::uint32_t> codes, const CodeAxes& axes, Simd simd,
                      Buffer<CodeBox>& boxes) {
  boxes.resize(mesh.triangle_count);
  if (mesh.triangle_count == 0) return {};
  const bool vectors = simd == Simd::widest && mesh.indices != nullptr;
  std::atomic<std::uint64_t> references = 0;
  std::atomic<bool> indices_ok = true;
  std::atomic<bool> inside = true;
  std::atomic<Touches> touches = touches_of_flat_axes(bounds);
  for_each_range(mesh.triangle_count, [&](std::uint32_t first, std::uint32_t end) {
    BoxTask task{mesh, bounds, codes, axes, boxes.data(), {}};
    const Touches before = touches.load(std::memory_order_relaxed);
    task.found.touches = before;  // once all sides are touched nobody asks any more
    if (vectors) first = HWY_DYNAMIC_DISPATCH(BoxVectors)(task, first, end);
    box_one_by_one(task, first, end);
    references.fetch_add(task.found.references, std::memory_order_relaxed);
    if (task.found.touches != before) {
      touches.fetch_or(task.found.touches, std::memory_order_relaxed);
    }
    if (!task.found.inside) inside.store(false, std::memory_order_relaxed);
    if (!task.found.indices_ok) indices_ok.store(false, std::memory_order_relaxed);
  });
  return {references, indices_ok, inside, touches};
}

ReferenceCounts count_references(std::span<const CodeBox> boxes, const AxisLevels& schedule,
                                 int depth) {
  tbb::combinable<ReferenceCounts> parts;
  for_each_range(static_cast<std::uint32_t>(boxes.size()),
                 [&](std::uint32_t first, std::uint32_t end) {
                   ReferenceCounts& part = parts.local();
                   for (std::uint32_t t = first; t < end; ++t) {
                     // hi - lo on each axis, a level more at a time.
                     std::array<std::uint64_t, 3> span{};
                     part.at[0] += 1;
                     for (int level = 0; level < depth; ++level) {
                       const std::size_t a = schedule.axis[static_cast<std::size_t>(level)];
                       const int bit = depth - 1 - level;
                       span[a] = 2 * span[a] + (boxes[t].hi >> bit & 1) - (boxes[t].lo >> bit & 1);
                       part.at[static_cast<std::size_t>(level) + 1] +=
                           (span[0] + 1) * (span[1] + 1) * (span[2] + 1);
                     }
                   }
                 });
  ReferenceCounts all;
  parts.combine_each([&](const ReferenceCounts& part) { all.add(part); });
  all.levels = depth;
  return all;
}

}  // namespace fasttree::build
#endif  // HWY_ONCE
