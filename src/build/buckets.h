// SPDX-License-Identifier: Apache-2.0
// Steps 2 to 4, fast: duplication deferred. The upper bits of a Morton code name a bucket. One
// record a triangle and bucket is partitioned; the cells inside the bucket are stepped through only
// when its references fit the cache, once to count them and once to place them. The counters that
// are not zero are the leaves.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "build/triangle_boxes.h"
#include "grid/grid.h"

namespace fasttree::build {

/// How the bits of a Morton code are shared between buckets and the cells inside one.
class BucketGrid {
 public:
  explicit BucketGrid(const Grid& grid);

  int bucket_bits() const { return bucket_bits_; }
  int cell_bits() const { return cell_bits_; }
  std::size_t bucket_count() const { return std::size_t{1} << bucket_bits_; }

  /// Bits of a bucket's number for a depth: M(this) is the number of records.
  static int bucket_bits_of(int depth);

  /// A triangle's part in one bucket: its id, and the corners of its box inside the bucket.
  using Record = std::uint64_t;

  /// Calls work(bucket, record, number of cells) for each bucket the box reaches.
  template <typename Work>
  void for_each_record(const TriangleBox& box, std::uint32_t id, const Work& work) const;

  /// Calls work(code inside the bucket) for each cell of a record, x fastest, then y, then z.
  template <typename Work>
  void for_each_cell(Record record, const Work& work) const;

  static std::uint32_t id_of(Record record) { return static_cast<std::uint32_t>(record); }

 private:
  struct Axis {
    int to_depth = 0;    // shift from the finest grid
    int local_bits = 0;  // of the coordinate inside a bucket
    int lo_at = 0;       // where a record holds the corners
    int hi_at = 0;
    std::uint32_t mask = 0;
    std::vector<std::uint32_t> bucket_code;  // bucket coordinate to its bits of the bucket
    std::vector<std::uint32_t> cell_code;    // coordinate inside a bucket to its bits of the code
  };
  int bucket_bits_;
  int cell_bits_;
  std::array<Axis, 3> axes_;
};

/// A leaf before its bucket's place among the leaves is known.
struct LeafStart {
  std::uint32_t code = 0;   ///< whole Morton code
  std::uint32_t first = 0;  ///< base index into the sorted references
};

/// What the partition and the sort of the buckets leave behind, and memory for the next time. The
/// arrays by bucket have one element more than there are buckets: where the last one ends.
struct Buckets {
  std::vector<BucketGrid::Record> records;
  std::vector<std::uint64_t> record_begin;
  std::vector<std::uint64_t> reference_begin;
  std::vector<std::uint64_t> leaf_begin;  ///< into `leaves`: room for as many as there can be
  std::vector<std::uint32_t> leaf_count;
  std::vector<LeafStart> leaves;

  /// Counters of records and references by chunk of triangles and bucket.
  std::vector<std::uint32_t> chunk_records;
  std::vector<std::uint32_t> chunk_references;

  /// One a thread; zero between uses.
  struct CellCounters {
    std::vector<std::uint32_t> count;
    std::vector<std::uint64_t> occupied;
  };
  tbb::enumerable_thread_specific<CellCounters> counters;
};

/// Partitions one record a triangle and bucket, in parallel, stable: records of a bucket lie in
/// order of triangle ids. `record_count` is M(bucket_bits).
void partition(std::span<const TriangleBox> boxes, const BucketGrid& grid,
               std::uint64_t record_count, Buckets& buckets);

/// Expands and sorts each bucket, in parallel: writes all ids in order of code, and the leaves.
void sort_buckets(const BucketGrid& grid, Buckets& buckets, std::span<std::uint32_t> ids);

}  // namespace fasttree::build
