// SPDX-License-Identifier: Apache-2.0
// Which of its cells a triangle of a layer is put into. Compiled once for every instruction set by
// Highway's foreach_target; the plain C++ forms and the choice between them stand at the end.
#include <algorithm>
#include <array>
#include <bit>

#include "build/layer_kernels.h"
#include "grid/cell_overlap.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "build/layer_masks.cpp"
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

// CellOverlap for a vector of triangles and the two by two by two cells from their lowest: bit x +
// 2 y + 4 z of the result is the cell at that offset.
VI OverlapMask(const VF (&corner)[3][3], const VF (&origin)[3]) {
  const F d;
  const I di;
  const auto zero = hn::Zero(d);
  auto largest = zero;
  VF p[3][3];
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t a = 0; a < 3; ++a) {
      largest = hn::Max(largest, hn::Abs(corner[c][a]));
      p[c][a] = hn::Sub(corner[c][a], origin[a]);
    }
  }
  largest = hn::Add(largest, hn::Set(d, 1.0f));
  const auto untested = hn::Not(hn::Le(largest, hn::Set(d, kOverlapLargest)));
  const auto slack = hn::Mul(largest, hn::Set(d, kOverlapSlack));
  const auto least = hn::Set(d, kOverlapLeast);
  // Bits of the cells with each offset on two axes, u + 2 v, and w any.
  const auto outside_of = [&](std::size_t w, std::size_t u, std::size_t v) {
    const int step[3] = {1, 2, 4};
    int bits = 0;
    for (int at = 0; at < 2; ++at) {
      bits |= 1 << (at * step[w] + static_cast<int>(u) * step[(w + 1) % 3] +
                    static_cast<int>(v) * step[(w + 2) % 3]);
    }
    return hn::Set(di, bits);
  };

  auto outside = hn::Zero(di);
  for (std::size_t w = 0; w < 3; ++w) {
    const std::size_t u = (w + 1) % 3, v = (w + 2) % 3;
    auto out00 = hn::Lt(zero, zero), out10 = out00, out01 = out00, out11 = out00;
    for (std::size_t e = 0; e < 3; ++e) {
      const auto& from = p[e];
      const auto& to = p[(e + 1) % 3];
      const auto& third = p[(e + 2) % 3];
      auto nu = hn::Sub(from[v], to[v]);
      auto nv = hn::Sub(to[u], from[u]);
      const auto side =
          hn::Add(hn::Mul(nu, hn::Sub(third[u], from[u])), hn::Mul(nv, hn::Sub(third[v], from[v])));
      const auto sign = hn::And(side, hn::SignBit(d));
      nu = hn::Xor(nu, sign);
      nv = hn::Xor(nv, sign);
      const auto reach = hn::Add(hn::Add(hn::Max(nu, zero), hn::Max(nv, zero)),
                                 hn::Add(hn::Mul(hn::Add(hn::Abs(nu), hn::Abs(nv)), slack), least));
      const auto base = hn::Sub(reach, hn::Add(hn::Mul(nu, from[u]), hn::Mul(nv, from[v])));
      out00 = hn::Or(out00, hn::Lt(base, zero));
      out10 = hn::Or(out10, hn::Lt(hn::Add(nu, base), zero));
      out01 = hn::Or(out01, hn::Lt(hn::Add(nv, base), zero));
      out11 = hn::Or(out11, hn::Lt(hn::Add(hn::Add(nu, nv), base), zero));
    }
    const auto add = [&](hn::Mask<F> out, VI bits) {
      outside = hn::Or(outside, hn::IfThenElseZero(hn::RebindMask(di, out), bits));
    };
    add(out00, outside_of(w, 0, 0));
    add(out10, outside_of(w, 1, 0));
    add(out01, outside_of(w, 0, 1));
    add(out11, outside_of(w, 1, 1));
  }

  VF edge1[3] = {zero, zero, zero}, edge2[3] = {zero, zero, zero};
  for (std::size_t a = 0; a < 3; ++a) {
    edge1[a] = hn::Sub(p[1][a], p[0][a]);
    edge2[a] = hn::Sub(p[2][a], p[0][a]);
  }
  VF normal[3] = {zero, zero, zero}, size[3] = {zero, zero, zero};
  for (std::size_t w = 0; w < 3; ++w) {
    const auto a = hn::Mul(edge1[(w + 1) % 3], edge2[(w + 2) % 3]);
    const auto b = hn::Mul(edge1[(w + 2) % 3], edge2[(w + 1) % 3]);
    normal[w] = hn::Sub(a, b);
    size[w] = hn::Add(hn::Abs(a), hn::Abs(b));
  }
  const auto room = hn::Add(hn::Mul(hn::Add(hn::Add(size[0], size[1]), size[2]), slack), least);
  const auto at = hn::Add(hn::Add(hn::Mul(normal[0], p[0][0]), hn::Mul(normal[1], p[0][1])),
                          hn::Mul(normal[2], p[0][2]));
  const auto above =
      hn::Sub(hn::Add(hn::Add(hn::Add(hn::Max(normal[0], zero), hn::Max(normal[1], zero)),
                              hn::Max(normal[2], zero)),
                      room),
              at);
  const auto below =
      hn::Sub(hn::Sub(hn::Add(hn::Add(hn::Min(normal[0], zero), hn::Min(normal[1], zero)),
                              hn::Min(normal[2], zero)),
                      room),
              at);
  for (std::size_t cell = 0; cell < 8; ++cell) {
    auto n = zero;
    if (cell & 1) n = normal[0];
    if (cell & 2) n = cell & 1 ? hn::Add(n, normal[1]) : normal[1];
    if (cell & 4) n = cell & 3 ? hn::Add(n, normal[2]) : normal[2];
    const auto out = hn::Or(hn::Lt(hn::Add(n, above), zero), hn::Gt(hn::Add(n, below), zero));
    outside = hn::Or(outside, hn::IfThenElseZero(hn::RebindMask(di, out), hn::Set(di, 1 << cell)));
  }
  outside = hn::IfThenZeroElse(hn::RebindMask(di, untested), outside);
  return hn::AndNot(outside, hn::Set(di, 255));
}

void MaskLayer(const LayerTriangles& triangles, const LocalGrid& grid, LayerCells& cells) {
  const F d;
  const I di;
  const hn::Rebind<std::uint8_t, I> d8;
  const hn::RebindToUnsigned<I> du;
  const std::size_t lanes = hn::Lanes(di);
  std::size_t tests = 0, large = 0;
  for (std::size_t i = 0; i < triangles.size; i += lanes) {
    const auto span = [&](std::size_t a) {
      return hn::Sub(hn::LoadU(di, cells.hi[a].data() + i), hn::LoadU(di, cells.lo[a].data() + i));
    };
    const auto one = hn::Set(di, 1);
    const auto x = span(0), y = span(1), z = span(2);
    const auto small = hn::Not(hn::Gt(hn::Max(hn::Max(x, y), z), one));
    auto mask = hn::Add(one, hn::Add(x, x));
    mask = hn::Add(mask, hn::IfThenElseZero(hn::Gt(y, hn::Zero(di)), hn::ShiftLeft<2>(mask)));
    mask = hn::Add(mask, hn::IfThenElseZero(hn::Gt(z, hn::Zero(di)), hn::ShiftLeft<4>(mask)));
    mask = hn::IfThenElseZero(small, mask);
    hn::StoreU(hn::DemoteTo(d8, mask), d8, cells.mask.data() + i);
    auto tested = hn::And(small, hn::Gt(hn::Add(hn::Add(x, y), z), one));
    auto is_large = hn::Not(small);
    if (triangles.size - i < lanes) {
      const auto there = hn::FirstN(di, triangles.size - i);
      tested = hn::And(tested, there);
      is_large = hn::And(is_large, there);
    }
    const auto index = hn::Iota(du, static_cast<std::uint32_t>(i));
    tests += hn::CompressStore(index, hn::RebindMask(du, tested), du, cells.tests.data() + tests);
    large += hn::CompressStore(index, hn::RebindMask(du, is_large), du, cells.large.data() + large);
  }
  cells.large_count = large;
  cells.test_count = tests;
  if (tests == 0) return;
  for (std::size_t l = 0; l < lanes; ++l) cells.tests[tests + l] = cells.tests[tests - 1];
  for (std::size_t i = 0; i < tests; i += lanes) {
    const auto index = hn::BitCast(di, hn::LoadU(du, cells.tests.data() + i));
    VF corner[3][3], origin[3];
    for (std::size_t a = 0; a < 3; ++a) {
      const AxisQuantiser& quantiser = grid.quantiser(a);
      for (std::size_t c = 0; c < 3; ++c) {
        const auto v = hn::GatherIndex(d, triangles.coordinate[3 * c + a].data(), index);
        corner[c][a] =
            hn::Mul(hn::Mul(hn::Sub(v, hn::Set(d, quantiser.lo)), hn::Set(d, quantiser.scale)),
                    hn::Set(d, grid.to_cells(a)));
      }
      origin[a] = hn::ConvertTo(d, hn::GatherIndex(di, cells.lo[a].data(), index));
    }
    HWY_ALIGN std::int32_t mask[hn::MaxLanes(I())];
    hn::Store(OverlapMask(corner, origin), di, mask);
    for (std::size_t l = 0; l < lanes && i + l < tests; ++l) {
      std::uint8_t& m = cells.mask[cells.tests[i + l]];
      m = static_cast<std::uint8_t>(m & mask[l]);
    }
  }
}

// Without a branch on how many cells a triangle is in: as many entries as a mask can have are
// written, and those behind the last one are overwritten by the next triangle.
void AppendMasked(std::uint32_t first, std::uint32_t end, const LocalGrid& grid,
                  const LayerCells& cells, LayerEntries& entries) {
#if HWY_TARGET == HWY_SCALAR
  append_masked(first, end, grid, cells, Simd::scalar, entries);
#else
  const hn::FixedTag<std::uint16_t, 8> d;
  const hn::FixedTag<std::uint32_t, 4> d32;
  std::uint16_t* code = entries.code.data() + entries.count;
  std::uint32_t* triangle = entries.triangle.data() + entries.count;
  for (std::uint32_t i = first; i < end; ++i) {
    const auto bits = [&](std::size_t a) {
      return hn::LoadU(d, grid.corners(a, static_cast<std::uint32_t>(cells.lo[a][i])).data());
    };
    const auto codes = hn::Or(hn::Or(bits(0), bits(1)), bits(2));
    const auto mask = hn::LoadMaskBits(d, &cells.mask[i]);
    hn::StoreU(hn::Compress(codes, mask), d, code);
    hn::StoreU(hn::Set(d32, i), d32, triangle);
    hn::StoreU(hn::Set(d32, i), d32, triangle + 4);
    const int count = std::popcount(cells.mask[i]);
    code += count;
    triangle += count;
  }
  entries.count = static_cast<std::size_t>(code - entries.code.data());
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace fasttree::build
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fasttree::build {

HWY_EXPORT(MaskLayer);
HWY_EXPORT(AppendMasked);

namespace {

std::uint8_t tested_mask(const LayerTriangles& triangles, const LocalGrid& grid,
                         const LayerCells& cells, std::size_t i) {
  std::array<std::array<float, 3>, 3> corner;
  Cell origin;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t c = 0; c < 3; ++c) {
      corner[c][a] = in_cells(grid, a, triangles.coordinate[3 * c + a][i]);
    }
    origin[a] = static_cast<std::uint32_t>(cells.lo[a][i]);
  }
  const CellOverlap overlap(corner, origin);
  unsigned mask = 0;
  for (unsigned cell = 0; cell < 8; ++cell) {
    if (overlap.at(static_cast<float>(cell & 1), static_cast<float>(cell >> 1 & 1),
                   static_cast<float>(cell >> 2))) {
      mask |= 1u << cell;
    }
  }
  return static_cast<std::uint8_t>(mask);
}

}  // namespace

void mask_layer(const LayerTriangles& triangles, const LocalGrid& grid, Simd simd,
                LayerCells& cells) {
  if (simd == Simd::widest) {
    HWY_DYNAMIC_DISPATCH(MaskLayer)(triangles, grid, cells);
    return;
  }
  cells.test_count = cells.large_count = 0;
  for (std::size_t i = 0; i < triangles.size; ++i) {
    const std::int32_t x = cells.hi[0][i] - cells.lo[0][i];
    const std::int32_t y = cells.hi[1][i] - cells.lo[1][i];
    const std::int32_t z = cells.hi[2][i] - cells.lo[2][i];
    unsigned mask = 0;
    if (std::max({x, y, z}) <= 1) {
      mask = x == 1 ? 3 : 1;
      if (y == 1) mask |= mask << 2;
      if (z == 1) mask |= mask << 4;
      if (x + y + z > 1) mask &= tested_mask(triangles, grid, cells, i);
    } else {
      cells.large[cells.large_count++] = static_cast<std::uint32_t>(i);
    }
    cells.mask[i] = static_cast<std::uint8_t>(mask);
  }
}

void append_masked(std::uint32_t first, std::uint32_t end, const LocalGrid& grid,
                   const LayerCells& cells, Simd simd, LayerEntries& entries) {
  if (simd == Simd::widest) {
    HWY_DYNAMIC_DISPATCH(AppendMasked)(first, end, grid, cells, entries);
    return;
  }
  for (std::uint32_t i = first; i < end; ++i) {
    for (unsigned mask = cells.mask[i]; mask != 0; mask &= mask - 1) {
      const auto cell = static_cast<std::size_t>(std::countr_zero(mask));
      unsigned code = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        code |= grid.corners(a, static_cast<std::uint32_t>(cells.lo[a][i]))[cell];
      }
      entries.code[entries.count] = static_cast<std::uint16_t>(code);
      entries.triangle[entries.count++] = i;
    }
  }
}

}  // namespace fasttree::build
#endif  // HWY_ONCE
