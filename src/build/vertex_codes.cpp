// SPDX-License-Identifier: Apache-2.0
// Compiled once for every instruction set by Highway's foreach_target; the plain C++ forms and the
// choice between them stand at the end.
#include "build/vertex_codes.h"

#include <tbb/blocked_range.h>
#include <tbb/combinable.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "build/vertex_codes.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as Highway asks.
#include <hwy/highway.h>

#include "build/bit_spread-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fasttree::build {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// `xyz` holds `count` packed positions; whole vectors of them are taken, the number is returned.
std::size_t BoundsOfPacked(const float* xyz, std::size_t count, Box3& bounds, bool& finite) {
  const hn::ScalableTag<float> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto largest = hn::Set(d, std::numeric_limits<float>::max());
  const auto inf = hn::Set(d, std::numeric_limits<float>::infinity());
  auto lo0 = inf, lo1 = inf, lo2 = inf;
  auto hi0 = hn::Neg(inf), hi1 = hi0, hi2 = hi0;
  auto within = hn::Eq(inf, inf);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    auto x = inf, y = inf, z = inf;
    hn::LoadInterleaved3(d, xyz + 3 * i, x, y, z);
    lo0 = hn::Min(lo0, x);
    lo1 = hn::Min(lo1, y);
    lo2 = hn::Min(lo2, z);
    hi0 = hn::Max(hi0, x);
    hi1 = hn::Max(hi1, y);
    hi2 = hn::Max(hi2, z);
    within =
        hn::And(within, hn::And(hn::Le(hn::Abs(x), largest),
                                hn::And(hn::Le(hn::Abs(y), largest), hn::Le(hn::Abs(z), largest))));
  }
  if (i == 0) return 0;
  finite = finite && hn::AllTrue(d, within);
  bounds.include({hn::GetLane(hn::MinOfLanes(d, lo0)), hn::GetLane(hn::MinOfLanes(d, lo1)),
                  hn::GetLane(hn::MinOfLanes(d, lo2))});
  bounds.include({hn::GetLane(hn::MaxOfLanes(d, hi0)), hn::GetLane(hn::MaxOfLanes(d, hi1)),
                  hn::GetLane(hn::MaxOfLanes(d, hi2))});
  return i;
}

std::size_t EncodePacked(const float* xyz, std::size_t count, const VertexEncoder& encoder,
                         std::uint32_t* codes) {
  const hn::ScalableTag<float> d;
  const hn::RebindToSigned<decltype(d)> di;
  const hn::RebindToUnsigned<decltype(d)> du;
  const std::size_t lanes = hn::Lanes(d);
  const auto last = hn::Set(d, static_cast<float>(kFinestCells - 1));
  const VertexEncoder e = encoder;  // a copy: what `codes` points to is not it
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    auto x = hn::Zero(d), y = x, z = x;
    hn::LoadInterleaved3(d, xyz + 3 * i, x, y, z);
    auto touches = hn::Eq(last, hn::Zero(d));
    auto inside = hn::Eq(last, last);
    const auto code = [&](auto v, std::size_t a) {
      touches = hn::Or(touches, hn::Or(hn::Eq(v, hn::Set(d, e.sides.lo[a])),
                                       hn::Eq(v, hn::Set(d, e.sides.hi[a]))));
      inside = hn::And(inside, hn::And(hn::Ge(v, hn::Set(d, e.bounds.lo[a])),
                                       hn::Le(v, hn::Set(d, e.bounds.hi[a]))));
      const AxisQuantiser& quantiser = e.quantisers[a];
      const auto t = hn::Mul(hn::Sub(v, hn::Set(d, quantiser.lo)), hn::Set(d, quantiser.scale));
      const auto q = hn::ConvertTo(di, hn::Min(hn::Max(t, hn::Zero(d)), last));
      const int shift = kMaxAxisBits - e.axes.bits[a];
      return Spread(du, hn::ShiftRightSame(hn::BitCast(du, q), shift), e.axes.axis[a]);
    };
    const auto all = hn::Or(code(x, 0), hn::Or(code(y, 1), code(z, 2)));
    const auto touch = hn::IfThenElseZero(hn::RebindMask(du, touches), hn::Set(du, kTouchesBounds));
    const auto out = hn::IfThenZeroElse(hn::RebindMask(du, inside), hn::Set(du, kOutside));
    hn::StoreU(hn::Or(all, hn::Or(touch, out)), du, codes + i);
  }
  return i;
}

}  // namespace HWY_NAMESPACE
}  // namespace fasttree::build
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fasttree::build {

HWY_EXPORT(BoundsOfPacked);
HWY_EXPORT(EncodePacked);

namespace {

constexpr std::size_t kVerticesPerTask = 8192;

bool packed(const MeshView& mesh) {
  return mesh.position_stride_bytes == 3 * sizeof(float) &&
         reinterpret_cast<std::uintptr_t>(mesh.positions) % alignof(float) == 0;
}

const float* packed_at(const MeshView& mesh, std::size_t vertex) {
  return static_cast<const float*>(mesh.positions) + 3 * vertex;
}

// Gives vertices first ... end - 1 to `work(packed positions, their number, the first's index)`,
// which takes whole vectors of them and returns how many. Positions that lie otherwise, as in the
// records of a scene file, are packed first, in blocks. Returns the first vertex that is left.
template <typename Work>
std::size_t for_vectors(const MeshView& mesh, std::size_t first, std::size_t end,
                        const Work& work) {
  if (packed(mesh)) return first + work(packed_at(mesh, first), end - first, first);
  constexpr std::size_t kBlock = 256;
  std::array<Vec3, kBlock> block;
  while (first < end) {
    const std::size_t count = std::min(kBlock, end - first);
    for (std::size_t i = 0; i < count; ++i) {
      block[i] = mesh.position(static_cast<std::uint32_t>(first + i));
    }
    const std::size_t taken = work(&block[0].x, count, first);
    first += taken;
    if (taken < count) break;
  }
  return first;
}

template <typename Work>
void for_each_range(std::size_t vertices, const Work& work) {
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, vertices, kVerticesPerTask),
      [&](const tbb::blocked_range<std::size_t>& range) { work(range.begin(), range.end()); });
}

std::uint32_t code_of(Vec3 p, const VertexEncoder& e) {
  std::uint32_t code = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    code |= e.axes.axis[a].spread(e.quantisers[a](p[a]) >> (kMaxAxisBits - e.axes.bits[a]));
    if (p[a] == e.sides.lo[a] || p[a] == e.sides.hi[a]) code |= kTouchesBounds;
    if (!(p[a] >= e.bounds.lo[a] && p[a] <= e.bounds.hi[a])) code |= kOutside;
  }
  return code;
}

}  // namespace

bool vertex_bounds(const MeshView& mesh, std::span<const std::uint32_t> skipped, Simd simd,
                   Box3& bounds) {
  const bool vectors = simd == Simd::widest;
  std::atomic<bool> all_finite = true;
  tbb::combinable<Box3> parts;
  for_each_range(mesh.vertex_count, [&](std::size_t first, std::size_t end) {
    Box3& box = parts.local();
    bool finite = true;
    const auto look_at = [&](std::size_t v, std::size_t stop) {
      if (vectors) {
        v = for_vectors(mesh, v, stop, [&](const float* xyz, std::size_t count, std::size_t) {
          return HWY_DYNAMIC_DISPATCH(BoundsOfPacked)(xyz, count, box, finite);
        });
      }
      for (; v < stop; ++v) {
        const Vec3 p = mesh.position(static_cast<std::uint32_t>(v));
        finite = finite && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
        box.include(p);
      }
    };
    auto skip = std::lower_bound(skipped.begin(), skipped.end(), first);
    for (; skip != skipped.end() && *skip < end; ++skip) {
      look_at(first, *skip);
      first = *skip + std::size_t{1};
    }
    look_at(first, end);
    if (!finite) all_finite.store(false, std::memory_order_relaxed);
  });
  bounds = {};
  parts.combine_each([&](const Box3& part) {
    bounds.include(part.lo);
    bounds.include(part.hi);
  });
  for (std::size_t a = 0; a < 3; ++a) {
    bounds.lo[a] += 0.0f;  // minus zero becomes plus zero
    bounds.hi[a] += 0.0f;
    if (!std::isfinite(bounds.hi[a] - bounds.lo[a])) return false;
  }
  return all_finite;
}

VertexEncoder::VertexEncoder(const Box3& scene, const AxisLevels& schedule, int depth)
    : quantisers{make_axis_quantiser(scene, schedule, 0), make_axis_quantiser(scene, schedule, 1),
                 make_axis_quantiser(scene, schedule, 2)},
      axes(schedule, depth),
      bounds(scene),
      sides(scene) {
  constexpr float kNever = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t a = 0; a < 3; ++a) {
    if (scene.lo[a] == scene.hi[a]) sides.lo[a] = sides.hi[a] = kNever;
  }
}

void encode_vertices(const MeshView& mesh, const VertexEncoder& encoder, Simd simd,
                     Buffer<std::uint32_t>& codes) {
  const bool vectors = simd == Simd::widest;
  codes.resize(mesh.vertex_count);
  for_each_range(mesh.vertex_count, [&](std::size_t first, std::size_t end) {
    if (vectors) {
      first = for_vectors(
          mesh, first, end, [&](const float* xyz, std::size_t count, std::size_t vertex) {
            return HWY_DYNAMIC_DISPATCH(EncodePacked)(xyz, count, encoder, &codes[vertex]);
          });
    }
    for (; first < end; ++first) {
      codes[first] = code_of(mesh.position(static_cast<std::uint32_t>(first)), encoder);
    }
  });
}

const char* widest_simd_name() {
  // The lowest bit is the widest set.
  return hwy::TargetName(hwy::SupportedTargets() & -hwy::SupportedTargets());
}

}  // namespace fasttree::build
#endif  // HWY_ONCE
