// SPDX-License-Identifier: Apache-2.0
// One bucket: its records are expanded into references once, in memory that stays in the cache, and
// those are counted and placed by simple loops. Nothing branches on the shape of a box of at most
// two cells an axis, which nearly all are.
// Compiled once for every instruction set, as vertex_codes.cpp is.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "build/buckets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "build/bucket_sort.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as Highway asks.
#include <hwy/highway.h>

#ifndef FASTTREE_BUILD_BUCKET_SORT_ONCE_
#define FASTTREE_BUILD_BUCKET_SORT_ONCE_
namespace fasttree::build {

/// References of this many cells are expanded at a time, and a record more; vectors may write
/// behind them.
inline constexpr std::size_t kBlock = 49152;
inline constexpr std::size_t kBlockRoom =
    kBlock + (std::size_t{1} << BucketGrid::kMostCellBits) + 64;

/// Which of the bits in which a small box' corners differ are set in each of its cells, by shape.
/// The entries behind a shape's last cell mean nothing.
struct SmallShapes {
  alignas(16) std::array<std::array<std::uint16_t, 8>, 8> bits{};
  std::array<std::uint8_t, 8> cells{};

  explicit SmallShapes(const CodeAxes& axes) {
    for (std::uint32_t shape = 0; shape < 8; ++shape) {
      cells[shape] = static_cast<std::uint8_t>(1 << std::popcount(shape));
      for (std::uint32_t cell = 0; cell < cells[shape]; ++cell) {
        const std::uint32_t upper =
            BitSpread(shape).spread(cell);  // axes where it is the upper one
        for (std::size_t a = 0; a < 3; ++a) {
          if (upper >> a & 1) bits[shape][cell] |= static_cast<std::uint16_t>(axes.axis[a].mask());
        }
      }
    }
  }
};

/// A bucket's records on their way to being references.
struct Expansion {
  const BucketGrid& grid;
  const SmallShapes& shapes;
  const BucketGrid::Record* next;
  const BucketGrid::Record* end;
  std::uint16_t* codes;
  std::uint32_t* ids;
};

}  // namespace fasttree::build
#endif

HWY_BEFORE_NAMESPACE();
namespace fasttree::build {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D16 = hn::CappedTag<std::uint16_t, 8>;
using D32 = hn::CappedTag<std::uint32_t, 8>;

// Any box: one cell, then for each axis all that is there once more for every further step.
HWY_NOINLINE std::size_t ExpandLarge(std::uint32_t box, const CodeAxes& axes,
                                     std::uint16_t* HWY_RESTRICT codes) {
  const D16 d;
  const std::uint32_t lo = box & BucketGrid::kCornerMask;
  const std::uint32_t hi = box >> BucketGrid::kMostCellBits & BucketGrid::kCornerMask;
  codes[0] = static_cast<std::uint16_t>(lo);
  std::size_t n = 1;
  for (const BitSpread& axis : axes.axis) {
    const std::size_t block = n;
    const std::uint32_t first = lo & axis.mask(), last = hi & axis.mask();
    for (std::uint32_t c = first; c != last;) {
      c = axis.next(c);
      const auto change = hn::Set(d, static_cast<std::uint16_t>(first ^ c));
      for (std::size_t i = 0; i < block; i += hn::Lanes(d)) {
        hn::StoreU(hn::Xor(hn::LoadU(d, codes + i), change), d, codes + n + i);
      }
      n += block;
    }
  }
  return n;
}

// Expands records until there are none left or a block is full. Returns the number of references.
std::size_t Expand(Expansion& e) {
  const D16 d16;
  const D32 d32;
  std::uint16_t* const codes = e.codes;
  std::uint32_t* const ids = e.ids;
  const SmallShapes& shapes = e.shapes;
  const BucketGrid::Record* next = e.next;
  std::size_t n = 0;
  for (; next != e.end && n < kBlock; ++next) {
    const std::uint32_t box = BucketGrid::box_of(*next);
    const std::uint32_t shape = box >> BucketGrid::kShapeAt;
    const auto id = hn::Set(d32, BucketGrid::id_of(*next));
    if (HWY_UNLIKELY(shape >= BucketGrid::kLarge)) {
      const std::size_t cells = ExpandLarge(box, e.grid.axes(), codes + n);
      for (std::size_t i = 0; i < cells; i += hn::Lanes(d32)) hn::StoreU(id, d32, ids + n + i);
      n += cells;
      continue;
    }
    const std::uint32_t lo = box & BucketGrid::kCornerMask;
    const std::uint32_t differ = lo ^ (box >> BucketGrid::kMostCellBits & BucketGrid::kCornerMask);
    const auto lo16 = hn::Set(d16, static_cast<std::uint16_t>(lo));
    const auto differ16 = hn::Set(d16, static_cast<std::uint16_t>(differ));
    for (std::size_t i = 0; i < 8; i += hn::Lanes(d16)) {
      const auto bits = hn::LoadU(d16, shapes.bits[shape].data() + i);
      hn::StoreU(hn::Xor(lo16, hn::And(differ16, bits)), d16, codes + n + i);
    }
    for (std::size_t i = 0; i < 8; i += hn::Lanes(d32)) hn::StoreU(id, d32, ids + n + i);
    n += shapes.cells[shape];
  }
  e.next = next;
  return n;
}

// Each counter that is not zero is a leaf, and becomes the place of its next reference. Returns the
// number of leaves.
std::uint32_t CountsToLeaves(std::uint32_t* counts, std::size_t cells, std::uint32_t bucket_code,
                             std::uint32_t place, LeafStart* leaves) {
  const hn::CappedTag<std::uint32_t, 16> d;
  std::uint32_t leaf = 0;
  for (std::size_t at = 0; at < cells; at += hn::Lanes(d)) {
    const auto used = hn::Ne(hn::LoadU(d, counts + at), hn::Zero(d));
    if (hn::AllFalse(d, used)) continue;
    std::array<std::uint8_t, 8> bytes{};
    hn::StoreMaskBits(d, used, bytes.data());
    for (unsigned bits = bytes[0] | unsigned{bytes[1]} << 8; bits != 0; bits &= bits - 1) {
      const std::size_t cell = at + static_cast<std::size_t>(std::countr_zero(bits));
      leaves[leaf++] = {bucket_code | static_cast<std::uint32_t>(cell), place};
      place += std::exchange(counts[cell], place);
    }
  }
  return leaf;
}

}  // namespace HWY_NAMESPACE
}  // namespace fasttree::build
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fasttree::build {

HWY_EXPORT(Expand);
HWY_EXPORT(CountsToLeaves);

namespace {

// Counters are read by whole vectors.
std::size_t counters_of(const BucketGrid& grid) {
  return std::max(std::size_t{16}, std::size_t{1} << grid.cell_bits());
}

std::size_t expand_one_by_one(Expansion& e) {
  std::size_t n = 0;
  for (; e.next != e.end && n < kBlock; ++e.next) {
    const std::uint32_t box = BucketGrid::box_of(*e.next);
    const std::uint32_t lo = box & BucketGrid::kCornerMask;
    const std::uint32_t hi = box >> BucketGrid::kMostCellBits & BucketGrid::kCornerMask;
    const auto along = [&](std::size_t a, const auto& each) {
      const BitSpread& axis = e.grid.axes().axis[a];
      std::uint32_t c = lo & axis.mask();
      for (; c != (hi & axis.mask()); c = axis.next(c)) each(c);
      each(c);
    };
    along(2, [&](std::uint32_t z) {
      along(1, [&](std::uint32_t y) {
        along(0, [&](std::uint32_t x) {
          e.codes[n] = static_cast<std::uint16_t>(x | y | z);
          e.ids[n++] = BucketGrid::id_of(*e.next);
        });
      });
    });
  }
  return n;
}

// The two loops over every reference.
void count_cells(const Expansion& e, std::size_t size, std::uint32_t* counts) {
  const std::uint16_t* const codes = e.codes;
  for (std::size_t i = 0; i < size; ++i) ++counts[codes[i]];
}

void place_ids(const Expansion& e, std::size_t size, std::uint32_t* places, std::uint32_t* ids) {
  const std::uint16_t* const codes = e.codes;
  const std::uint32_t* const from = e.ids;
  for (std::size_t i = 0; i < size; ++i) ids[places[codes[i]]++] = from[i];
}

std::uint32_t counts_to_leaves(std::uint32_t* counts, std::size_t cells, std::uint32_t bucket_code,
                               std::uint32_t place, LeafStart* leaves) {
  std::uint32_t leaf = 0;
  for (std::uint32_t cell = 0; cell < cells; ++cell) {
    if (counts[cell] == 0) continue;
    leaves[leaf++] = {bucket_code | cell, place};
    place += std::exchange(counts[cell], place);
  }
  return leaf;
}

}  // namespace

std::uint64_t scratch_bytes(const BucketGrid& grid) {
  const auto threads = static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency());
  return threads * (kBlockRoom * (sizeof(std::uint16_t) + sizeof(std::uint32_t)) +
                    counters_of(grid) * sizeof(std::uint32_t));
}

void sort_buckets(const BucketGrid& grid, Simd simd, Buckets& buckets,
                  std::span<std::uint32_t> ids) {
  const bool vectors = simd == Simd::widest;
  const SmallShapes shapes(grid.axes());
  const std::size_t cells = counters_of(grid);
  buckets.leaf_count.resize(grid.bucket_count());
  buckets.leaves.resize(buckets.leaf_begin.back());
  tbb::parallel_for(std::size_t{0}, grid.bucket_count(), [&](std::size_t b) {
    buckets.leaf_count[b] = 0;
    const BucketGrid::Record* const first = buckets.records.data() + buckets.record_begin[b];
    const BucketGrid::Record* const end = buckets.records.data() + buckets.record_begin[b + 1];
    if (first == end) return;
    BucketScratch& scratch = buckets.scratch.local();
    scratch.codes.resize(kBlockRoom);
    scratch.ids.resize(kBlockRoom);
    scratch.counts.resize(std::max(cells, scratch.counts.size()));
    std::uint32_t* const counts = scratch.counts.data();
    std::fill_n(counts, cells, 0u);

    Expansion e{grid, shapes, first, end, scratch.codes.data(), scratch.ids.data()};
    const auto expand = [&] {
      return vectors ? HWY_DYNAMIC_DISPATCH(Expand)(e) : expand_one_by_one(e);
    };
    std::size_t size = 0;
    while (e.next != end) {
      size = expand();
      count_cells(e, size, counts);
    }
    const bool one_block = size == buckets.reference_begin[b + 1] - buckets.reference_begin[b];

    const auto bucket_code = static_cast<std::uint32_t>(b << grid.cell_bits());
    const auto place = static_cast<std::uint32_t>(buckets.reference_begin[b]);
    LeafStart* const leaves = buckets.leaves.data() + buckets.leaf_begin[b];
    buckets.leaf_count[b] =
        vectors ? HWY_DYNAMIC_DISPATCH(CountsToLeaves)(counts, cells, bucket_code, place, leaves)
                : counts_to_leaves(counts, cells, bucket_code, place, leaves);

    if (one_block) {
      place_ids(e, size, counts, ids.data());  // what was counted last is still there
      return;
    }
    for (e.next = first; e.next != end;) place_ids(e, expand(), counts, ids.data());
  });
}

}  // namespace fasttree::build
#endif  // HWY_ONCE
