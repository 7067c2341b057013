// SPDX-License-Identifier: Apache-2.0
// Boxes of a layer's triangles: bounds, cells, and how many of them. Compiled once for every
// instruction set by Highway's foreach_target; the plain C++ forms and the choice between them
// stand at the end.
#include "build/layer_kernels.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "build/layer_kernels.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as Highway asks.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace fasttree::build {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using F = hn::ScalableTag<float>;
using I = hn::RebindToSigned<F>;
using VF = hn::Vec<F>;
using VI = hn::Vec<I>;

// Counters of a lane hold what this many triangles can add.
constexpr std::size_t kTrianglesPerSum = std::size_t{1} << 20;

Box3 BoundsOf(const LayerTriangles& triangles) {
  const F d;
  Box3 box;
  for (std::size_t a = 0; a < 3; ++a) {
    auto lo = hn::LoadU(d, triangles.coordinate[a].data()), hi = lo;
    for (std::size_t c = 0; c < 3; ++c) {
      const float* const v = triangles.coordinate[3 * c + a].data();
      for (std::size_t i = 0; i < triangles.size; i += hn::Lanes(d)) {
        const auto x = hn::LoadU(d, v + i);
        lo = hn::Min(lo, x);
        hi = hn::Max(hi, x);
      }
    }
    box.lo[a] = hn::GetLane(hn::MinOfLanes(d, lo));
    box.hi[a] = hn::GetLane(hn::MaxOfLanes(d, hi));
  }
  return box;
}

// The sum over triangles of f(first of a vector's triangles).
template <typename CountOf>
std::uint64_t SumOf(std::size_t count, const CountOf& f) {
  const I di;
  const std::size_t lanes = hn::Lanes(di);
  std::uint64_t all = 0;
  for (std::size_t begin = 0; begin < count; begin += kTrianglesPerSum) {
    const std::size_t end = std::min(count, begin + kTrianglesPerSum);
    auto sum = hn::Zero(di);
    for (std::size_t i = begin; i < end; i += lanes) {
      const auto n = f(i);
      sum = hn::Add(sum, end - i >= lanes ? n : hn::IfThenElseZero(hn::FirstN(di, end - i), n));
    }
    HWY_ALIGN std::int32_t lane[hn::MaxLanes(I())];
    hn::Store(sum, di, lane);
    for (std::size_t l = 0; l < lanes; ++l) all += static_cast<std::uint32_t>(lane[l]);
  }
  return all;
}

std::uint64_t QuantiseLayer(const LayerTriangles& triangles, const LocalGrid& grid,
                            LayerCells& cells) {
  const F d;
  const I di;
  const auto last = hn::Set(d, static_cast<float>(kFinestCells - 1));
  return SumOf(triangles.size, [&](std::size_t i) {
    auto count = hn::Set(di, 1);
    for (std::size_t a = 0; a < 3; ++a) {
      const AxisQuantiser& quantiser = grid.quantiser(a);
      const auto origin = hn::Set(d, quantiser.lo);
      const auto scale = hn::Set(d, quantiser.scale);
      const auto v0 = hn::LoadU(d, triangles.coordinate[a].data() + i);
      const auto v1 = hn::LoadU(d, triangles.coordinate[3 + a].data() + i);
      const auto v2 = hn::LoadU(d, triangles.coordinate[6 + a].data() + i);
      // The quantiser is monotone: the corners of the box are those of its bounds.
      const auto q = [&](VF v) {
        const auto x = hn::Mul(hn::Sub(v, origin), scale);
        return hn::ShiftRightSame(hn::ConvertTo(di, hn::Min(hn::Max(x, hn::Zero(d)), last)),
                                  kMaxAxisBits - grid.bits(a));
      };
      const auto lo = q(hn::Min(hn::Min(v0, v1), v2));
      const auto hi = q(hn::Max(hn::Max(v0, v1), v2));
      hn::StoreU(lo, di, cells.lo[a].data() + i);
      hn::StoreU(hi, di, cells.hi[a].data() + i);
      count = hn::Mul(count, hn::Add(hn::Sub(hi, lo), hn::Set(di, 1)));
    }
    return count;
  });
}

std::uint64_t CoarsenLayer(std::size_t count, std::size_t axis, LayerCells& cells) {
  const I di;
  return SumOf(count, [&](std::size_t i) {
    auto n = hn::Set(di, 1);
    for (std::size_t a = 0; a < 3; ++a) {
      auto lo = hn::LoadU(di, cells.lo[a].data() + i);
      auto hi = hn::LoadU(di, cells.hi[a].data() + i);
      if (a == axis) {
        lo = hn::ShiftRight<1>(lo);
        hi = hn::ShiftRight<1>(hi);
        hn::StoreU(lo, di, cells.lo[a].data() + i);
        hn::StoreU(hi, di, cells.hi[a].data() + i);
      }
      n = hn::Mul(n, hn::Add(hn::Sub(hi, lo), hn::Set(di, 1)));
    }
    return n;
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace fasttree::build
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fasttree::build {

HWY_EXPORT(BoundsOf);
HWY_EXPORT(QuantiseLayer);
HWY_EXPORT(CoarsenLayer);

namespace {

std::uint64_t count_boxes(std::size_t count, const LayerCells& cells) {
  std::uint64_t all = 0;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t n = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      n *= static_cast<std::uint32_t>(cells.hi[a][i] - cells.lo[a][i] + 1);
    }
    all += n;
  }
  return all;
}

}  // namespace

Box3 bounds_of(const LayerTriangles& triangles, Simd simd) {
  if (simd == Simd::widest) return HWY_DYNAMIC_DISPATCH(BoundsOf)(triangles);
  Box3 box;
  for (std::size_t i = 0; i < triangles.size; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      box.include({triangles.coordinate[3 * c][i], triangles.coordinate[3 * c + 1][i],
                   triangles.coordinate[3 * c + 2][i]});
    }
  }
  return box;
}

std::uint64_t quantise_layer(const LayerTriangles& triangles, const LocalGrid& grid, Simd simd,
                             LayerCells& cells) {
  if (simd == Simd::widest) return HWY_DYNAMIC_DISPATCH(QuantiseLayer)(triangles, grid, cells);
  for (std::size_t a = 0; a < 3; ++a) {
    const AxisQuantiser& quantiser = grid.quantiser(a);
    for (std::size_t i = 0; i < triangles.size; ++i) {
      const std::uint32_t q0 = quantiser(triangles.coordinate[a][i]);
      const std::uint32_t q1 = quantiser(triangles.coordinate[3 + a][i]);
      const std::uint32_t q2 = quantiser(triangles.coordinate[6 + a][i]);
      const int shift = kMaxAxisBits - grid.bits(a);
      cells.lo[a][i] = static_cast<std::int32_t>(std::min({q0, q1, q2}) >> shift);
      cells.hi[a][i] = static_cast<std::int32_t>(std::max({q0, q1, q2}) >> shift);
    }
  }
  return count_boxes(triangles.size, cells);
}

std::uint64_t coarsen_layer(std::size_t count, std::size_t axis, Simd simd, LayerCells& cells) {
  if (simd == Simd::widest) return HWY_DYNAMIC_DISPATCH(CoarsenLayer)(count, axis, cells);
  for (std::size_t i = 0; i < count; ++i) {
    cells.lo[axis][i] >>= 1;
    cells.hi[axis][i] >>= 1;
  }
  return count_boxes(count, cells);
}

}  // namespace fasttree::build
#endif  // HWY_ONCE
