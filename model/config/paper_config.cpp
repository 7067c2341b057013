// SPDX-License-Identifier: Apache-2.0
// The keys of section [paper], with what is allowed and why each has its default.
#include "model/config/paper_config.h"

namespace fasttree::model {
namespace {

Fields<PaperConfig::GridRule> grid_fields() {
  using C = PaperConfig::GridRule;
  Fields<C> f;
  f.choice("axes", &C::axes, {"cyclic", "longest"},
           "Paper: the classic Morton code, cyclic. Which axis each level of the grid halves");
  f.flag("depth_fixed", &C::depth_fixed, "Take depth as it stands instead of the rule");
  f.count("depth", &C::depth, 0, 30, "D, levels of the grid, where depth_fixed is true");
  f.count("extra_depth", &C::extra_depth, 0, 10,
          "Assumed: k of the rule, D is at most ceil(log2 N) + k; the host hands D over");
  f.real("max_growth", &C::max_growth, 1, 1000,
         "Assumed: the host lowers D until there are at most this many references a triangle");
  return f;
}

Fields<PaperConfig::SceneBound> scene_bound_fields() {
  using C = PaperConfig::SceneBound;
  Fields<C> f;
  f.power_of_two("scene_bound_inputs", &C::inputs, 2, 16,
                 "Paper: 8-to-1 selection, so three stages. Values an SBCU selects from a cycle");
  f.count("scene_bound_queue", &C::queue, 1, 64, "Assumed: groups that may wait for an SBCU");
  return f;
}

Fields<PaperConfig::MortonCode> morton_code_fields() {
  using C = PaperConfig::MortonCode;
  Fields<C> f;
  f.count("morton_code_units", &C::units, 1, 64, "Paper: four MCGUs");
  f.count("morton_code_quantisers", &C::quantisers, 1, 6,
          "Assumed from the area of Table I: one quantiser an MCGU, shared by its six bounds");
  f.count("morton_code_quantiser_latency", &C::quantiser_latency, 1, 64,
          "Of our RTL: cycles from a coordinate to its bits of a code");
  f.count("morton_code_box_latency", &C::box_latency, 1, 64,
          "Assumed: cycles of the three 3-input bound units");
  f.count("morton_code_input_queue", &C::input_queue, 1, 1024,
          "Assumed: triangles that may wait for an MCGU");
  f.count("morton_code_output_queue", &C::output_queue, 1, 1024,
          "Assumed: pairs that may wait behind an MCGU for those of earlier triangles");
  f.count("morton_code_pairs_per_cycle", &C::pairs_per_cycle, 1, 4,
          "Assumed from the bus width: pairs taken from the MCGUs in a cycle, in order");
  f.power_of_two("morton_code_combine_bytes", &C::combine_bytes, 8, 64,
                 "Assumed: pairs are written in blocks of this size");
  return f;
}

Fields<PaperConfig::PrefixSum> prefix_sum_fields() {
  using C = PaperConfig::PrefixSum;
  Fields<C> f;
  f.count("prefix_sum_units", &C::units, 1, 32, "Paper: four PSUs");
  f.power_of_two("prefix_sum_section", &C::section, 2, 64, "Paper: sections of 32 elements");
  f.count("prefix_sum_stages", &C::stages, 2, 64, "Paper: two stages, up-sweep and down-sweep");
  return f;
}

Fields<PaperConfig::RadixSort> radix_sort_fields() {
  using C = PaperConfig::RadixSort;
  Fields<C> f;
  f.count("radix_sort_radix_bits", &C::radix_bits, 1, 8, "Paper: radix 16, so 4 bits");
  f.count("radix_sort_sorted_bits", &C::sorted_bits, 1, 32,
          "Paper: eight rounds, so all 32 bits of a code, used or not; at least D");
  f.count("radix_sort_key_bytes", &C::key_bytes, 1, 4,
          "Paper: operands of 32 bits. Bytes of a code in a pair, beside four of the id");
  f.choice("radix_sort_digit_count", &C::digit_count, {"on_the_way", "own_pass"},
           "Assumed: digits are counted as pairs are written (MCGU output goes to the PSUs)");
  f.flag("radix_sort_double_buffer", &C::double_buffer,
         "Assumed: no; whether a section is fetched while the one before is moved");
  f.count("radix_sort_pairs_per_cycle", &C::pairs_per_cycle, 1, 4,
          "Assumed from the bus width: pairs moved to their digits in a cycle");
  f.power_of_two("radix_sort_combine_bytes", &C::combine_bytes, 8, 64,
                 "Assumed: a digit's pairs are gathered and written in blocks of this size");
  return f;
}

Fields<PaperConfig::LeafNode> leaf_node_fields() {
  using C = PaperConfig::LeafNode;
  Fields<C> f;
  f.count("leaf_node_width", &C::width, 1, 256, "Paper: 32 comparisons and 32 subtractions");
  f.count("leaf_node_pool", &C::pool, 1, 65536,
          "Assumed: leaves in the buffer pool (at least two)");
  f.count("leaf_node_rows_per_cycle", &C::rows_per_cycle, 1, 4,
          "Assumed: leaves moved to the pool, and rows of the leaf table written, in a cycle");
  return f;
}

Fields<PaperConfig::InternalNode> internal_node_fields() {
  using C = PaperConfig::InternalNode;
  Fields<C> f;
  f.count("internal_node_shifts_per_cycle", &C::shifts_per_cycle, 1, 32,
          "Paper: an iterative right shifter, so 1");
  f.count("internal_node_plane_cycles", &C::plane_cycles, 1, 64,
          "Ours: cycles from one split plane to the next");
  f.count("internal_node_plane_latency", &C::plane_latency, 1, 256,
          "Ours: cycles from a node to its split plane");
  f.count("internal_node_queue", &C::queue, 1, 1024,
          "Assumed: nodes that may wait for their plane, and for the BEU");
  return f;
}

Fields<PaperConfig::PathCompression> path_compression_fields() {
  using C = PaperConfig::PathCompression;
  Fields<C> f;
  f.count("path_compression_step_cycles", &C::step_cycles, 1, 64,
          "Assumed: cycles from a node's index to its parent's");
  return f;
}

Fields<PaperConfig::MarkCache> mark_cache_fields() {
  using C = PaperConfig::MarkCache;
  Fields<C> f;
  f.power_of_two("mark_cache_bytes", &C::bytes, 64, 1 << 20, "Paper: 16 KB");
  f.power_of_two("mark_cache_ways", &C::ways, 1, 64, "Paper: 16 ways, least recently used");
  f.power_of_two("mark_cache_block_bytes", &C::block_bytes, 4, 64, "Paper: blocks of 8 bytes");
  f.count("mark_cache_hit_latency", &C::hit_latency, 1, 64, "Assumed: cycles of a hit");
  f.count("mark_cache_miss_penalty", &C::miss_penalty, 0, 64,
          "Assumed: cycles from a miss to its request; the cache serves nothing else meanwhile");
  f.flag("mark_cache_write_back", &C::write_back,
         "Assumed: a written block goes to memory when it is evicted; else at once");
  return f;
}

Fields<PaperConfig::Bus> bus_fields() {
  using C = PaperConfig::Bus;
  Fields<C> f;
  f.power_of_two("bus_bytes_per_cycle", &C::bytes, 4, 64,
                 "Assumed: what the bus moves in a cycle (the paper does not say)");
  f.flag("bus_duplex", &C::duplex,
         "Assumed: no; whether reads and writes have a data path each, instead of sharing one");
  f.count("bus_commands_per_cycle", &C::commands_per_cycle, 1, 8,
          "Assumed: bursts that memory is asked to read in a cycle");
  f.power_of_two("bus_burst_bytes", &C::burst_bytes, 8, 64,
                 "Assumed: what a stream of reads asks for at once");
  f.count("bus_read_ahead_bytes", &C::read_ahead_bytes, 128, 65536,
          "Assumed: bytes of a stream that are asked for or wait at its port");
  f.count("bus_request_queue", &C::request_queue, 4, 256,
          "Assumed: requests that may wait at a port");
  f.count("bus_reads_in_flight", &C::reads_in_flight, 1, 256,
          "Assumed: reads of a port that memory may be at");
  return f;
}

Fields<PaperConfig::Control> control_fields() {
  using C = PaperConfig::Control;
  Fields<C> f;
  f.count("control_step_cycles", &C::step_cycles, 0, 10000,
          "Assumed: cycles to start a step, or a round of the sort");
  f.count("control_setup_cycles", &C::setup_cycles, 0, 10000,
          "Assumed: cycles from the bounds to schedule and scales");
  f.count("control_memory_mbytes", &C::memory_mbytes, 1, 65536,
          "Paper: 1 GB of off-chip memory, in units of 2^20 bytes");
  f.count("control_stuck_cycles", &C::stuck_cycles, 1000, 1000000000,
          "Cycles without any progress after which the machine is reported as stuck");
  f.flag("control_count_host", &C::count_host,
         "Paper: no; whether cycles of the transfers from and to the host are counted");
  f.count("control_host_bytes_per_cycle", &C::host_bytes_per_cycle, 1, 256,
          "Assumed: speed of those transfers");
  return f;
}

}  // namespace

void PaperConfig::declare(Fields<PaperConfig>& fields) {
  using C = PaperConfig;
  fields.include(&C::grid, grid_fields())
      .include(&C::scene_bound, scene_bound_fields())
      .include(&C::morton_code, morton_code_fields())
      .include(&C::prefix_sum, prefix_sum_fields())
      .include(&C::radix_sort, radix_sort_fields())
      .include(&C::leaf_node, leaf_node_fields())
      .include(&C::internal_node, internal_node_fields())
      .include(&C::path_compression, path_compression_fields())
      .include(&C::mark_cache, mark_cache_fields())
      .include(&C::bus, bus_fields())
      .include(&C::control, control_fields());
}

}  // namespace fasttree::model
