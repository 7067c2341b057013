// SPDX-License-Identifier: Apache-2.0
// Rays that go nearly alike, 64 at a time: intervals round all of them against the boxes of a node,
// and against those of a leaf's triangles; single rays only against what is left. Compiled once for
// every instruction set.
#include <hwy/cache_control.h>

#include <algorithm>
#include <bit>
#include <vector>

#include "trace/wide_trace.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trace/wide_packet.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as Highway asks.
#include <hwy/highway.h>

#include "trace/packet-inl.h"
#include "trace/packet_triangles-inl.h"

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

// Results of a packet, past the caches: a batch has more of them than the caches hold.
HWY_INLINE bool CanStream(const Hit* hits) {
  static_assert(sizeof(Hit) == 16);
  return reinterpret_cast<std::uintptr_t>(hits) % 16 == 0;
}

HWY_INLINE void WriteMisses(Hit* hits) {
  const hn::FixedTag<float, 4> d;
  const Hit miss;
  if (!CanStream(hits)) {
    std::fill_n(hits, kPacket, miss);
    return;
  }
  const auto value = hn::LoadU(d, &miss.t);
  for (std::size_t i = 0; i < kPacket; ++i) hn::Stream(value, d, &hits[i].t);
}

// Those of `traced` that have found something; the others have missed.
HWY_INLINE void WriteHits(const Packet& p, std::uint64_t traced, std::size_t count, Hit* hits) {
  const DF d;
  const DU du;
  const std::uint32_t all = static_cast<std::uint32_t>((std::uint64_t{1} << hn::Lanes(d)) - 1);
  HWY_ALIGN Hit block[16];
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto id = hn::Load(du, p.id + i);
    const auto hit = hn::And(hn::RebindMask(d, hn::Ne(id, hn::Set(du, kNoTriangle))),
                             MaskOf(d, static_cast<std::uint32_t>(traced >> i) & all));
    const auto no_triangle = hn::BitCast(d, hn::Set(du, kNoTriangle));
    hn::StoreInterleaved4(hn::IfThenElse(hit, hn::Load(d, p.rays.t + i), hn::Set(d, HUGE_VALF)),
                          hn::IfThenElse(hit, hn::BitCast(d, id), no_triangle),
                          hn::IfThenElseZero(hit, hn::Load(d, p.u + i)),
                          hn::IfThenElseZero(hit, hn::Load(d, p.v + i)), d, &block[0].t);
    const std::size_t here = std::min(hn::Lanes(d), count - i);
    if (here == hn::Lanes(d) && CanStream(hits)) {
      const hn::FixedTag<float, 4> d4;
      for (std::size_t j = 0; j < here; ++j) {
        hn::Stream(hn::Load(d4, &block[j].t), d4, &hits[i + j].t);
      }
    } else {
      std::copy(block, block + here, hits + i);
    }
  }
}

// Rays are asked for this many before their turn: packets that miss the scene go by quickly.
constexpr std::size_t kAhead = 2 * kPacket;

template <bool kAny>
void TracePackets(const WideScene& scene, const WideBatch& batch) {
  const DU du;
  Packet p;
  for (std::size_t begin = 0; begin < batch.rays.size(); begin += kPacket) {
    PrefetchRays(batch, begin + kAhead);
    const std::size_t count = std::min(kPacket, batch.rays.size() - begin);
    if (kAny) std::fill_n(batch.flags.data() + begin, count, std::uint8_t{0});
    if (count == kPacket && AllMiss(&batch.rays[begin], scene.bounds)) {
      if (!kAny) WriteMisses(batch.hits.data() + begin);
      continue;
    }
    const std::uint64_t traced = PrepareBlock(scene, batch, begin, p.rays);
    if (!kAny) std::fill_n(p.id, kPacket, kNoTriangle);
    for (std::uint64_t left = traced; left != 0;) {
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
      }
    }
    if (!kAny) WriteHits(p, traced, count, batch.hits.data() + begin);
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
