// SPDX-License-Identifier: Apache-2.0
// BitSpread and CodeAxes for vectors of codes. Included once for every instruction set.
#if defined(FASTTREE_BUILD_BIT_SPREAD_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FASTTREE_BUILD_BIT_SPREAD_INL_H_
#undef FASTTREE_BUILD_BIT_SPREAD_INL_H_
#else
#define FASTTREE_BUILD_BIT_SPREAD_INL_H_
#endif

#include <hwy/highway.h>

#include "build/bit_spread.h"

HWY_BEFORE_NAMESPACE();
namespace fasttree::build {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <int kStep, class D, class V>
HWY_INLINE V SpreadStep(D d, V x, const BitSpread& bits) {
  const auto move = hn::Set(d, bits.move(kStep));
  return hn::Or(hn::AndNot(move, x), hn::And(hn::ShiftLeft<(1 << kStep)>(x), move));
}

template <class D, class V>
HWY_INLINE V Spread(D d, V x, const BitSpread& bits) {
  x = SpreadStep<4>(d, x, bits);
  x = SpreadStep<3>(d, x, bits);
  x = SpreadStep<2>(d, x, bits);
  x = SpreadStep<1>(d, x, bits);
  x = SpreadStep<0>(d, x, bits);
  return hn::And(x, hn::Set(d, bits.mask()));
}

template <int kStep, class D, class V>
HWY_INLINE V GatherStep(D d, V x, const BitSpread& bits) {
  const auto moved = hn::And(x, hn::Set(d, bits.move(kStep)));
  return hn::Or(hn::Xor(x, moved), hn::ShiftRight<(1 << kStep)>(moved));
}

template <class D, class V>
HWY_INLINE V Gather(D d, V x, const BitSpread& bits) {
  x = GatherStep<0>(d, x, bits);
  x = GatherStep<1>(d, x, bits);
  x = GatherStep<2>(d, x, bits);
  x = GatherStep<3>(d, x, bits);
  return GatherStep<4>(d, x, bits);
}

template <class D, class V>
HWY_INLINE V Difference(D d, V lo, V hi, const BitSpread& bits) {
  const auto mask = hn::Set(d, bits.mask());
  return hn::And(hn::Sub(hn::And(hi, mask), hn::And(lo, mask)), mask);
}

// CodeAxes::cells
template <class D, class V>
HWY_INLINE V Cells(D d, V lo, V hi, const CodeAxes& axes) {
  const auto one = hn::Set(d, 1u);
  const auto along = [&](const BitSpread& bits) {
    return hn::Add(Gather(d, Difference(d, lo, hi, bits), bits), one);
  };
  return hn::Mul(hn::Mul(along(axes.axis[0]), along(axes.axis[1])), along(axes.axis[2]));
}

#if HWY_TARGET != HWY_SCALAR  // which has no wider lanes
// The sum of all lanes in 64 bits, added up lane pair by lane pair.
template <class V64, class V32>
HWY_INLINE V64 AddWide(V64 sum, V32 v) {
  const hn::DFromV<V64> d64;
  const auto pairs = hn::BitCast(d64, v);
  return hn::Add(sum,
                 hn::Add(hn::And(pairs, hn::Set(d64, 0xffffffffu)), hn::ShiftRight<32>(pairs)));
}
#endif

}  // namespace HWY_NAMESPACE
}  // namespace fasttree::build
HWY_AFTER_NAMESPACE();

#endif  // include guard
