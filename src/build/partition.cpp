// SPDX-License-Identifier: Apache-2.0
// One record a triangle and bucket into the buckets. Nearly all triangles lie in one bucket, and
// mostly in the one of the triangles beside them: that is what the vector forms are fast at.
// Compiled once for every instruction set, as vertex_codes.cpp is.
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <utility>

#include "build/buckets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "build/partition.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as Highway asks.
#include <hwy/highway.h>

#include "build/bit_spread-inl.h"

#ifndef FASTTREE_BUILD_PARTITION_ONCE_
#define FASTTREE_BUILD_PARTITION_ONCE_
namespace fasttree::build {

/// Both counters of a chunk and bucket in one number: records above, references below.
inline constexpr std::uint64_t kOneRecord = std::uint64_t{1} << 32;

inline void count_one(CodeBox box, const BucketGrid& grid, std::uint64_t* counts) {
  grid.for_each_part(box, [&](std::uint32_t bucket, std::uint32_t lo, std::uint32_t hi) {
    counts[bucket] += kOneRecord + grid.axes().cells(lo, hi);
  });
}

inline void place_one(CodeBox box, std::uint32_t id, const BucketGrid& grid, std::uint64_t* places,
                      BucketGrid::Record* records) {
  grid.for_each_part(box, [&](std::uint32_t bucket, std::uint32_t lo, std::uint32_t hi) {
    records[places[bucket]++] = BucketGrid::record(grid.pack(lo, hi), id);
  });
}

}  // namespace fasttree::build
#endif

HWY_BEFORE_NAMESPACE();
namespace fasttree::build {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D32 = hn::ScalableTag<std::uint32_t>;

// A vector of boxes at the tree's depth, and their buckets.
struct Boxes {
  hn::Vec<D32> lo, hi, bucket;
  hn::Mask<D32> in_one_bucket;
  bool in_same_bucket;  // all of them

  Boxes(D32 d, const CodeBox* boxes, const BucketGrid& grid) {
    hn::LoadInterleaved2(d, &boxes->lo, lo, hi);
    lo = hn::ShiftRightSame(lo, grid.box_shift());
    hi = hn::ShiftRightSame(hi, grid.box_shift());
    bucket = hn::ShiftRightSame(lo, grid.cell_bits());
    in_one_bucket = hn::Eq(bucket, hn::ShiftRightSame(hi, grid.cell_bits()));
    const auto first = hn::Set(d, hn::GetLane(bucket));
    in_same_bucket = hn::AllTrue(d, hn::And(in_one_bucket, hn::Eq(bucket, first)));
  }
};

std::size_t CountVectors(const CodeBox* boxes, std::size_t count, const BucketGrid& given,
                         std::uint64_t* counts) {
  const D32 d;
  const std::size_t lanes = hn::Lanes(d);
  const BucketGrid grid = given;  // a copy: what `counts` points to is not it
  HWY_ALIGN std::uint32_t bucket[hn::MaxLanes(d)];
  HWY_ALIGN std::uint32_t cells[hn::MaxLanes(d)];
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const Boxes b(d, boxes + i, grid);
    const auto n = Cells(d, b.lo, b.hi, grid.axes());
    if (b.in_same_bucket) {
      counts[hn::GetLane(b.bucket)] += lanes * kOneRecord + hn::GetLane(hn::SumOfLanes(d, n));
      continue;
    }
    hn::Store(b.bucket, d, bucket);
    hn::Store(hn::IfThenElseZero(b.in_one_bucket, n), d, cells);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      if (cells[lane] != 0) {
        counts[bucket[lane]] += kOneRecord + cells[lane];
      } else {
        count_one(boxes[i + lane], given, counts);
      }
    }
  }
  return i;
}

// BucketGrid::pack
HWY_INLINE hn::Vec<D32> Pack(D32 d, const Boxes& b, const BucketGrid& grid) {
  auto shape = hn::Zero(d);
  for (std::size_t a = 0; a < 3; ++a) {
    const BitSpread& axis = grid.axes().axis[a];
    const auto span = Difference(d, b.lo, b.hi, axis);
    const auto two = hn::Eq(span, hn::Set(d, axis.lowest()));
    const auto bits =
        hn::IfThenElse(two, hn::Set(d, 1u << a), hn::Set(d, std::uint32_t{BucketGrid::kLarge}));
    shape = hn::Or(shape, hn::IfThenElseZero(hn::Ne(span, hn::Zero(d)), bits));
  }
  const auto inside = hn::Set(d, grid.cell_mask());
  return hn::Or(hn::Or(hn::And(b.lo, inside),
                       hn::ShiftLeft<BucketGrid::kMostCellBits>(hn::And(b.hi, inside))),
                hn::ShiftLeft<BucketGrid::kShapeAt>(shape));
}

std::size_t PlaceVectors(const CodeBox* boxes, std::size_t count, std::uint32_t first_id,
                         const BucketGrid& given, std::uint64_t* places,
                         BucketGrid::Record* records) {
  const D32 d;
  const std::size_t lanes = hn::Lanes(d);
  const BucketGrid grid = given;
  HWY_ALIGN std::uint32_t bucket[hn::MaxLanes(d)];
  HWY_ALIGN std::uint32_t packed[hn::MaxLanes(d)];
  HWY_ALIGN std::uint32_t single[hn::MaxLanes(d)];
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const Boxes b(d, boxes + i, grid);
    const auto box = Pack(d, b, grid);
    const auto id = static_cast<std::uint32_t>(first_id + i);
    if (b.in_same_bucket) {
      std::uint64_t& place = places[hn::GetLane(b.bucket)];
      // Little-endian, as all processors here are: the id is the lower half.
      hn::StoreInterleaved2(hn::Iota(d, id), box, d,
                            reinterpret_cast<std::uint32_t*>(records + place));
      place += lanes;
      continue;
    }
    hn::Store(b.bucket, d, bucket);
    hn::Store(box, d, packed);
    hn::Store(hn::VecFromMask(d, b.in_one_bucket), d, single);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const auto lane_id = static_cast<std::uint32_t>(id + lane);
      if (single[lane] != 0) {
        records[places[bucket[lane]]++] = BucketGrid::record(packed[lane], lane_id);
      } else {
        place_one(boxes[i + lane], lane_id, given, places, records);
      }
    }
  }
  return i;
}

}  // namespace HWY_NAMESPACE
}  // namespace fasttree::build
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fasttree::build {

HWY_EXPORT(CountVectors);
HWY_EXPORT(PlaceVectors);

namespace {

// Triangles one task counts and places in order. Each chunk has a counter a bucket, so there are
// only as many as keep the threads busy, and no more counters than triangles; the result does not
// depend on it.
constexpr std::size_t kLeastChunk = 4096;
constexpr std::size_t kChunksPerThread = 4;

std::size_t choose_chunk_size(std::size_t triangles, std::size_t buckets) {
  const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  const std::size_t chunks = threads == 1 ? 1 : threads * kChunksPerThread;
  return std::max({kLeastChunk, buckets, (triangles + chunks - 1) / chunks});
}

// Calls work(chunk, first triangle, end) in parallel.
template <typename Work>
void for_each_chunk(std::size_t triangles, std::size_t size, const Work& work) {
  tbb::parallel_for(std::size_t{0}, (triangles + size - 1) / size, [&](std::size_t chunk) {
    work(chunk, chunk * size, std::min(triangles, (chunk + 1) * size));
  });
}

}  // namespace

std::uint64_t partition_bytes(std::uint64_t triangles, const BucketGrid& grid) {
  const std::size_t size = choose_chunk_size(triangles, grid.bucket_count());
  // Counters of the chunks, and what else there is by bucket.
  const std::uint64_t chunks = (triangles + size - 1) / size;
  return grid.bucket_count() * (chunks + 4) * sizeof(std::uint64_t);
}

void count_records(std::span<const CodeBox> boxes, const BucketGrid& grid, Simd simd,
                   Buckets& buckets) {
  const std::size_t count = grid.bucket_count();
  buckets.chunk_size = choose_chunk_size(boxes.size(), count);
  const std::size_t chunks = (boxes.size() + buckets.chunk_size - 1) / buckets.chunk_size;
  buckets.chunk_counts.resize(chunks * count);
  buckets.record_begin.resize(count + 1);
  buckets.reference_begin.resize(count + 1);
  buckets.leaf_begin.resize(count + 1);
  for_each_chunk(boxes.size(), buckets.chunk_size,
                 [&](std::size_t chunk, std::size_t t, std::size_t end) {
                   std::uint64_t* const counts = &buckets.chunk_counts[chunk * count];
                   std::fill_n(counts, count, 0);
                   if (simd == Simd::widest) {
                     t += HWY_DYNAMIC_DISPATCH(CountVectors)(&boxes[t], end - t, grid, counts);
                   }
                   for (; t < end; ++t) count_one(boxes[t], grid, counts);
                 });

  // Bucket by bucket, chunk by chunk: where each chunk's records of a bucket begin.
  std::uint64_t record = 0, reference = 0, leaf = 0;
  for (std::size_t b = 0; b < count; ++b) {
    buckets.record_begin[b] = record;
    buckets.reference_begin[b] = reference;
    buckets.leaf_begin[b] = leaf;
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
      const std::uint64_t both = std::exchange(buckets.chunk_counts[chunk * count + b], record);
      record += both / kOneRecord;
      reference += both % kOneRecord;
    }
    leaf += std::min(reference - buckets.reference_begin[b], std::uint64_t{1} << grid.cell_bits());
  }
  buckets.record_begin[count] = record;
  buckets.reference_begin[count] = reference;
  buckets.leaf_begin[count] = leaf;
}

void place_records(std::span<const CodeBox> boxes, const BucketGrid& grid, Simd simd,
                   Buckets& buckets) {
  const std::size_t count = grid.bucket_count();
  buckets.records.resize(buckets.record_begin[count]);
  for_each_chunk(
      boxes.size(), buckets.chunk_size, [&](std::size_t chunk, std::size_t t, std::size_t end) {
        std::uint64_t* const places = &buckets.chunk_counts[chunk * count];
        if (simd == Simd::widest) {
          t += HWY_DYNAMIC_DISPATCH(PlaceVectors)(&boxes[t], end - t, static_cast<std::uint32_t>(t),
                                                  grid, places, buckets.records.data());
        }
        for (; t < end; ++t) {
          place_one(boxes[t], static_cast<std::uint32_t>(t), grid, places, buckets.records.data());
        }
      });
}

}  // namespace fasttree::build
#endif  // HWY_ONCE
