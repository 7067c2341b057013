// SPDX-License-Identifier: Apache-2.0
// Compiled once for every instruction set by Highway's foreach_target; the plain C++ forms and the
// choice between them stand at the end.
#include "build/vertex_cells.h"

#include <tbb/blocked_range.h>
#include <tbb/combinable.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "build/vertex_cells.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as Highway asks.
#include <hwy/highway.h>

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

std::size_t QuantisePacked(const float* xyz, std::size_t count, const Box3& bounds,
                           const std::array<AxisQuantiser, 3>& quantisers, VertexCell* cells) {
  const hn::ScalableTag<float> d;
  const hn::RebindToSigned<decltype(d)> di;
  const hn::Rebind<std::uint16_t, decltype(d)> d16;
  const std::size_t lanes = hn::Lanes(d);
  const auto last = hn::Set(d, static_cast<float>(kFinestCells - 1));
  auto* const out = reinterpret_cast<std::uint16_t*>(cells);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    auto x = hn::Zero(d), y = x, z = x;
    hn::LoadInterleaved3(d, xyz + 3 * i, x, y, z);
    auto touches = hn::Zero(di);
    const auto q = [&](auto v, int a) {
      const auto lo = hn::Set(d, bounds.lo[static_cast<std::size_t>(a)]);
      const auto hi = hn::Set(d, bounds.hi[static_cast<std::size_t>(a)]);
      const auto at_lo = hn::RebindMask(di, hn::Eq(v, lo));
      const auto at_hi = hn::RebindMask(di, hn::Eq(v, hi));
      touches = hn::Or(touches, hn::IfThenElseZero(at_lo, hn::Set(di, 1 << a)));
      touches = hn::Or(touches, hn::IfThenElseZero(at_hi, hn::Set(di, 8 << a)));
      const AxisQuantiser& quantiser = quantisers[static_cast<std::size_t>(a)];
      const auto t = hn::Mul(hn::Sub(v, hn::Set(d, quantiser.lo)), hn::Set(d, quantiser.scale));
      const auto cell = hn::ConvertTo(di, hn::Min(hn::Max(t, hn::Zero(d)), last));
      return hn::DemoteTo(d16, cell);
    };
    const auto qx = q(x, 0), qy = q(y, 1), qz = q(z, 2);
    hn::StoreInterleaved4(qx, qy, qz, hn::DemoteTo(d16, touches), d16, out + 4 * i);
  }
  return i;
}

}  // namespace HWY_NAMESPACE
}  // namespace fasttree::build
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fasttree::build {

HWY_EXPORT(BoundsOfPacked);
HWY_EXPORT(QuantisePacked);

namespace {

constexpr std::size_t kVerticesPerTask = 8192;

bool packed(const MeshView& mesh) {
  return mesh.position_stride_bytes == 3 * sizeof(float) &&
         reinterpret_cast<std::uintptr_t>(mesh.positions) % alignof(float) == 0;
}

const float* packed_at(const MeshView& mesh, std::size_t vertex) {
  return static_cast<const float*>(mesh.positions) + 3 * vertex;
}

template <typename Work>
void for_each_range(std::size_t vertices, const Work& work) {
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, vertices, kVerticesPerTask),
      [&](const tbb::blocked_range<std::size_t>& range) { work(range.begin(), range.end()); });
}

VertexCell cell_of(Vec3 p, const Box3& bounds, const std::array<AxisQuantiser, 3>& quantisers) {
  VertexCell cell;
  for (std::size_t a = 0; a < 3; ++a) {
    cell.q[a] = static_cast<std::uint16_t>(quantisers[a](p[a]));
    if (p[a] == bounds.lo[a]) cell.touches = static_cast<std::uint16_t>(cell.touches | 1 << a);
    if (p[a] == bounds.hi[a]) cell.touches = static_cast<std::uint16_t>(cell.touches | 8 << a);
  }
  return cell;
}

}  // namespace

bool vertex_bounds(const MeshView& mesh, Simd simd, Box3& bounds) {
  const bool vectors = simd == Simd::widest && packed(mesh);
  std::atomic<bool> all_finite = true;
  tbb::combinable<Box3> parts;
  for_each_range(mesh.vertex_count, [&](std::size_t first, std::size_t end) {
    Box3& box = parts.local();
    bool finite = true;
    if (vectors) {
      first +=
          HWY_DYNAMIC_DISPATCH(BoundsOfPacked)(packed_at(mesh, first), end - first, box, finite);
    }
    for (; first < end; ++first) {
      const Vec3 p = mesh.position(static_cast<std::uint32_t>(first));
      finite = finite && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
      box.include(p);
    }
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

void quantise_vertices(const MeshView& mesh, const Box3& bounds,
                       const std::array<AxisQuantiser, 3>& quantisers, Simd simd,
                       std::vector<VertexCell>& cells) {
  const bool vectors = simd == Simd::widest && packed(mesh);
  cells.resize(mesh.vertex_count);
  for_each_range(mesh.vertex_count, [&](std::size_t first, std::size_t end) {
    if (vectors) {
      first += HWY_DYNAMIC_DISPATCH(QuantisePacked)(packed_at(mesh, first), end - first, bounds,
                                                    quantisers, &cells[first]);
    }
    for (; first < end; ++first) {
      cells[first] = cell_of(mesh.position(static_cast<std::uint32_t>(first)), bounds, quantisers);
    }
  });
}

const char* widest_simd_name() {
  // The lowest bit is the widest set.
  return hwy::TargetName(hwy::SupportedTargets() & -hwy::SupportedTargets());
}

}  // namespace fasttree::build
#endif  // HWY_ONCE
