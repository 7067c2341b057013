// SPDX-License-Identifier: Apache-2.0
#include "model/fasttree2/area.h"

#include <algorithm>
#include <bit>

#include "grid/axis_schedule.h"
#include "model/fasttree2/bucket_walker.h"

namespace fasttree::model {

namespace {

using U = std::uint32_t;

// ---- What small things cost, in 6-input look-up tables and flip-flops.

constexpr U adder(U bits) {
  return bits;
}  // carry chain, a bit a table
constexpr U comparator(U bits) {
  return (bits + 1) / 2;
}  // carry chain, two bits a table
constexpr U mux(U bits, U ways) {  // a table is a 4-to-1 multiplexer
  return ways <= 1 ? 0 : bits * ((ways - 1 + 2) / 3);
}
constexpr U encoder(U ways) {
  return ways;
}  // priority encoder

// Compare-and-select of binary32. The paper's two SBCUs have eight each: 2485 tables and 1415
// registers for sixteen.
constexpr U kSelectLuts = 2485 / 16;
constexpr U kSelectRegisters = 1415 / 16;

// A quantiser: what is left of one of the paper's four MCGUs (12454 tables and 7561 registers for
// four) without the twelve compare-and-selects of its triangle's box.
constexpr U kBoxSelects = 12;
constexpr U kQuantiserLuts = 12454 / 4 - kBoxSelects * kSelectLuts;
constexpr U kQuantiserRegisters = 7561 / 4 - kBoxSelects * kSelectRegisters;

// ---- Widths of what the machine handles.

constexpr U kAddressBits = 32;
constexpr U kIdBits = 30;
constexpr U kCountBits = 30;
constexpr U kDepth = static_cast<U>(kMaxDepth);
constexpr U kCoordinateBits = static_cast<U>(kMaxAxisBits);
constexpr U kRecordBits = 96;  // id and two corners at their widest, in whole bytes
constexpr U kBeatBits = 256;   // what a channel moves in an access
constexpr U kChannels = 2;

U log2(U n) {
  return static_cast<U>(std::bit_width(std::max(n, 1u)) - 1);
}
U bits_for(std::uint64_t n) {
  return static_cast<U>(std::bit_width(n > 0 ? n - 1 : 0));
}

struct Widths {
  explicit Widths(const FastTree2Config& c)
      : chunk(kAddressBits - log2(c.chunk_bytes)),
        line_in_chunk(log2(c.chunk_bytes / c.combine_bytes)),
        fill(bits_for(c.combine_bytes / 4)),
        chain(chunk + kCountBits),
        task(kDepth + 5 + chain),
        cell(log2(c.lane_cells)),
        record(bits_for(c.lane_records)),
        // A counter is the base of its word and an offset inside it: eight cells of at most all
        // records are the largest offset, all cells of all records the largest base.
        offset(record + 4),
        base(record + cell) {}

  U chunk, line_in_chunk, fill, chain, task, cell, record, offset, base;
};

// Steps a box of cells through coarser cells: on each axis a counter, its end, and the box cut.
AreaBlock box_walk(U coordinate_bits) {
  const U b = coordinate_bits;
  return {"", 3 * (adder(b) + comparator(b) + 2 * (comparator(b) + mux(b, 2)) + 2 * mux(b, 4)),
          3 * 4 * b, 0};
}
// A Morton code from coordinates under any schedule: each bit is one of the coordinates' bits.
U morton_luts(U code_bits, U coordinate_bits) {
  return mux(code_bits, 3 * coordinate_bits);
}

// A record's fields out of, or into, its bytes: shifts by variable widths, four ways a stage.
constexpr U kFieldLuts = 3 * kRecordBits;

// Reads records: a window of two 16-byte words, shifted by bytes; fields; addresses of two chains.
AreaBlock record_reader(const FastTree2Config& c, const Widths& w) {
  return {
      "",
      mux(kRecordBits, 16) + mux(128, 2) + kFieldLuts + 3 * adder(kCountBits) + adder(kAddressBits),
      kRecordBits + 3 * w.chain + 2 * w.chunk + 64,
      2ull * 8 * c.combine_bytes + 8ull * c.record_prefetch_bytes};
}

AreaBlock lane(const FastTree2Config& c, const Widths& w) {
  const AreaBlock reader = record_reader(c, w);
  const AreaBlock walk = box_walk(w.cell);
  const U words = c.lane_cells / 8;
  AreaBlock b;
  // Front: walk, mask of a block, eight increments, then eight prefixes and their carry.
  b.luts = walk.luts + morton_luts(w.cell, w.cell) + 3 * 8 + 8 * adder(w.offset) + adder(w.base);
  b.luts += 12 * adder(w.offset) + adder(w.base) + mux(8 * w.offset, 3);
  // Words in use: two sets, next one up and down.
  b.luts += 2 * 2 * encoder(words);
  // Back: walk and mask; positions; a crossbar to the banks of placed references, with its
  // conflicts.
  b.luts += walk.luts + morton_luts(w.cell, w.cell) + 3 * 8;
  b.luts += 8 * (adder(w.base) + adder(w.offset) + comparator(w.base));
  const U place_bits = bits_for(c.lane_references) + w.record;
  b.luts += c.place_width * (mux(place_bits, 8) + 8);
  // Streaming: references to banks of ids and ids back, conflicts, the gathered line.
  const U banks = 2 * c.stream_ids;
  b.luts += banks * mux(w.record, c.stream_ids) + c.stream_ids * mux(kIdBits, banks) +
            c.stream_ids * banks;
  b.luts += mux(kBeatBits, c.stream_ids) + 2 * adder(kAddressBits);
  // Leaves: eight differences against zero, one subtraction.
  b.luts += 8 * comparator(w.base) + encoder(8) + adder(w.base) + adder(kAddressBits);
  b.luts += 300;  // two state machines
  b.luts += reader.luts;
  b.registers = 2 * walk.registers + 2 * words + 2 * 8 * w.offset + 2 * w.base +
                c.place_width * place_bits + c.stream_ids * (w.record + kIdBits) + kBeatBits +
                2 * (w.task + kCountBits + kAddressBits) + 200 + reader.registers;
  b.sram_bits = reader.sram_bits;
  // Records: the id, and a box inside a bucket whose cells are counted here.
  b.sram_bits += std::uint64_t{c.lane_records} * (kIdBits + 2 * w.cell);
  b.sram_bits += std::uint64_t{c.lane_references} * w.record;
  b.sram_bits += 2ull * words * (w.base + 8 * w.offset);
  b.sram_bits += std::uint64_t{c.leaf_queue} * (kDepth + kAddressBits + kCountBits + 1);
  return b;
}

}  // namespace

std::uint32_t FastTree2Area::luts() const {
  U sum = 0;
  for (const AreaBlock& b : blocks) sum += b.luts;
  return sum;
}
std::uint32_t FastTree2Area::registers() const {
  U sum = 0;
  for (const AreaBlock& b : blocks) sum += b.registers;
  return sum;
}
std::uint64_t FastTree2Area::sram_bits() const {
  std::uint64_t sum = 0;
  for (const AreaBlock& b : blocks) sum += b.sram_bits;
  return sum - shared_bits;
}

FastTree2Area fasttree2_area(const FastTree2Config& c) {
  const Widths w(c);
  FastTree2Area area;
  const auto add = [&](const char* name, AreaBlock b) {
    b.name = name;
    area.blocks.push_back(b);
  };
  const U triangle_bits = 9 * 32;

  // Beats to triangles: words of the beat to any of the gearbox's, and two counters.
  add("scene_reader",
      {"", mux(triangle_bits + kBeatBits, 9) + 3 * adder(kAddressBits),
       triangle_bits + kBeatBits + 3 * kAddressBits, 8ull * c.scene_prefetch_bytes});
  // The triangle's box serves the bounds and the generation; six more hold the bounds.
  add("scene_bound", {"", (kBoxSelects + 6) * kSelectLuts,
                      (kBoxSelects + 6) * kSelectRegisters + triangle_bits, 0});
  {
    const AreaBlock walk = box_walk(kCoordinateBits);
    // Corners wait for the shared quantisers; a shifter each for the axis' bits.
    add("morton_code", {"",
                        c.quantisers * (kQuantiserLuts + mux(32, 6) + mux(kCoordinateBits, 16)) +
                            walk.luts + morton_luts(log2(c.buckets), kCoordinateBits) +
                            2 * adder(kCountBits) + 2 * 64 + kFieldLuts,
                        c.quantisers * kQuantiserRegisters + 6 * 32 + 6 * kCoordinateBits +
                            walk.registers + kRecordBits + 2 * kCountBits,
                        0});
  }
  {
    // One datapath serves both partitions, which are never under way at the same time. A record of
    // twelve bytes is shifted by up to 3 bytes, then by 0, 4, 8 or 12, and is offered to every
    // sixteen bytes of the line, with an enable a byte.
    const U shift = 8 * 15 + 8 * 27 + mux(8 * c.combine_bytes, 2) + 2 * c.combine_bytes;
    const std::uint64_t entry = 2 * w.chunk + w.line_in_chunk + w.fill + kCountBits;
    add("write_combiner",
        {"", shift + 3 * adder(kCountBits) + comparator(kCountBits) + 120,
         2 * kRecordBits + 8 * c.combine_bytes + 64,
         c.buckets * entry + 8ull * c.buckets * c.combine_bytes + 8ull * c.write_buffer_bytes});
    add("write_combiner2",
        {"", 60, 32,
         c.sub_buckets * (entry + w.chunk) + 8ull * c.sub_buckets * c.combine_bytes +
             8ull * c.write_buffer_bytes});
  }
  add("chunk_pool", {"", adder(w.chunk) + adder(kAddressBits) + 80, 2 * w.chunk + 60,
                     std::uint64_t{c.free_chunks} * w.chunk + 2 * 8 * 64});
  {
    const AreaBlock walk = box_walk(kCoordinateBits);
    AreaBlock b = record_reader(c, w);
    b.luts += walk.luts + morton_luts(log2(c.sub_buckets) + 2, kCoordinateBits) + kFieldLuts +
              encoder(c.buckets) / 4 + 200;
    b.registers += walk.registers + 2 * w.task + 100;
    b.sram_bits += ft2::BucketWalker::stack_bound(c) * w.task;
    b.sram_bits += std::uint64_t{c.ready_buckets} * w.task + c.buckets;  // and which hold anything
    add("bucket_walker", b);
  }
  std::uint64_t lane_memory = 0;
  for (U i = 0; i < c.lanes; ++i) {
    const AreaBlock b = lane(c, w);
    add(("lane" + std::to_string(i)).c_str(), b);
    lane_memory += b.sram_bits - 8ull * c.record_prefetch_bytes - 16ull * c.combine_bytes;
  }
  // The lanes' memories hold the lines of the first partition: their ports have two users.
  add("shared memories", {"", mux(8 * c.combine_bytes, 2) + 100, 8 * c.combine_bytes, 0});
  add("ids", {"", mux(kBeatBits + kAddressBits, c.lanes), 0, 8ull * c.write_buffer_bytes});
  {
    const U open_bits = 5 + 2 + 32 + kIdBits + 1;
    // Highest different bit; the stack as distributed memory; a coordinate out of a code; a search
    // with a quantiser, a multiply-and-add as large, and three adders; the gathered line.
    const U search = 2 * kQuantiserLuts + 3 * adder(32);
    add("node_emitter",
        {"",
         32 + encoder(32) + 2 * open_bits + mux(kCoordinateBits, kDepth) + search +
             c.nodes_per_cycle * mux(64, 4) + 3 * adder(kAddressBits) + 150,
         2 * kQuantiserRegisters + 2 * open_bits + kBeatBits + 4 * kAddressBits,
         3ull * c.plane_cache * (32 + kCoordinateBits) + 8ull * c.write_buffer_bytes});
  }
  {
    const U reads = 3 + c.lanes;
    const U writes = 5;
    add("dma", {"",
                kChannels * (mux(kAddressBits, reads + writes) + mux(kBeatBits, writes) +
                             2 * encoder(reads + writes)) +
                    (reads + writes) * (2 * adder(8) + 40),
                kChannels * (kBeatBits + kAddressBits + 16) + (reads + writes) * 40, 0});
  }
  // Registers of the host, stages, extents, one iterative divider, axis schedule.
  add("control", {"", 250 + 3 * adder(32) + 300 + 300, 900 + c.queue_depth * 2 * kRecordBits, 0});
  // Queues of triangles between reader, bounds and codes: distributed memory, a table two bits
  // of 32.
  add("queues", {"", (2 * triangle_bits + 2 * (kRecordBits + 12)) / 2, 100, 0});

  area.shared_bits = std::min<std::uint64_t>(lane_memory, 8ull * c.buckets * c.combine_bytes) +
                     std::min<std::uint64_t>(8ull * c.scene_prefetch_bytes,
                                             8ull * c.record_prefetch_bytes * (c.lanes + 1));
  return area;
}

}  // namespace fasttree::model
