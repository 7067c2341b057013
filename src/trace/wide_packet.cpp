// SPDX-License-Identifier: Apache-2.0
// Rays that go nearly alike, 64 at a time: intervals round all of them against the boxes of a node,
// and against those of a leaf's triangles; single rays only against what is left. Compiled once for
// every instruction set.
#include <hwy/cache_control.h>

#include <algorithm>
#include <bit>
#include <vector>

#include "geometry/triangle_intersection.h"
#include "trace/wide_trace.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trace/wide_packet.cpp"
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
void PacketClosest(const WideScene&, const WideBatch& batch) {
  leave_all(batch);
}
void PacketOccluded(const WideScene&, const WideBatch& batch) {
  leave_all(batch);
}

#else
namespace {

constexpr std::size_t kPacketStack = kMostWideLevels * kWide + kWide;

// A block of rays on its way. Those of `alive` count; they go down the same axes and have the same
// longest one, so that nodes are visited in one order and triangles are sheared along one axis.
struct HWY_ALIGN Packet {
  RayBlock rays;
  Lanes64 u, v;
  HWY_ALIGN std::uint32_t id[kPacket];
  std::uint64_t alive;
  float thickness;
  std::uint32_t octant;
  std::array<std::uint32_t, 3> k;  // the axes kx, ky, kz
  std::size_t depth;
  HWY_ALIGN float enters[kPacketStack];
  HWY_ALIGN std::uint32_t entries[kPacketStack];
};

// What all rays of a packet lie in, for axes of the scene. Offsets of a bound b from the origin are
// b - near_origin or more at the side where boxes are entered, and so on; products of two intervals
// are reached at their ends.
struct PacketBounds {
  std::array<float, 3> near_origin, far_origin;              // relative to the centre
  std::array<float, 3> near_origin_scene, far_origin_scene;  // not
  std::array<float, 3> least, most;                          // reciprocals
  std::array<float, 3> slack;
  float t_min, t_most;
};

// Where boxes are entered at the earliest and left at the latest, by any ray.
struct Interval {
  VF enter, leave;
};

template <typename Lower, typename Upper>
HWY_INLINE Interval IntervalOf(const PacketBounds& b, std::uint32_t octant,
                               const std::array<float, 3>& near_origin,
                               const std::array<float, 3>& far_origin, const Lower& lower,
                               const Upper& upper) {
  const DF d;
  VF enter = hn::Set(d, b.t_min), leave = hn::Set(d, b.t_most);
  for (std::size_t a = 0; a < 3; ++a) {
    const bool down = (octant >> a & 1) != 0;
    const VF near = hn::Sub(down ? upper(a) : lower(a), hn::Set(d, near_origin[a]));
    const VF far = hn::Sub(down ? lower(a) : upper(a), hn::Set(d, far_origin[a]));
    const VF least = hn::Set(d, b.least[a]), most = hn::Set(d, b.most[a]);
    const VF slack = hn::Set(d, b.slack[a]);
    enter = hn::Max(enter, hn::Sub(hn::Min(hn::Mul(near, least), hn::Mul(near, most)), slack));
    leave = hn::Min(leave, hn::Add(hn::Max(hn::Mul(far, least), hn::Mul(far, most)), slack));
  }
  return {enter, leave};
}

HWY_INLINE void VisitNode(const WideLayout& layout, std::uint32_t index, const PacketBounds& b,
                          Packet& p) {
  const DF d;
  const WideNode& node = layout.nodes[index];
  HWY_ALIGN float enter[kWide];
  HWY_ALIGN float leave[kWide];
  for (std::size_t i = 0; i < kWide; i += hn::Lanes(d)) {
    const Interval t = IntervalOf(
        b, p.octant, b.near_origin, b.far_origin,
        [&](std::size_t a) HWY_ATTR { return hn::Load(d, node.bound[0][a] + i); },
        [&](std::size_t a) HWY_ATTR { return hn::Load(d, node.bound[1][a] + i); });
    hn::Store(t.enter, d, enter + i);
    hn::Store(t.leave, d, leave + i);
  }
  p.depth = Push(node, index, p.octant, enter, leave, p.entries, p.enters, p.depth);
}

// The rays that a child's box may concern. For a node it is enough to know that there are some, so
// the first vector with one ends the search.
template <bool kSome>
HWY_INLINE std::uint64_t RaysInBox(const WideNode& node, std::uint32_t slot, const Packet& p) {
  const DF d;
  std::array<VF, 3> near, far;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t down = p.octant >> a & 1;
    near[a] = hn::Set(d, node.bound[down][a][slot]);
    far[a] = hn::Set(d, node.bound[1 - down][a][slot]);
  }
  std::uint64_t rays = 0;
  for (std::size_t i = 0; i < kPacket; i += hn::Lanes(d)) {
    VF enter = hn::Load(d, p.rays.t_min + i), leave = hn::Load(d, p.rays.t + i);
    for (std::size_t a = 0; a < 3; ++a) {
      const VF r = hn::Load(d, p.rays.reciprocal[a] + i);
      enter = hn::Max(enter, hn::MulSub(near[a], r, hn::Load(d, p.rays.near_offset[a] + i)));
      leave = hn::Min(leave, hn::MulSub(far[a], r, hn::Load(d, p.rays.far_offset[a] + i)));
    }
    rays |= p.alive & std::uint64_t{BitsOf(d, hn::Le(enter, leave))} << i;
    if (kSome && rays != 0) return rays;
  }
  return rays;
}

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

// The largest of some lanes, or the negative of the least.
HWY_INLINE float MostOf(const float* lanes, float sign, std::uint64_t members) {
  const DF d;
  const std::uint32_t all = static_cast<std::uint32_t>((std::uint64_t{1} << hn::Lanes(d)) - 1);
  const VF lowest = hn::Set(d, -HUGE_VALF);
  VF most = lowest;
  for (std::size_t i = 0; i < kPacket; i += hn::Lanes(d)) {
    const auto member = MaskOf(d, static_cast<std::uint32_t>(members >> i) & all);
    most = hn::Max(
        most, hn::IfThenElse(member, hn::Mul(hn::Load(d, lanes + i), hn::Set(d, sign)), lowest));
  }
  return hn::GetLane(hn::MaxOfLanes(d, most));
}

HWY_INLINE float MostOf(const float* lanes, std::uint64_t members) {
  return MostOf(lanes, 1.0f, members);
}
HWY_INLINE float LeastOf(const float* lanes, std::uint64_t members) {
  return -MostOf(lanes, -1.0f, members);
}

template <bool kAny>
void Walk(const WideLayout& layout, PacketBounds& b, Packet& p) {
  p.depth = 0;
  VisitNode(layout, 0, b, p);
  while (p.depth > 0) {
    --p.depth;
    if (p.enters[p.depth] > b.t_most) continue;
    const std::uint32_t entry = p.entries[p.depth];
    const WideNode& node = layout.nodes[entry >> 4];
    const std::uint32_t slot = entry & 15;
    const std::uint32_t n = node.count[slot];
    if (n == 0) {
      if (RaysInBox<true>(node, slot, p) != 0) VisitNode(layout, node.child[slot], b, p);
      continue;
    }
    const std::uint64_t rays = RaysInBox<false>(node, slot, p);
    if (rays == 0) continue;
    TestLeaf<kAny>(layout, node.child[slot], n, rays, b, p);
    if (kAny) {
      if (p.alive == 0) return;
    } else {
      b.t_most = MostOf(p.rays.t, p.alive);
    }
  }
}

HWY_INLINE PacketBounds BoundsOf(const Packet& p, Vec3 centre) {
  PacketBounds b;
  for (std::size_t a = 0; a < 3; ++a) {
    b.least[a] = LeastOf(p.rays.reciprocal[a], p.alive);
    b.most[a] = MostOf(p.rays.reciprocal[a], p.alive);
    const float lower = LeastOf(p.rays.origin[a], p.alive);
    const float upper = MostOf(p.rays.origin[a], p.alive);
    // The largest origin where rays go up, as boxes are entered at their lower side there.
    const bool down = (p.octant >> a & 1) != 0;
    b.near_origin_scene[a] = down ? lower : upper;
    b.far_origin_scene[a] = down ? upper : lower;
    b.near_origin[a] = b.near_origin_scene[a] - centre[a];
    b.far_origin[a] = b.far_origin_scene[a] - centre[a];
  }
  // The thickest of all rays: reach is the longest distance, and each axis has its steepest.
  for (std::size_t a = 0; a < 3; ++a) {
    b.slack[a] = p.thickness * std::max(std::fabs(b.least[a]), std::fabs(b.most[a]));
  }
  b.t_min = LeastOf(p.rays.t_min, p.alive);
  b.t_most = MostOf(p.rays.t, p.alive);
  return b;
}

// The thickness that covers the rays of a packet, from the bounds of their origins.
HWY_INLINE float ThicknessOf(const Packet& p, const Box3& bounds) {
  float reach = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    reach = std::max({reach, bounds.hi[a] - LeastOf(p.rays.origin[a], p.alive),
                      MostOf(p.rays.origin[a], p.alive) - bounds.lo[a]});
  }
  return 1.25f * kWideThickness * reach;
}

// Whether a whole packet misses the scene, from the ranges of origins and directions alone: most
// packets of a picture may. Says no where in doubt. A ray that is not valid misses anyway.
HWY_INLINE bool AllMiss(const Ray* rays, const Box3& bounds) {
  const DF d;
  const float* const in = reinterpret_cast<const float*>(rays);
  // Vectors of whole rays: lanes with one place in a ray are reduced in the end.
  constexpr std::size_t kFloats = 8;
  VF least[2], most[2];
  const std::size_t lanes = hn::Lanes(d);
  const std::size_t step = std::max(lanes, kFloats);
  const std::size_t parts = step / lanes;
  for (std::size_t q = 0; q < parts; ++q) {
    least[q] = hn::Set(d, HUGE_VALF);
    most[q] = hn::Set(d, -HUGE_VALF);
  }
  for (std::size_t i = 0; i < kPacket * kFloats; i += step) {
    for (std::size_t q = 0; q < parts; ++q) {
      const VF x = hn::LoadU(d, in + i + q * lanes);
      // In this order, what is not a number is passed over instead of replacing the bound.
      least[q] = hn::Min(x, least[q]);
      most[q] = hn::Max(x, most[q]);
    }
  }
  HWY_ALIGN float lo[16];
  HWY_ALIGN float hi[16];
  for (std::size_t q = 0; q < parts; ++q) {
    hn::Store(least[q], d, lo + q * lanes);
    hn::Store(most[q], d, hi + q * lanes);
  }
  for (std::size_t k = kFloats; k < step; ++k) {
    lo[k - kFloats] = std::min(lo[k - kFloats], lo[k]);
    hi[k - kFloats] = std::max(hi[k - kFloats], hi[k]);
  }
  // Places: origin, t_min, direction, t_max.
  float enter = lo[3], leave = hi[7];
  float reach = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    reach = std::max({reach, bounds.hi[a] - lo[a], hi[a] - bounds.lo[a]});
  }
  if (!(reach > 0x1p-40f && reach < 0x1p40f)) return false;
  for (std::size_t a = 0; a < 3; ++a) {
    float d0 = lo[4 + a], d1 = hi[4 + a], o0 = lo[a], o1 = hi[a];
    float b0 = bounds.lo[a], b1 = bounds.hi[a];
    if (d1 < 0) {  // as if it went up
      std::swap(d0, d1);
      d0 = -d0;
      d1 = -d1;
      std::swap(o0, o1);
      o0 = -o0;
      o1 = -o1;
      std::swap(b0, b1);
      b0 = -b0;
      b1 = -b1;
    }
    if (!(d0 > 0x1p-40f && d1 < 0x1p40f)) continue;  // both ways, or hardly any
    const float slack = 2 * kWideThickness * reach;
    const float near = b0 - o1 - slack, far = b1 - o0 + slack;
    enter = std::max(enter, near > 0 ? near / d1 : near / d0);
    leave = std::min(leave, far > 0 ? far / d0 : far / d1);
  }
  // A little more than rounding could do to the quotients.
  return enter > leave + 0x1p-20f * std::fabs(leave);
}

// Results of a packet that hits nothing, past the caches: it is most of the memory's work in a
// picture with much background.
HWY_INLINE void StreamMisses(Hit* hits) {
  static_assert(sizeof(Hit) == 16);
  const hn::FixedTag<float, 4> d;
  const Hit miss;
  if (reinterpret_cast<std::uintptr_t>(hits) % 16 != 0) {
    std::fill_n(hits, kPacket, miss);
    return;
  }
  const auto value = hn::LoadU(d, &miss.t);
  for (std::size_t i = 0; i < kPacket; ++i) hn::Stream(value, d, &hits[i].t);
}

template <bool kAny>
void TracePackets(const WideScene& scene, const WideBatch& batch) {
  const DU du;
  Packet p;
  for (std::size_t begin = 0; begin < batch.rays.size(); begin += kPacket) {
    if (begin + kPacket <= batch.rays.size() && AllMiss(&batch.rays[begin], scene.bounds)) {
      if (kAny) {
        std::fill_n(batch.flags.data() + begin, kPacket, std::uint8_t{0});
      } else {
        StreamMisses(batch.hits.data() + begin);
      }
      continue;
    }
    std::uint64_t left = PrepareBlock(scene, batch, begin, kAny, p.rays);
    if (!kAny && left != 0) {
      std::fill_n(p.id, kPacket, kNoTriangle);
    }
    while (left != 0) {
      const std::uint32_t way = p.rays.way[std::countr_zero(left)];
      std::uint64_t members = 0;
      for (std::size_t i = 0; i < kPacket; i += hn::Lanes(du)) {
        members |= std::uint64_t{BitsOf(du, hn::Eq(hn::Load(du, p.rays.way + i), hn::Set(du, way)))}
                   << i;
      }
      members &= left;
      left &= ~members;
      p.alive = members;
      p.octant = OctantOf(way);
      p.k = AxesOf(way);
      p.thickness = ThicknessOf(p, scene.bounds);
      PacketBounds b = BoundsOf(p, scene.layout->centre);
      Walk<kAny>(*scene.layout, b, p);
      if (kAny) {
        for (std::uint64_t hit = members & ~p.alive; hit != 0; hit &= hit - 1) {
          batch.flags[begin + static_cast<std::size_t>(std::countr_zero(hit))] = 1;
        }
        continue;
      }
      for (; members != 0; members &= members - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(members));
        if (p.id[i] != kNoTriangle) {
          batch.hits[begin + i] = {p.rays.t[i], p.id[i], p.u[i], p.v[i]};
        }
      }
    }
  }
}

}  // namespace

void PacketClosest(const WideScene& scene, const WideBatch& batch) {
  TracePackets<false>(scene, batch);
  hwy::FlushStream();
}
void PacketOccluded(const WideScene& scene, const WideBatch& batch) {
  TracePackets<true>(scene, batch);
}

#endif
}  // namespace HWY_NAMESPACE
}  // namespace fasttree
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fasttree {

HWY_EXPORT(PacketClosest);
HWY_EXPORT(PacketOccluded);

void packet_closest(const WideScene& scene, const WideBatch& batch) {
  HWY_DYNAMIC_DISPATCH(PacketClosest)(scene, batch);
}
void packet_occluded(const WideScene& scene, const WideBatch& batch) {
  HWY_DYNAMIC_DISPATCH(PacketOccluded)(scene, batch);
}

}  // namespace fasttree
#endif  // HWY_ONCE
