// SPDX-License-Identifier: Apache-2.0
// 64 rays on their way together, the intervals round them, and both against the boxes of nodes.
// Included once for every instruction set (Highway).
#if defined(FASTTREE_TRACE_PACKET_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FASTTREE_TRACE_PACKET_INL_H_
#undef FASTTREE_TRACE_PACKET_INL_H_
#else
#define FASTTREE_TRACE_PACKET_INL_H_
#endif

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "trace/ray_block-inl.h"
#include "trace/wide_kernels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fasttree {
namespace HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

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
  Intervals children;
  for (std::size_t k = 0, i = 0; k < Intervals::kVectors; ++k, i += hn::Lanes(d)) {
    const Interval t = IntervalOf(
        b, p.octant, b.near_origin, b.far_origin,
        [&](std::size_t a) HWY_ATTR { return hn::Load(d, node.bound[0][a] + i); },
        [&](std::size_t a) HWY_ATTR { return hn::Load(d, node.bound[1][a] + i); });
    children.enter[k] = t.enter;
    children.leave[k] = t.leave;
  }
  p.depth = Push(node, index, p.octant, children, p.entries, p.enters, p.depth);
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

#endif  // HWY_SCALAR
}  // namespace HWY_NAMESPACE
}  // namespace fasttree
HWY_AFTER_NAMESPACE();

#endif
