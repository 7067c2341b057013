// SPDX-License-Identifier: Apache-2.0
#include "build/buckets.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <utility>

namespace fasttree::build {
namespace {

// Counters of one bucket's cells should stay in the first-level cache, and buckets should be few
// enough for the partition's streams; a record holds two corners of this many bits in 32.
constexpr int kCellBits = 12;
constexpr int kMostBucketBits = 12;
constexpr int kMostCellBits = 16;

// Triangles one task counts and partitions in order: few chunks, since each has all counters.
constexpr std::size_t kMostChunks = 64;
constexpr std::size_t kLeastChunk = 8192;

std::size_t chunk_size(std::size_t triangles) {
  return std::max(kLeastChunk, (triangles + kMostChunks - 1) / kMostChunks);
}

}  // namespace

int BucketGrid::bucket_bits_of(int depth) {
  const int cells = std::clamp(depth - kMostBucketBits, std::min(depth, kCellBits), kMostCellBits);
  return depth - cells;
}

BucketGrid::BucketGrid(const Grid& grid)
    : bucket_bits_(bucket_bits_of(grid.depth())), cell_bits_(grid.depth() - bucket_bits_) {
  for (int level = bucket_bits_; level < grid.depth(); ++level) {
    ++axes_[static_cast<std::size_t>(grid.axis_of_level(level))].local_bits;
  }
  int at = 32;
  for (std::size_t a = 0; a < 3; ++a) {
    Axis& axis = axes_[a];
    axis.to_depth = kMaxAxisBits - grid.bits()[a];
    axis.lo_at = at;
    axis.hi_at = at + axis.local_bits;
    at = axis.hi_at + axis.local_bits;
    axis.mask = (1u << axis.local_bits) - 1;
    const auto code = [&](std::uint32_t coordinate) {
      Cell cell{};
      cell[a] = coordinate;
      return grid.morton_code(cell);
    };
    axis.bucket_code.resize(std::size_t{1} << (grid.bits()[a] - axis.local_bits));
    for (std::uint32_t c = 0; c < axis.bucket_code.size(); ++c) {
      axis.bucket_code[c] = code(c << axis.local_bits) >> cell_bits_;
    }
    axis.cell_code.resize(std::size_t{1} << axis.local_bits);
    for (std::uint32_t c = 0; c < axis.cell_code.size(); ++c) axis.cell_code[c] = code(c);
  }
}

template <typename Work>
void BucketGrid::for_each_record(const TriangleBox& box, std::uint32_t id, const Work& work) const {
  std::array<std::uint32_t, 3> lo, hi, first, last;
  for (std::size_t a = 0; a < 3; ++a) {
    lo[a] = static_cast<std::uint32_t>(box.lo[a] >> axes_[a].to_depth);
    hi[a] = static_cast<std::uint32_t>(box.hi[a] >> axes_[a].to_depth);
    first[a] = lo[a] >> axes_[a].local_bits;
    last[a] = hi[a] >> axes_[a].local_bits;
  }
  // The part of the range on one axis inside bucket coordinate c: bits of the record, and length.
  const auto clip = [&](std::size_t a, std::uint32_t c, std::uint64_t& bits) {
    const Axis& axis = axes_[a];
    const std::uint32_t from = c == first[a] ? lo[a] & axis.mask : 0;
    const std::uint32_t to = c == last[a] ? hi[a] & axis.mask : axis.mask;
    bits |= std::uint64_t{from} << axis.lo_at % 64 | std::uint64_t{to} << axis.hi_at % 64;
    return to - from + 1;
  };
  for (std::uint32_t z = first[2]; z <= last[2]; ++z) {
    std::uint64_t z_bits = id;
    const std::uint32_t z_cells = clip(2, z, z_bits);
    for (std::uint32_t y = first[1]; y <= last[1]; ++y) {
      std::uint64_t y_bits = z_bits;
      const std::uint32_t y_cells = z_cells * clip(1, y, y_bits);
      for (std::uint32_t x = first[0]; x <= last[0]; ++x) {
        Record record = y_bits;
        const std::uint32_t cells = y_cells * clip(0, x, record);
        work(axes_[0].bucket_code[x] | axes_[1].bucket_code[y] | axes_[2].bucket_code[z], record,
             cells);
      }
    }
  }
}

template <typename Work>
void BucketGrid::for_each_cell(Record record, const Work& work) const {
  std::array<std::uint32_t, 3> lo, hi;
  for (std::size_t a = 0; a < 3; ++a) {
    lo[a] = static_cast<std::uint32_t>(record >> axes_[a].lo_at % 64) & axes_[a].mask;
    hi[a] = static_cast<std::uint32_t>(record >> axes_[a].hi_at % 64) & axes_[a].mask;
  }
  for (std::uint32_t z = lo[2]; z <= hi[2]; ++z) {
    for (std::uint32_t y = lo[1]; y <= hi[1]; ++y) {
      const std::uint32_t zy = axes_[2].cell_code[z] | axes_[1].cell_code[y];
      for (std::uint32_t x = lo[0]; x <= hi[0]; ++x) work(zy | axes_[0].cell_code[x]);
    }
  }
}

void partition(std::span<const TriangleBox> boxes, const BucketGrid& grid,
               std::uint64_t record_count, Buckets& buckets) {
  const std::size_t count = grid.bucket_count();
  const std::size_t size = chunk_size(boxes.size());
  const std::size_t chunks = (boxes.size() + size - 1) / size;
  buckets.chunk_records.resize(chunks * count);
  buckets.chunk_references.resize(chunks * count);
  buckets.record_begin.resize(count + 1);
  buckets.reference_begin.resize(count + 1);
  buckets.leaf_begin.resize(count + 1);
  buckets.leaf_count.assign(count, 0);
  buckets.records.resize(record_count);

  const auto for_each_record = [&](std::size_t chunk, auto&& work) {
    const std::size_t end = std::min(boxes.size(), (chunk + 1) * size);
    for (std::size_t t = chunk * size; t < end; ++t) {
      grid.for_each_record(boxes[t], static_cast<std::uint32_t>(t), work);
    }
  };
  tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
    std::uint32_t* const records = &buckets.chunk_records[chunk * count];
    std::uint32_t* const references = &buckets.chunk_references[chunk * count];
    std::fill_n(records, count, 0u);
    std::fill_n(references, count, 0u);
    for_each_record(chunk, [&](std::uint32_t b, BucketGrid::Record, std::uint32_t cells) {
      ++records[b];
      references[b] += cells;
    });
  });

  // Bucket by bucket, chunk by chunk: where each chunk's records of a bucket begin.
  std::uint64_t record = 0, reference = 0, leaf = 0;
  for (std::size_t b = 0; b < count; ++b) {
    buckets.record_begin[b] = record;
    buckets.reference_begin[b] = reference;
    buckets.leaf_begin[b] = leaf;
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
      record += std::exchange(buckets.chunk_records[chunk * count + b],
                              static_cast<std::uint32_t>(record));
      reference += buckets.chunk_references[chunk * count + b];
    }
    leaf += std::min(reference - buckets.reference_begin[b], std::uint64_t{1} << grid.cell_bits());
  }
  buckets.record_begin[count] = record;
  buckets.reference_begin[count] = reference;
  buckets.leaf_begin[count] = leaf;
  buckets.leaves.resize(leaf);

  tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
    std::uint32_t* const place = &buckets.chunk_records[chunk * count];
    for_each_record(chunk, [&](std::uint32_t b, BucketGrid::Record r, std::uint32_t) {
      buckets.records[place[b]++] = r;
    });
  });
}

void sort_buckets(const BucketGrid& grid, Buckets& buckets, std::span<std::uint32_t> ids) {
  const std::size_t cells = std::size_t{1} << grid.cell_bits();
  tbb::parallel_for(std::size_t{0}, grid.bucket_count(), [&](std::size_t b) {
    const std::span records(buckets.records.data() + buckets.record_begin[b],
                            buckets.records.data() + buckets.record_begin[b + 1]);
    if (records.empty()) return;
    Buckets::CellCounters& counters = buckets.counters.local();
    if (counters.count.size() < cells) {
      // In this order: where memory for the second fails, the next build asks for both again.
      counters.occupied.resize((cells + 63) / 64, 0);
      counters.count.resize(cells, 0);
    }
    std::uint32_t* const count = counters.count.data();
    std::uint64_t* const occupied = counters.occupied.data();

    for (const BucketGrid::Record record : records) {
      grid.for_each_cell(record, [&](std::uint32_t code) {
        ++count[code];
        occupied[code / 64] |= std::uint64_t{1} << code % 64;
      });
    }

    // Each counter that is not zero is a leaf, and becomes the place of its next reference.
    const std::uint32_t bucket_code = static_cast<std::uint32_t>(b << grid.cell_bits());
    LeafStart* const leaves = buckets.leaves.data() + buckets.leaf_begin[b];
    auto place = static_cast<std::uint32_t>(buckets.reference_begin[b]);
    std::uint32_t leaf = 0;
    for (std::size_t word = 0; word < (cells + 63) / 64; ++word) {
      for (std::uint64_t bits = std::exchange(occupied[word], 0); bits != 0; bits &= bits - 1) {
        const auto code = static_cast<std::uint32_t>(
            64 * word + static_cast<std::size_t>(std::countr_zero(bits)));
        leaves[leaf++] = {bucket_code | code, place};
        place += std::exchange(count[code], place);
      }
    }
    buckets.leaf_count[b] = leaf;

    for (const BucketGrid::Record record : records) {
      const std::uint32_t id = BucketGrid::id_of(record);
      grid.for_each_cell(record, [&](std::uint32_t code) { ids[count[code]++] = id; });
    }
    for (std::uint32_t l = 0; l < leaf; ++l) count[leaves[l].code & (cells - 1)] = 0;
  });
}

}  // namespace fasttree::build
