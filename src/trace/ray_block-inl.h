// SPDX-License-Identifier: Apache-2.0
// 64 rays at a time, by component and made ready for boxes and triangles: what shear() does, to the
// bit, and what the boxes of wide nodes need. Included once for every instruction set (Highway).
#if defined(FASTTREE_TRACE_RAY_BLOCK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FASTTREE_TRACE_RAY_BLOCK_INL_H_
#undef FASTTREE_TRACE_RAY_BLOCK_INL_H_
#else
#define FASTTREE_TRACE_RAY_BLOCK_INL_H_
#endif

#include <hwy/cache_control.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "trace/wide_kernels-inl.h"
#include "trace/wide_trace.h"

HWY_BEFORE_NAMESPACE();
namespace fasttree {
namespace HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

using Lanes64 = float[kPacket];

/// Boxes are entered at the largest of `near bound * reciprocal - near_offset` and left at the
/// least of `far bound * reciprocal - far_offset`. The offsets make every box a thickness larger:
/// that of the walk through the kd-tree (traversal.h), 24 u R, and 16 u R for what is rounded here:
/// coordinates relative to the centre, reciprocal, products and sums are each off by u R at most,
/// fused or not.
struct HWY_ALIGN RayBlock {
  Lanes64 origin[3];
  Lanes64 reciprocal[3], near_offset[3], far_offset[3];
  Lanes64 sx, sy, sz, t_min, t;          // t: what is nearest so far, at first t_max
  HWY_ALIGN std::uint32_t way[kPacket];  // WayOf: octant and longest axis
  std::uint64_t valid;                   // the others hit nothing
  std::uint64_t tame;  // the others have numbers for which the bounds of the errors do not hold
  std::uint64_t in_bounds;  // of the tame ones: the others miss the scene
};

/// Bit a of the octant: the ray goes down axis a.
HWY_INLINE std::uint32_t OctantOf(std::uint32_t way) {
  return way & 7;
}

/// The axes kx, ky, kz of shear().
HWY_INLINE std::array<std::uint32_t, 3> AxesOf(std::uint32_t way) {
  const std::uint32_t kz = way >> 3;
  std::uint32_t kx = kz == 2 ? 0 : kz + 1, ky = kz == 0 ? 2 : kz - 1;
  if ((way >> kz & 1) != 0) std::swap(kx, ky);
  return {kx, ky, kz};
}

constexpr float kWideThickness = 40 * 0x1p-24f;

// `rays` holds as many rays as a vector has lanes.
HWY_INLINE void PrepareRays(const Ray* rays, std::size_t i, const WideScene& scene,
                            RayBlock& block) {
  const DF d;
  const DU du;
  const hn::RebindToSigned<DF> di;
  static_assert(sizeof(Ray) == 8 * sizeof(float));
  const float* const in = reinterpret_cast<const float*>(rays);
  // Origins with t_min and directions with t_max take turns.
  VF a0, a1, a2, a3, b0, b1, b2, b3;
  hn::LoadInterleaved4(d, in, a0, a1, a2, a3);
  hn::LoadInterleaved4(d, in + 4 * hn::Lanes(d), b0, b1, b2, b3);
  const std::array<VF, 3> o = {hn::ConcatEven(d, b0, a0), hn::ConcatEven(d, b1, a1),
                               hn::ConcatEven(d, b2, a2)};
  const std::array<VF, 3> dir = {hn::ConcatOdd(d, b0, a0), hn::ConcatOdd(d, b1, a1),
                                 hn::ConcatOdd(d, b2, a2)};
  const VF t_min = hn::ConcatEven(d, b3, a3), t_max = hn::ConcatOdd(d, b3, a3);

  const VF one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  const std::array<VF, 3> size = {hn::Abs(dir[0]), hn::Abs(dir[1]), hn::Abs(dir[2])};
  const auto z_longest = hn::And(hn::Ge(size[2], size[0]), hn::Ge(size[2], size[1]));
  const auto y_longest = hn::AndNot(z_longest, hn::Ge(size[1], size[0]));
  const auto pick = [&](const std::array<VF, 3>& v, std::size_t for_x, std::size_t for_y,
                        std::size_t for_z) HWY_ATTR {
    return hn::IfThenElse(z_longest, v[for_z], hn::IfThenElse(y_longest, v[for_y], v[for_x]));
  };
  const VF dz = pick(dir, 0, 1, 2);
  const VF next = pick(dir, 1, 2, 0), after = pick(dir, 2, 0, 1);
  const auto swapped = hn::Lt(dz, zero);
  const VF sz = hn::Div(one, dz);
  hn::Store(hn::Div(hn::IfThenElse(swapped, after, next), dz), d, block.sx + i);
  hn::Store(hn::Div(hn::IfThenElse(swapped, next, after), dz), d, block.sy + i);
  hn::Store(sz, d, block.sz + i);
  hn::Store(t_min, d, block.t_min + i);
  hn::Store(t_max, d, block.t + i);

  const VF largest = hn::Set(d, 3.402823466e38f);
  // An interval that is empty or not a number hits nothing, and must not get into bounds.
  auto valid = hn::And(hn::Le(hn::Abs(sz), largest), hn::Le(t_min, t_max));
  VF reach = zero;
  const VF longest = hn::Abs(dz);
  for (std::size_t a = 0; a < 3; ++a) {
    valid = hn::And(valid, hn::And(hn::Le(size[a], largest), hn::Le(hn::Abs(o[a]), largest)));
    reach = hn::Max(reach, hn::Max(hn::Abs(hn::Sub(hn::Set(d, scene.bounds.hi[a]), o[a])),
                                   hn::Abs(hn::Sub(hn::Set(d, scene.bounds.lo[a]), o[a]))));
  }
  const VF scale = hn::Div(one, longest);
  const VF span = hn::Mul(reach, scale);
  const VF small = hn::Set(d, 0x1p-40f), large = hn::Set(d, 0x1p40f);
  const auto tame = hn::And(hn::And(hn::Gt(reach, small), hn::Lt(reach, large)),
                            hn::And(hn::Gt(span, small), hn::Lt(span, large)));

  // A component under 2^-40 of the longest moves a ray by nothing that counts while it is in the
  // scene, and is taken for that much.
  const VF steepest = hn::Mul(scale, large);
  const VF thickness = hn::Mul(reach, hn::Set(d, kWideThickness));
  VF enter = t_min, leave = t_max;
  auto way = hn::IfThenElse(hn::RebindMask(du, z_longest), hn::Set(du, 16u),
                            hn::IfThenElseZero(hn::RebindMask(du, y_longest), hn::Set(du, 8u)));
  for (std::size_t a = 0; a < 3; ++a) {
    const VF r = hn::Min(hn::Div(one, size[a]), steepest);
    const VF signed_r = hn::CopySign(r, dir[a]);
    const VF at = hn::Mul(hn::Sub(o[a], hn::Set(d, scene.layout->centre[a])), signed_r);
    const VF slack = hn::Mul(thickness, r);
    const VF near_offset = hn::Add(at, slack), far_offset = hn::Sub(at, slack);
    hn::Store(o[a], d, block.origin[a] + i);
    hn::Store(signed_r, d, block.reciprocal[a] + i);
    hn::Store(near_offset, d, block.near_offset[a] + i);
    hn::Store(far_offset, d, block.far_offset[a] + i);
    const auto down = hn::RebindMask(d, hn::Lt(hn::BitCast(di, dir[a]), hn::Zero(di)));
    way = hn::Or(way, hn::IfThenElseZero(hn::RebindMask(du, down), hn::Set(du, 1u << a)));
    const VF lower = hn::Set(d, scene.bounds.lo[a] - scene.layout->centre[a]);
    const VF upper = hn::Set(d, scene.bounds.hi[a] - scene.layout->centre[a]);
    enter = hn::Max(enter, hn::MulSub(hn::IfThenElse(down, upper, lower), signed_r, near_offset));
    leave = hn::Min(leave, hn::MulSub(hn::IfThenElse(down, lower, upper), signed_r, far_offset));
  }
  hn::Store(way, du, block.way + i);
  block.valid |= std::uint64_t{BitsOf(d, valid)} << i;
  block.tame |= std::uint64_t{BitsOf(d, tame)} << i;
  block.in_bounds |= std::uint64_t{BitsOf(d, hn::Le(enter, leave))} << i;
}

/// Asks for the rays of a block to come: a batch is larger than the caches, and processors do not
/// fetch ahead over the end of a page.
HWY_INLINE void PrefetchRays(const WideBatch& batch, std::size_t begin) {
  if (begin + kPacket > batch.rays.size()) return;
  const char* const rays = reinterpret_cast<const char*>(&batch.rays[begin]);
  for (std::size_t at = 0; at < kPacket * sizeof(Ray); at += 64) hwy::Prefetch(rays + at);
}

/// Makes at most 64 rays ready. Returns those that have to be traced: the others hit nothing, or
/// are not tame, which is noted in batch.wild.
HWY_INLINE std::uint64_t PrepareBlock(const WideScene& scene, const WideBatch& batch,
                                      std::size_t begin, RayBlock& block) {
  const DF d;
  const std::size_t lanes = hn::Lanes(d);
  const std::size_t count = std::min(kPacket, batch.rays.size() - begin);
  block.valid = block.tame = block.in_bounds = 0;
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) PrepareRays(&batch.rays[begin + i], i, scene, block);
  if (i < count) {
    Ray rest[16];
    for (std::size_t j = 0; j < lanes; ++j) {
      rest[j] = batch.rays[begin + std::min(i + j, count - 1)];
    }
    PrepareRays(rest, i, scene, block);
    i += lanes;
  }
  for (; i < kPacket; i += lanes) {  // packets look at whole blocks
    for (std::size_t j = 0; j < lanes; ++j) block.t[i + j] = -HUGE_VALF;
  }
  const std::uint64_t all = count == kPacket ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
  for (std::uint64_t wild = all & block.valid & ~block.tame; wild != 0; wild &= wild - 1) {
    batch.wild->push_back(
        static_cast<std::uint32_t>(begin + static_cast<std::size_t>(std::countr_zero(wild))));
  }
  return all & block.valid & block.tame & block.in_bounds;
}

#endif  // HWY_SCALAR
}  // namespace HWY_NAMESPACE
}  // namespace fasttree
HWY_AFTER_NAMESPACE();

#endif
