// SPDX-License-Identifier: Apache-2.0
// What single rays and packets share. Included once for every instruction set (Highway).
#if defined(FASTTREE_TRACE_WIDE_KERNELS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FASTTREE_TRACE_WIDE_KERNELS_INL_H_
#undef FASTTREE_TRACE_WIDE_KERNELS_INL_H_
#else
#define FASTTREE_TRACE_WIDE_KERNELS_INL_H_
#endif

#include <hwy/highway.h>

#include <bit>
#include <cstddef>
#include <cstdint>

#include "geometry/triangle_intersection.h"
#include "trace/wide_layout.h"

HWY_BEFORE_NAMESPACE();
namespace fasttree {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR
// At most 16 lanes, the children of a node.
using DF = hn::CappedTag<float, 16>;
using VF = hn::Vec<DF>;
using DU = hn::RebindToUnsigned<DF>;

template <class D>
HWY_INLINE std::uint32_t BitsOf(D d, hn::Mask<D> mask) {
#if HWY_TARGET <= HWY_AVX3
  (void)d;
  return static_cast<std::uint32_t>(mask.raw);
#else
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8;
#endif
}

template <class D>
HWY_INLINE hn::Mask<D> MaskOf(D d, std::uint32_t bits) {
#if HWY_TARGET <= HWY_AVX3
  (void)d;
  return hn::Mask<D>{static_cast<decltype(hn::Mask<D>::raw)>(bits)};
#else
  const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits),
                                 static_cast<std::uint8_t>(bits >> 8)};
  return hn::LoadMaskBits(d, bytes);
#endif
}

// Sheared coordinates of the corners of triangles, or of one triangle for many rays.
struct Sheared {
  VF ax, ay, bx, by, cx, cy;
};

// The signs of the edge functions are right where they are further from zero than `margin`: the
// products in binary32 are each off by at most 2^-24 of themselves, and of the edge function,
// fused or not. Triangles that are certainly missed are ruled out; the others go through the exact
// test.
HWY_INLINE hn::Mask<DF> NotRuledOut(const Sheared& s) {
  const DF d;
  const VF pu = hn::Mul(s.cy, s.bx), pv = hn::Mul(s.ay, s.cx), pw = hn::Mul(s.by, s.ax);
  const VF u = hn::MulSub(s.cx, s.by, pu);
  const VF v = hn::MulSub(s.ax, s.cy, pv);
  const VF w = hn::MulSub(s.bx, s.ay, pw);
  const VF largest = hn::Max(hn::Max(hn::Abs(pu), hn::Abs(pv)), hn::Abs(pw));
  const VF margin = hn::MulAdd(largest, hn::Set(d, 0x1p-21f), hn::Set(d, 0x1p-120f));
  const auto negative = hn::Lt(hn::Min(hn::Min(u, v), w), hn::Neg(margin));
  const auto positive = hn::Gt(hn::Max(hn::Max(u, v), w), margin);
  return hn::Not(hn::And(negative, positive));
}

// One ray against the triangles of a leaf, whole vectors of them at a time: calls hit(reference,
// t, u, v) for each that the exact test accepts, with t_best() asked before. hit() returns true to
// end it; so does this function then.
template <typename Best, typename Accept>
HWY_INLINE bool ForEachHit(const WideLayout& layout, std::uint32_t first, std::uint32_t n,
                           const ShearedRay& r, float t_min, const Best& t_best,
                           const Accept& hit) {
  const DF d;
  const float* const rows = layout.triangles_of(first);
  const std::size_t kx = std::size_t{r.kx} * n, ky = std::size_t{r.ky} * n,
                    kz = std::size_t{r.kz} * n, corner = std::size_t{3} * n;
  const float ox = r.origin[r.kx], oy = r.origin[r.ky], oz = r.origin[r.kz];
  const VF vox = hn::Set(d, ox), voy = hn::Set(d, oy), voz = hn::Set(d, oz);
  const VF sx = hn::Set(d, r.sx), sy = hn::Set(d, r.sy);
  for (std::uint32_t i = 0; i < n; i += static_cast<std::uint32_t>(hn::Lanes(d))) {
    Sheared q;
    const auto shear_corner = [&](const float* p, VF& x, VF& y) HWY_ATTR {
      const VF z = hn::Sub(hn::LoadU(d, p + kz), voz);
      x = hn::Sub(hn::Sub(hn::LoadU(d, p + kx), vox), hn::Mul(sx, z));
      y = hn::Sub(hn::Sub(hn::LoadU(d, p + ky), voy), hn::Mul(sy, z));
    };
    shear_corner(rows + i, q.ax, q.ay);
    shear_corner(rows + corner + i, q.bx, q.by);
    shear_corner(rows + 2 * corner + i, q.cx, q.cy);
    std::uint32_t candidates = BitsOf(d, NotRuledOut(q));
    if (n - i < hn::Lanes(d)) candidates &= (1u << (n - i)) - 1;
    for (; candidates != 0; candidates &= candidates - 1) {
      const std::uint32_t j = i + static_cast<std::uint32_t>(std::countr_zero(candidates));
      const auto moved = [&](std::size_t c) {
        const float* const p = rows + c * corner + j;
        return Vec3{p[kx] - ox, p[ky] - oy, p[kz] - oz};
      };
      float t, u, v;
      if (intersect_moved(r, t_min, t_best(), moved(0), moved(1), moved(2), t, u, v) &&
          hit(first + j, t, u, v)) {
        return true;
      }
    }
  }
  return false;
}

// Nibbles of a node's children from back to front for an octant: the order itself of the opposite
// octant, or the order of this one backwards (see WideNode::order).
HWY_INLINE bool Backwards(std::uint32_t octant) {
  return (octant & 4) == 0;
}
HWY_INLINE std::uint32_t OrderOf(std::uint32_t octant) {
  return Backwards(octant) ? octant : octant ^ 7u;
}

// Where the 16 children of a node are entered and left.
struct Intervals {
  static constexpr std::size_t kVectors = kWide / HWY_MIN(HWY_MAX_BYTES / sizeof(float), kWide);
  VF enter[kVectors], leave[kVectors];
};

// Children whose interval is not empty, pushed from back to front: slots below the node's number,
// and where they are entered. Returns the new depth of the stack.
HWY_INLINE std::size_t Push(const WideNode& node, std::uint32_t index, std::uint32_t octant,
                            const Intervals& t, std::uint32_t* entries, float* enters,
                            std::size_t depth) {
  const DF d;
  const std::uint64_t order = node.order[OrderOf(octant)];
  const bool backwards = Backwards(octant);
#if HWY_TARGET <= HWY_AVX3
  const DU du;
  HWY_ALIGN static constexpr std::uint32_t kShifts[2][16] = {
      {0, 4, 8, 12, 16, 20, 24, 28, 0, 4, 8, 12, 16, 20, 24, 28},
      {28, 24, 20, 16, 12, 8, 4, 0, 28, 24, 20, 16, 12, 8, 4, 0}};
  const auto low = static_cast<std::uint32_t>(order),
             high = static_cast<std::uint32_t>(order >> 32);
  const auto words = hn::ConcatUpperLower(du, hn::Set(du, backwards ? low : high),
                                          hn::Set(du, backwards ? high : low));
  const auto slots = hn::And(hn::Shr(words, hn::Load(du, kShifts[backwards])), hn::Set(du, 15));
  const auto table = hn::IndicesFromVec(d, slots);
  const VF first = hn::TableLookupLanes(t.enter[0], table);
  const VF last = hn::TableLookupLanes(t.leave[0], table);
  const auto hit = hn::Le(first, last);
  hn::StoreU(hn::Compress(hn::Or(slots, hn::Set(du, index << 4)), hn::RebindMask(du, hit)), du,
             entries + depth);
  hn::StoreU(hn::Compress(first, hit), d, enters + depth);
  return depth + hn::CountTrue(d, hit);
#else
  HWY_ALIGN float enter[kWide];
  std::uint32_t hits = 0;
  for (std::size_t k = 0, i = 0; k < Intervals::kVectors; ++k, i += hn::Lanes(d)) {
    hn::Store(t.enter[k], d, enter + i);
    hits |= BitsOf(d, hn::Le(t.enter[k], t.leave[k])) << i;
  }
  for (std::uint32_t place = 0; place < kWide; ++place) {
    const std::uint32_t shift = 4 * (backwards ? kWide - 1 - place : place);
    const auto slot = static_cast<std::uint32_t>(order >> shift & 15);
    entries[depth] = index << 4 | slot;
    enters[depth] = enter[slot];
    depth += hits >> slot & 1;
  }
  return depth;
#endif
}
#endif  // HWY_SCALAR

}  // namespace HWY_NAMESPACE
}  // namespace fasttree
HWY_AFTER_NAMESPACE();

#endif
