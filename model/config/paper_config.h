// SPDX-License-Identifier: Apache-2.0
// The machine of the paper: what it states and, where it is silent, our assumptions by name. No
// value changes a byte of the tree.
#pragma once

#include <cstdint>

#include "fasttree/build.h"
#include "fasttree/tree.h"
#include "model/config/fields.h"

namespace fasttree::model {

/// How the digits of a sorting round are counted.
enum class DigitCount : std::uint8_t {
  on_the_way,  ///< while the pairs are written: by the MCGUs for round 1, then by the last scatter
  own_pass,    ///< each round reads all its pairs once more, before it moves them
};

/// Section [paper], in parts by unit. A new key is a member here and a line in declare(). Lines
/// that begin with "Paper:" repeat what it states, those with "Assumed:" fill what it leaves open.
struct PaperConfig {
  struct GridRule {
    AxisSchedule axes = AxisSchedule::cyclic;
    bool depth_fixed = false;
    std::uint32_t depth = 0;
    std::uint32_t extra_depth = 1;
    double max_growth = 6.0;
  };
  struct SceneBound {
    std::uint32_t inputs = 8;
    std::uint32_t queue = 2;
  };
  struct MortonCode {
    std::uint32_t units = 4;
    std::uint32_t quantisers = 1;
    std::uint32_t quantiser_latency = 7;
    std::uint32_t box_latency = 1;
    std::uint32_t input_queue = 2;
    std::uint32_t output_queue = 16;
    std::uint32_t pairs_per_cycle = 2;
    std::uint32_t combine_bytes = 32;
  };
  struct PrefixSum {
    std::uint32_t units = 4;
    std::uint32_t section = 32;
    std::uint32_t stages = 2;
  };
  struct RadixSort {
    std::uint32_t radix_bits = 4;
    std::uint32_t sorted_bits = 32;
    std::uint32_t key_bytes = 4;
    DigitCount digit_count = DigitCount::on_the_way;
    bool double_buffer = false;
    std::uint32_t pairs_per_cycle = 2;
    std::uint32_t combine_bytes = 32;
  };
  struct LeafNode {
    std::uint32_t width = 32;
    std::uint32_t pool = 64;
    std::uint32_t rows_per_cycle = 1;
  };
  struct InternalNode {
    std::uint32_t shifts_per_cycle = 1;
    std::uint32_t plane_cycles = 1;
    std::uint32_t plane_latency = 19;
    std::uint32_t queue = 4;
  };
  struct PathCompression {
    std::uint32_t step_cycles = 1;
  };
  struct MarkCache {
    std::uint32_t bytes = 16384;
    std::uint32_t ways = 16;
    std::uint32_t block_bytes = 8;
    std::uint32_t hit_latency = 1;
    std::uint32_t miss_penalty = 2;
    bool write_back = true;
  };
  struct Bus {
    std::uint32_t bytes = 16;
    bool duplex = false;
    std::uint32_t commands_per_cycle = 2;
    std::uint32_t burst_bytes = 64;
    std::uint32_t read_ahead_bytes = 512;
    std::uint32_t request_queue = 4;
    std::uint32_t reads_in_flight = 16;
  };
  struct Control {
    std::uint32_t step_cycles = 8;
    std::uint32_t setup_cycles = 101;
    std::uint32_t memory_mbytes = 1024;
    std::uint32_t stuck_cycles = 20000;
    bool count_host = false;
    std::uint32_t host_bytes_per_cycle = 1;
  };

  GridRule grid;
  SceneBound scene_bound;
  MortonCode morton_code;
  PrefixSum prefix_sum;
  RadixSort radix_sort;
  LeafNode leaf_node;
  InternalNode internal_node;
  PathCompression path_compression;
  MarkCache mark_cache;
  Bus bus;
  Control control;

  static void declare(Fields<PaperConfig>& fields);
};

}  // namespace fasttree::model
