// SPDX-License-Identifier: Apache-2.0
#include "model/report/paper_area.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace fasttree::model {
namespace {

// Costs of parts in six-input lookup tables with carry chains.
constexpr double kAdder32 = 32;    // one bit a LUT
constexpr double kCompare32 = 16;  // two bits a LUT
constexpr double kMux2 = 0.5;      // a bit of a 2-to-1 choice: two share a LUT
constexpr double kCompareTag = 8;  // 22 bits for equality, three a LUT
constexpr double kPairBits = 64;   // a code and an id, as registers hold them
constexpr double kTriangleBits = 288;
// What Table I's SBCU row leaves for one compare-and-select of binary32: 2485 LUTs and 1415
// registers over 2 x 8 of them.
constexpr double kSelectLuts = 2485.0 / 16;
constexpr double kSelectRegisters = 1415.0 / 16;
// A subtraction and a multiplication of binary32 without DSP blocks, from what Table I's MCGU row
// leaves after its box and its iteration.
constexpr double kQuantiserLuts = 1150;
constexpr double kQuantiserStage = 40;  // registers a stage, what Table I has room for at seven
// A split plane's coordinate and its value, our RTL without DSP blocks.
constexpr double kPlaneLuts = 3100;
constexpr double kPlaneStage = 42;  // registers a stage

/// LUTs of an n-to-1 choice of one bit: a LUT of six inputs takes three off the choice.
double mux(double n) {
  return n <= 1 ? 0 : std::ceil((n - 1) / 3);
}

double log2_of(std::uint32_t n) {
  return static_cast<double>(std::bit_width(n) - 1);
}

Resources scene_bound(const PaperConfig& c) {
  // A tree of inputs - 1, and one against the current bound; twice, lower and upper.
  const double selects = 2.0 * c.scene_bound.inputs;
  const double waiting = 2.0 * (c.scene_bound.queue - 2.0) * c.scene_bound.inputs * 32;
  return {selects * kSelectLuts, selects * kSelectRegisters + waiting, 0};
}

Resources prefix_sum(const PaperConfig& c) {
  // Up-sweep and down-sweep of n are 2 n - 2 - log2 n adders, the section's offset n more.
  const double n = c.prefix_sum.section;
  const double adders = 3 * n - 2 - log2_of(c.prefix_sum.section);
  // Table I has 44.6 registers of 32 bits a PSU, where two stages of 32 would be 64: a partial sum
  // has fewer bits.
  const double register_bits = 5702.0 / (4 * 2 * 32);
  return {adders * kAdder32, c.prefix_sum.stages * n * register_bits, 0};
}

Resources morton_code(const PaperConfig& c) {
  const PaperConfig::MortonCode& m = c.morton_code;
  // Six bounds of three values each are two selects each; three counters walk over the box.
  const double box = 12 * kSelectLuts + 3 * kAdder32;
  const double queues = m.input_queue * kTriangleBits + m.output_queue * kPairBits;
  return {box + m.quantisers * kQuantiserLuts,
          queues + m.quantisers * m.quantiser_latency * kQuantiserStage, 0};
}

Resources radix_sort(const PaperConfig& c) {
  const PaperConfig::RadixSort& r = c.radix_sort;
  const double section = static_cast<double>(c.prefix_sum.units) * c.prefix_sum.section;
  const double digits = std::exp2(r.radix_bits);
  const double key = 8.0 * r.key_bytes + 32;
  const double block = 8.0 * r.combine_bytes;
  Resources sum;
  // The section with its pairs and their ranks; blocks that digits gather; two tables of counts.
  sum.registers =
      section * key * (r.double_buffer ? 2 : 1) + section * 32 + digits * block + 2 * digits * 32;
  // A pair out of the section; a digit's block to the bus; a flag an element; ranks to addresses.
  sum.luts = r.pairs_per_cycle * (key * mux(section) + kAdder32) + block * mux(digits) + section;
  return sum;
}

Resources leaf_node(const PaperConfig& c) {
  const double width = c.leaf_node.width;
  // Comparators with their choice of code and index, subtractors, and the network that moves new
  // leaves together on their way to the pool: half of log2 width stages of LUTs for each bit.
  const double network = std::ceil(std::log2(width)) * width * kPairBits * kMux2;
  return {width * (kCompare32 + kPairBits * kMux2 + kAdder32) + network +
              (c.leaf_node.rows_per_cycle - 1.0) * kPairBits * mux(c.leaf_node.pool),
          c.leaf_node.pool * kPairBits, 0};
}

Resources internal_node(const PaperConfig& c) {
  const PaperConfig::InternalNode& n = c.internal_node;
  // A shifter by one position a step, and the pipeline that computes planes.
  return {n.shifts_per_cycle * 32 * kMux2 + kPlaneLuts,
          2.0 * n.queue * 96 + n.plane_latency * kPlaneStage, 0};
}

Resources mark_cache(const PaperConfig& c) {
  const PaperConfig::MarkCache& m = c.mark_cache;
  const double blocks = static_cast<double>(m.bytes) / m.block_bytes;
  const double sets = std::max(1.0, blocks / m.ways);
  // What an address of 32 bits has left of the byte in its block and of the set.
  const double tag = 32 - std::log2(m.block_bytes) - std::log2(sets);
  const double order = std::ceil(std::log2(m.ways));
  Resources sum;
  sum.ram_kbits = (8.0 * m.bytes + blocks * tag) / 1024;
  // Order of use, valid, changed.
  sum.registers = blocks * (order + 1 + (m.write_back ? 1 : 0));
  sum.luts = m.ways * kCompareTag + 8.0 * m.block_bytes * mux(m.ways) + m.ways * order * mux(sets);
  return sum;
}

Resources bus(const PaperConfig& c) {
  const PaperConfig::Bus& b = c.bus;
  const double ports = 12, reading_ports = 5;
  const double data = 8.0 * b.bytes;
  const double paths = b.duplex ? 2 : 1;
  Resources sum;
  // One of the ports onto each data path; a shifter of bytes at each port.
  sum.luts = paths * data * mux(ports) + ports * data * std::log2(b.bytes) * kMux2 +
             b.commands_per_cycle * 32 * mux(ports);
  // Bytes read ahead; requests that wait with their data; reads under way; the writer of pairs.
  sum.registers = reading_ports * 8.0 * b.read_ahead_bytes + ports * b.request_queue * (data + 32) +
                  ports * b.reads_in_flight * 8 +
                  8.0 * c.morton_code.combine_bytes * c.morton_code.pairs_per_cycle;
  return sum;
}

/// The units of Table I, which is in the order of this list, and their rows there.
struct Listed {
  const char* kind;
  std::uint32_t (*count)(const PaperConfig&);
  Resources (*one)(const PaperConfig&);  ///< counted: of one unit, or of all where `together`
  bool together;
  Resources table;
};

std::uint32_t one(const PaperConfig&) {
  return 1;
}
std::uint32_t two(const PaperConfig&) {
  return 2;
}
std::uint32_t prefix_sum_units(const PaperConfig& c) {
  return c.prefix_sum.units;
}
std::uint32_t morton_code_units(const PaperConfig& c) {
  return c.morton_code.units;
}
Resources nothing(const PaperConfig&) {
  return {};
}

// Liu, Deng, Ni, Li: FastTree, Table I ("Hardware Resources Usage Result").
constexpr Resources kOverall{173391, 180057, 172};
constexpr Listed kListed[] = {
    {"scene_bound", two, scene_bound, true, {2485, 1415, 0}},
    {"prefix_sum", prefix_sum_units, prefix_sum, false, {11454, 5702, 0}},
    {"morton_code", morton_code_units, morton_code, false, {12454, 7561, 0}},
    {"radix_sort", one, radix_sort, true, {16530, 50282, 0}},
    {"leaf_node", one, leaf_node, true, {8220, 4641, 0}},
    {"internal_node", one, internal_node, true, {9093, 5727, 0}},
    {"bit_encoding", one, nothing, true, {1157, 1086, 0}},
    {"path_compression", one, nothing, true, {7251, 5562, 0}},
    {"mark_cache", one, mark_cache, true, {21744, 34295, 172}},
};

}  // namespace

Resources paper_area_total() {
  return kOverall;
}

std::vector<PaperAreaRow> paper_area_rows(const PaperConfig& config) {
  const PaperConfig paper;  // its defaults are the paper's machine
  std::vector<PaperAreaRow> rows;
  Resources unlisted = kOverall;
  for (const Listed& unit : kListed) {
    const std::uint32_t count = unit.count(config);
    const double counted_times = unit.together ? 1 : count;
    const double paper_times = unit.together ? 1 : unit.count(paper);
    const double share = static_cast<double>(count) / unit.count(paper);
    const Resources rest = unit.table - paper_times * unit.one(paper);
    rows.push_back({unit.kind, count, counted_times * unit.one(config), share * rest});
    unlisted = unlisted - unit.table;
  }
  // Of what Table I does not list, the bus is counted; all else is control, host and memory
  // interface, and stays as it is.
  rows.push_back({"bus", 1, bus(config), {}});
  rows.push_back({"control", 1, {}, unlisted - bus(paper)});
  return rows;
}

}  // namespace fasttree::model
