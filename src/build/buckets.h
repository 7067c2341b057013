// SPDX-License-Identifier: Apache-2.0
// Steps 2 to 4, fast: duplication deferred. The upper bits of a Morton code name a bucket. One
// record a triangle and bucket is partitioned; the cells inside the bucket are stepped through only
// when its references fit the cache, once to count them and once to place them. The counters that
// are not zero are the leaves.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <cstdint>
#include <span>

#include "build/bucket_grid.h"
#include "build/buffer.h"
#include "build/triangle_boxes.h"
#include "fasttree/build.h"

namespace fasttree::build {

/// A leaf before its bucket's place among the leaves is known.
struct LeafStart {
  std::uint32_t code;   ///< whole Morton code
  std::uint32_t first;  ///< base index into the sorted references
};

/// References of one bucket written out, and counters of its cells: one a thread.
struct BucketScratch {
  Buffer<std::uint16_t> codes;
  Buffer<std::uint32_t> ids;
  Buffer<std::uint32_t> counts;
};

/// What the partition and the sort of the buckets leave behind, and memory for the next time. The
/// arrays by bucket have one element more than there are buckets: where the last one ends.
struct Buckets {
  Buffer<BucketGrid::Record> records;
  Buffer<std::uint64_t> record_begin;
  Buffer<std::uint64_t> reference_begin;
  Buffer<std::uint64_t> leaf_begin;  ///< into `leaves`: room for as many as there can be
  Buffer<std::uint32_t> leaf_count;
  Buffer<LeafStart> leaves;

  /// By chunk of triangles and bucket: first how many records (upper half) and references (lower)
  /// there are, then where the chunk's next record goes.
  Buffer<std::uint64_t> chunk_counts;
  std::size_t chunk_size = 0;

  tbb::enumerable_thread_specific<BucketScratch> scratch;
};

/// First half of the partition: counts, in parallel. Afterwards record_begin, reference_begin and
/// leaf_begin are known, and thereby what the rest takes.
void count_records(std::span<const CodeBox> boxes, const BucketGrid& grid, Simd simd,
                   Buckets& buckets);

/// Second half: puts one record a triangle and bucket into its bucket's place, in parallel, stable:
/// records of a bucket lie in order of triangle ids.
void place_records(std::span<const CodeBox> boxes, const BucketGrid& grid, Simd simd,
                   Buckets& buckets);

/// Expands and sorts each bucket, in parallel: writes all ids in order of code, and the leaves.
void sort_buckets(const BucketGrid& grid, Simd simd, Buckets& buckets,
                  std::span<std::uint32_t> ids);

/// Bytes of the arrays by bucket and by chunk and bucket, and of all threads' scratch.
std::uint64_t partition_bytes(std::uint64_t triangles, const BucketGrid& grid);
std::uint64_t scratch_bytes(const BucketGrid& grid);

}  // namespace fasttree::build
