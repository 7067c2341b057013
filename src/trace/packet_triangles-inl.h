// SPDX-License-Identifier: Apache-2.0
// The triangles of a leaf against the rays of a packet: those that the intervals leave over, one
// triangle for many rays or one ray for many triangles. Included once for every instruction set
// (Highway).
#if defined(FASTTREE_TRACE_PACKET_TRIANGLES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FASTTREE_TRACE_PACKET_TRIANGLES_INL_H_
#undef FASTTREE_TRACE_PACKET_TRIANGLES_INL_H_
#else
#define FASTTREE_TRACE_PACKET_TRIANGLES_INL_H_
#endif

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "trace/packet-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fasttree {
namespace HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

using DD = hn::Repartition<double, DF>;

// Halves of a vector in binary64.
struct Halves {
  hn::Vec<DD> lower, upper;
};

HWY_INLINE Halves Promote(VF x) {
  const DD dd;
  const hn::Half<DF> dh;
  return {hn::PromoteTo(dd, hn::LowerHalf(dh, x)), hn::PromoteTo(dd, hn::UpperHalf(dh, x))};
}

HWY_INLINE VF Demote(hn::Vec<DD> lower, hn::Vec<DD> upper) {
  const hn::Half<DF> dh;
  return hn::Combine(DF(), hn::DemoteTo(dh, upper), hn::DemoteTo(dh, lower));
}

// intersect_moved(), operation by operation, for half of the lanes.
struct Exact {
  hn::Vec<DD> edge_v, edge_w, det, t;
  std::uint32_t hit;
};

HWY_INLINE Exact Intersect(hn::Vec<DD> ax, hn::Vec<DD> ay, hn::Vec<DD> bx, hn::Vec<DD> by,
                           hn::Vec<DD> cx, hn::Vec<DD> cy, hn::Vec<DD> az, hn::Vec<DD> bz,
                           hn::Vec<DD> cz) {
  const DD dd;
  const auto zero = hn::Zero(dd);
  const auto u = hn::Sub(hn::Mul(cx, by), hn::Mul(cy, bx));
  const auto v = hn::Sub(hn::Mul(ax, cy), hn::Mul(ay, cx));
  const auto w = hn::Sub(hn::Mul(bx, ay), hn::Mul(by, ax));
  const auto negative = hn::Lt(hn::Min(hn::Min(u, v), w), zero);
  const auto positive = hn::Gt(hn::Max(hn::Max(u, v), w), zero);
  const auto det = hn::Add(hn::Add(u, v), w);
  const auto depth = hn::Add(hn::Add(hn::Mul(u, az), hn::Mul(v, bz)), hn::Mul(w, cz));
  const auto missed = hn::Or(hn::And(negative, positive), hn::Eq(det, zero));
  Exact e;
  e.edge_v = v;
  e.edge_w = w;
  e.det = det;
  e.t = hn::Div(depth, det);
  e.hit = BitsOf(dd, hn::Not(missed));
  return e;
}

// One triangle against the rays of `rays`.
template <bool kAny>
HWY_INLINE void TestTriangle(const float* corner_a, std::size_t n, std::uint32_t id,
                             std::uint64_t rays, Packet& p) {
  const DF d;
  const DU du;
  std::array<VF, 9> q;  // corner by corner, in the order of the ray's axes
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t a = 0; a < 3; ++a) {
      q[3 * c + a] = hn::Set(d, corner_a[(3 * c + p.k[a]) * n]);
    }
  }
  const std::uint32_t all = static_cast<std::uint32_t>((std::uint64_t{1} << hn::Lanes(d)) - 1);
  for (std::size_t i = 0; i < kPacket; i += hn::Lanes(d)) {
    const auto wanted = static_cast<std::uint32_t>(rays >> i) & all;
    if (wanted == 0) continue;
    const VF ox = hn::Load(d, p.rays.origin[p.k[0]] + i),
             oy = hn::Load(d, p.rays.origin[p.k[1]] + i),
             oz = hn::Load(d, p.rays.origin[p.k[2]] + i);
    const VF sx = hn::Load(d, p.rays.sx + i), sy = hn::Load(d, p.rays.sy + i);
    const VF az = hn::Sub(q[2], oz), bz = hn::Sub(q[5], oz), cz = hn::Sub(q[8], oz);
    Sheared s;
    s.ax = hn::Sub(hn::Sub(q[0], ox), hn::Mul(sx, az));
    s.ay = hn::Sub(hn::Sub(q[1], oy), hn::Mul(sy, az));
    s.bx = hn::Sub(hn::Sub(q[3], ox), hn::Mul(sx, bz));
    s.by = hn::Sub(hn::Sub(q[4], oy), hn::Mul(sy, bz));
    s.cx = hn::Sub(hn::Sub(q[6], ox), hn::Mul(sx, cz));
    s.cy = hn::Sub(hn::Sub(q[7], oy), hn::Mul(sy, cz));
    std::uint32_t candidates = BitsOf(d, NotRuledOut(s)) & wanted;
    if (candidates == 0) continue;

    const VF sz = hn::Load(d, p.rays.sz + i);
    const Halves ax = Promote(s.ax), ay = Promote(s.ay), bx = Promote(s.bx), by = Promote(s.by),
                 cx = Promote(s.cx), cy = Promote(s.cy), za = Promote(hn::Mul(sz, az)),
                 zb = Promote(hn::Mul(sz, bz)), zc = Promote(hn::Mul(sz, cz));
    const Exact lower = Intersect(ax.lower, ay.lower, bx.lower, by.lower, cx.lower, cy.lower,
                                  za.lower, zb.lower, zc.lower);
    const Exact upper = Intersect(ax.upper, ay.upper, bx.upper, by.upper, cx.upper, cy.upper,
                                  za.upper, zb.upper, zc.upper);
    candidates &= lower.hit | upper.hit << hn::Lanes(DD());
    const VF t = Demote(lower.t, upper.t);
    const VF best = hn::Load(d, p.rays.t + i);
    const auto in_range =
        hn::And(hn::And(hn::Ge(t, hn::Load(d, p.rays.t_min + i)), hn::Le(t, best)),
                hn::Lt(hn::Abs(t), hn::Set(d, HUGE_VALF)));
    if (kAny) {
      p.alive &= ~(std::uint64_t{candidates & BitsOf(d, in_range)} << i);
      continue;
    }
    const auto ids = hn::Set(du, id), best_ids = hn::Load(du, p.id + i);
    const auto nearer =
        hn::And(in_range, hn::Or(hn::Lt(t, best), hn::RebindMask(d, hn::Lt(ids, best_ids))));
    candidates &= BitsOf(d, nearer);
    if (candidates == 0) continue;
    const auto accepted = MaskOf(d, candidates);
    const VF u = Demote(hn::Div(lower.edge_v, lower.det), hn::Div(upper.edge_v, upper.det));
    const VF v = Demote(hn::Div(lower.edge_w, lower.det), hn::Div(upper.edge_w, upper.det));
    hn::Store(hn::IfThenElse(accepted, t, best), d, p.rays.t + i);
    hn::Store(hn::IfThenElse(accepted, u, hn::Load(d, p.u + i)), d, p.u + i);
    hn::Store(hn::IfThenElse(accepted, v, hn::Load(d, p.v + i)), d, p.v + i);
    hn::Store(hn::IfThenElse(hn::RebindMask(du, accepted), ids, best_ids), du, p.id + i);
  }
}

// One ray of a packet against all triangles of a leaf.
template <bool kAny>
HWY_INLINE void TestRay(const WideLayout& layout, std::uint32_t first, std::uint32_t n,
                        std::size_t i, Packet& p) {
  ShearedRay r;
  r.origin = {p.rays.origin[0][i], p.rays.origin[1][i], p.rays.origin[2][i]};
  r.kx = p.k[0];
  r.ky = p.k[1];
  r.kz = p.k[2];
  r.sx = p.rays.sx[i];
  r.sy = p.rays.sy[i];
  r.sz = p.rays.sz[i];
  ForEachHit(
      layout, first, n, r, p.rays.t_min[i], [&] { return p.rays.t[i]; },
      [&](std::uint32_t reference, float t, float u, float v) {
        if (kAny) {
          p.alive &= ~(std::uint64_t{1} << i);
          return true;
        }
        const std::uint32_t id = layout.ids[reference];
        if (t < p.rays.t[i] || id < p.id[i]) {
          p.rays.t[i] = t;
          p.id[i] = id;
          p.u[i] = u;
          p.v[i] = v;
        }
        return false;
      });
}

// Vectors of a packet that hold some of these rays.
HWY_INLINE std::uint32_t VectorsOf(std::uint64_t rays) {
  const DF d;
  std::uint32_t vectors = 0;
  const std::uint64_t all = (std::uint64_t{1} << hn::Lanes(d)) - 1;
  for (std::size_t i = 0; i < kPacket; i += hn::Lanes(d)) vectors += (rays >> i & all) != 0;
  return vectors;
}

template <bool kAny>
HWY_INLINE void TestLeaf(const WideLayout& layout, std::uint32_t first, std::uint32_t n,
                         std::uint64_t rays, const PacketBounds& b, Packet& p) {
  const DF d;
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
  const float* const rows = layout.triangles_of(first);
  HWY_ALIGN std::uint32_t left[(kMostInLeaf + 3) / 4];
  std::uint32_t survivors = 0;
  for (std::uint32_t i = 0, k = 0; i < n; i += lanes, ++k) {
    const auto row = [&](std::size_t c, std::size_t a)
                         HWY_ATTR { return hn::LoadU(d, rows + (3 * c + a) * n + i); };
    const Interval t = IntervalOf(
        b, p.octant, b.near_origin_scene, b.far_origin_scene,
        [&](std::size_t a) HWY_ATTR { return hn::Min(hn::Min(row(0, a), row(1, a)), row(2, a)); },
        [&](std::size_t a) HWY_ATTR { return hn::Max(hn::Max(row(0, a), row(1, a)), row(2, a)); });
    left[k] = BitsOf(d, hn::Le(t.enter, t.leave));
    if (n - i < lanes) left[k] &= (1u << (n - i)) - 1;
    survivors += static_cast<std::uint32_t>(std::popcount(left[k]));
  }
  // Many small triangles for few rays: ray by ray; else triangle by triangle.
  const std::uint32_t by_ray =
      static_cast<std::uint32_t>(std::popcount(rays)) * ((n + lanes - 1) / lanes);
  if (by_ray < survivors * VectorsOf(rays)) {
    for (; rays != 0; rays &= rays - 1) {
      TestRay<kAny>(layout, first, n, static_cast<std::size_t>(std::countr_zero(rays)), p);
    }
    return;
  }
  for (std::uint32_t i = 0, k = 0; i < n; i += lanes, ++k) {
    for (std::uint32_t bits = left[k]; bits != 0; bits &= bits - 1) {
      const std::uint32_t j = i + static_cast<std::uint32_t>(std::countr_zero(bits));
      TestTriangle<kAny>(rows + j, n, layout.ids[first + j], kAny ? rays & p.alive : rays, p);
      if (kAny && p.alive == 0) return;
    }
  }
}

#endif  // HWY_SCALAR
}  // namespace HWY_NAMESPACE
}  // namespace fasttree
HWY_AFTER_NAMESPACE();

#endif
