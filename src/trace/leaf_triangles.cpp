// SPDX-License-Identifier: Apache-2.0
// Compiled once for every instruction set by Highway's foreach_target.
#include "trace/leaf_triangles.h"

#include <hwy/cache_control.h>

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trace/leaf_triangles.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as Highway asks.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace fasttree {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

Box3 CopyTriangles(const MeshView& mesh, std::span<const std::uint32_t> all, std::uint32_t first,
                   std::uint32_t count, float* rows) {
  const std::span<const std::uint32_t> ids = all.subspan(first, count);
  Box3 box;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    for (std::uint32_t c = 0; c < 3; ++c) {
      const Vec3 p = mesh.position(mesh.vertex_index(ids[i], c));
      box.include(p);
      for (std::uint32_t a = 0; a < 3; ++a) rows[(3 * c + a) * ids.size() + i] = p[a];
    }
  }
  return box;
}

#else

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kIndicesAhead = 32;
constexpr std::size_t kPositionsAhead = 16;

using D4 = hn::FixedTag<float, 4>;
using V4 = hn::Vec<D4>;

// Four positions as x, y and z of four. The fourth lanes hold whatever lies behind.
HWY_INLINE void transpose(V4 a, V4 b, V4 c, V4 d, V4& x, V4& y, V4& z) {
  const D4 d4;
  const hn::Repartition<double, D4> d2;
  const auto ab = hn::InterleaveLower(d4, a, b);    // ax bx ay by
  const auto cd = hn::InterleaveLower(d4, c, d);    // cx dx cy dy
  const auto ab_z = hn::InterleaveUpper(d4, a, b);  // az bz
  const auto cd_z = hn::InterleaveUpper(d4, c, d);
  x = hn::BitCast(d4, hn::InterleaveLower(d2, hn::BitCast(d2, ab), hn::BitCast(d2, cd)));
  y = hn::BitCast(d4, hn::InterleaveUpper(d2, hn::BitCast(d2, ab), hn::BitCast(d2, cd)));
  z = hn::BitCast(d4, hn::InterleaveLower(d2, hn::BitCast(d2, ab_z), hn::BitCast(d2, cd_z)));
}

template <bool kIndexed>
HWY_INLINE Box3 Copy(const MeshView& mesh, std::span<const std::uint32_t> all, std::uint32_t first,
                     std::size_t n, float* rows) {
  const D4 d4;
  const std::uint32_t* const ids = all.data() + first;
  const auto* const positions = static_cast<const std::byte*>(mesh.positions);
  const std::size_t stride = mesh.position_stride_bytes;
  const std::uint32_t last = mesh.vertex_count - 1;
  const auto index = [&](std::uint32_t id, std::uint32_t c) HWY_ATTR {
    return kIndexed ? mesh.indices[std::size_t{3} * id + c] : mesh.vertex_index(id, c);
  };
  // 16 bytes are read of each position but the last.
  const auto position = [&](std::uint32_t vertex) HWY_ATTR {
    if (HWY_UNLIKELY(vertex == last)) {
      const Vec3 p = mesh.position(vertex);
      HWY_ALIGN const float lanes[4] = {p.x, p.y, p.z, p.z};
      return hn::Load(d4, lanes);
    }
    return hn::LoadU(d4, reinterpret_cast<const float*>(positions + vertex * stride));
  };
  auto lo = hn::Set(d4, std::numeric_limits<float>::infinity());
  auto hi = hn::Neg(lo);
  // What the next leaves need is asked for early: they are the next ids.
  const std::size_t ahead = all.size() - first;
  std::size_t i = 0;
  for (; i + 4 <= n; i += 4) {
    if (kIndexed && i + kIndicesAhead + 4 <= ahead) {
      for (std::size_t k = 0; k < 4; ++k) {
        hwy::Prefetch(mesh.indices + std::size_t{3} * ids[i + kIndicesAhead + k]);
      }
      for (std::size_t k = 0; k < 4; ++k) {
        for (std::uint32_t c = 0; c < 3; c += 2) {
          hwy::Prefetch(positions + index(ids[i + kPositionsAhead + k], c) * stride);
        }
      }
    }
    for (std::uint32_t c = 0; c < 3; ++c) {
      const auto p0 = position(index(ids[i], c));
      const auto p1 = position(index(ids[i + 1], c));
      const auto p2 = position(index(ids[i + 2], c));
      const auto p3 = position(index(ids[i + 3], c));
      lo = hn::Min(lo, hn::Min(hn::Min(p0, p1), hn::Min(p2, p3)));
      hi = hn::Max(hi, hn::Max(hn::Max(p0, p1), hn::Max(p2, p3)));
      V4 x, y, z;
      transpose(p0, p1, p2, p3, x, y, z);
      hn::StoreU(x, d4, rows + (3 * c + 0) * n + i);
      hn::StoreU(y, d4, rows + (3 * c + 1) * n + i);
      hn::StoreU(z, d4, rows + (3 * c + 2) * n + i);
    }
  }
  for (; i < n; ++i) {
    for (std::uint32_t c = 0; c < 3; ++c) {
      const auto p = position(index(ids[i], c));
      lo = hn::Min(lo, p);
      hi = hn::Max(hi, p);
      HWY_ALIGN float lanes[4];
      hn::Store(p, d4, lanes);
      for (std::uint32_t a = 0; a < 3; ++a) rows[(3 * c + a) * n + i] = lanes[a];
    }
  }
  HWY_ALIGN float box[8];
  hn::Store(lo, d4, box);
  hn::Store(hi, d4, box + 4);
  return {{box[0], box[1], box[2]}, {box[4], box[5], box[6]}};
}

Box3 CopyTriangles(const MeshView& mesh, std::span<const std::uint32_t> all, std::uint32_t first,
                   std::uint32_t count, float* rows) {
  return mesh.indices != nullptr ? Copy<true>(mesh, all, first, count, rows)
                                 : Copy<false>(mesh, all, first, count, rows);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace fasttree
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fasttree {

HWY_EXPORT(CopyTriangles);

Box3 LeafTriangles::operator()(std::uint32_t first, std::uint32_t count, float* rows) const {
  return HWY_DYNAMIC_DISPATCH(CopyTriangles)(mesh_, ids_, first, count, rows);
}

}  // namespace fasttree
#endif  // HWY_ONCE
