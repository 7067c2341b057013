// SPDX-License-Identifier: Apache-2.0
// The machine fasttree-2: ours. None of its numbers changes a byte of the tree; each is a size, a
// width or a latency, and model/fasttree2/area.h says what it costs.
#pragma once

#include <cstdint>

#include "fasttree/tree.h"
#include "model/config/fields.h"

namespace fasttree::model {

/// Section [fasttree2]. A new key is a member here and a line in declare().
struct FastTree2Config {
  static constexpr std::uint32_t kDepthByRule = 31;

  // What is built.
  AxisSchedule axes = AxisSchedule::cyclic;
  std::uint32_t depth = kDepthByRule;
  std::uint32_t extra_depth = 1;
  double max_growth = 6.0;
  bool bounds_given = false;
  // Generation.
  std::uint32_t quantisers = 4;
  std::uint32_t quantiser_latency = 9;
  std::uint32_t divide_cycles = 30;
  std::uint32_t queue_depth = 4;
  // First partition.
  std::uint32_t buckets = 512;
  std::uint32_t combine_bytes = 64;
  std::uint32_t chunk_bytes = 2048;
  std::uint32_t free_chunks = 32;
  // Second partition.
  std::uint32_t sub_buckets = 32;
  std::uint32_t ready_buckets = 16;
  // Lanes.
  std::uint32_t lanes = 3;
  std::uint32_t lane_records = 1024;
  std::uint32_t lane_references = 2432;
  std::uint32_t lane_cells = 512;
  std::uint32_t place_width = 8;
  std::uint32_t stream_ids = 4;
  std::uint32_t leaf_queue = 8;
  // Nodes.
  std::uint32_t nodes_per_cycle = 2;
  std::uint32_t plane_cache = 32;
  // Ports to memory.
  std::uint32_t scene_prefetch_bytes = 2048;
  std::uint32_t record_prefetch_bytes = 1024;
  std::uint32_t write_buffer_bytes = 256;
  // A run.
  std::uint64_t stuck_cycles = 100'000;

  static void declare(Fields<FastTree2Config>& f) {
    using C = FastTree2Config;
    f.choice("axes", &C::axes, {"cyclic", "longest"}, "Axis schedule of the grid");
    f.count("depth", &C::depth, 0, kDepthByRule, "Levels of the grid; 31: by the library's rule");
    f.count("extra_depth", &C::extra_depth, 0, 30, "Rule: at most ceil(log2 N) plus this");
    f.real("max_growth", &C::max_growth, 1, 1000, "Rule: at most so many references a triangle");
    f.flag("bounds_given", &C::bounds_given,
           "The host knows the scene's bounds; they are checked, and generation redone if wrong");
    f.count("quantisers", &C::quantisers, 1, 12, "Quantisations a cycle; a triangle takes six");
    f.count("quantiser_latency", &C::quantiser_latency, 1, 64,
            "Cycles from a triangle's corners to its box of cells");
    f.count("divide_cycles", &C::divide_cycles, 0, 1000,
            "Cycles from the bounds to the quantisers' scales, once a build");
    f.count("queue_depth", &C::queue_depth, 1, 64, "Entries of the queues between units");
    f.power_of_two("buckets", &C::buckets, 1, 4096, "Buckets of the first partition");
    f.power_of_two("combine_bytes", &C::combine_bytes, 16, 256,
                   "Bytes of a bucket that are gathered before they are written");
    f.power_of_two("chunk_bytes", &C::chunk_bytes, 16, 65536,
                   "Bytes of the linked pieces of a bucket in memory; at least combine_bytes");
    f.count("free_chunks", &C::free_chunks, 24, 4096,
            "Free chunks kept on chip; more are spilled to memory");
    f.power_of_two("sub_buckets", &C::sub_buckets, 2, 256, "Most parts of a second partition");
    f.count("ready_buckets", &C::ready_buckets, 1, 256, "Buckets that may wait for a lane");
    f.count("lanes", &C::lanes, 1, 16, "Lanes, each a counting sort of one bucket");
    f.count("lane_records", &C::lane_records, 1, 65536, "Records a lane holds");
    f.count("lane_references", &C::lane_references, 1, 1 << 20,
            "References a lane places before it streams them out");
    f.power_of_two("lane_cells", &C::lane_cells, 8, 65536, "Counters of a lane, eight to a word");
    f.count("place_width", &C::place_width, 1, 8,
            "References a lane places in a cycle, each in a bank of its own");
    f.count("stream_ids", &C::stream_ids, 1, 8, "Ids a lane streams out in a cycle");
    f.count("leaf_queue", &C::leaf_queue, 1, 64, "Leaves between a lane and the node emitter");
    f.count("nodes_per_cycle", &C::nodes_per_cycle, 1, 4, "Nodes written in a cycle");
    f.power_of_two("plane_cache", &C::plane_cache, 1, 4096, "Split planes kept for each axis");
    f.count("scene_prefetch_bytes", &C::scene_prefetch_bytes, 32, 65536,
            "Prefetch buffer of the scene's reader");
    f.count("record_prefetch_bytes", &C::record_prefetch_bytes, 32, 65536,
            "Prefetch buffer of each reader of records");
    f.count("write_buffer_bytes", &C::write_buffer_bytes, 128, 65536,
            "Write buffer of each writing port");
    f.count("stuck_cycles", &C::stuck_cycles, 1000, 1'000'000'000,
            "Cycles without any progress after which a run ends with a report");
  }
};

}  // namespace fasttree::model
