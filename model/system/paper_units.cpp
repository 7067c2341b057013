// SPDX-License-Identifier: Apache-2.0
#include "model/system/paper_units.h"

namespace fasttree::model {
namespace {

std::vector<std::unique_ptr<MortonCodeUnit>> make_morton_code(const PaperConfig& config) {
  std::vector<std::unique_ptr<MortonCodeUnit>> units;
  for (std::uint32_t i = 0; i < config.morton_code.units; ++i) {
    units.push_back(
        std::make_unique<MortonCodeUnit>("mcgu" + std::to_string(i), config.morton_code));
  }
  return units;
}

std::vector<std::unique_ptr<PrefixSumUnit>> make_prefix_sum(const PaperConfig& config) {
  std::vector<std::unique_ptr<PrefixSumUnit>> units;
  for (std::uint32_t i = 0; i < config.prefix_sum.units; ++i) {
    units.push_back(std::make_unique<PrefixSumUnit>("psu" + std::to_string(i), config.prefix_sum));
  }
  return units;
}

template <typename T>
std::vector<T*> pointers(const std::vector<std::unique_ptr<T>>& units) {
  std::vector<T*> list;
  for (const auto& unit : units) list.push_back(unit.get());
  return list;
}

}  // namespace

PaperUnits::PaperUnits(const PaperConfig& config, double clock_mhz, Memory& memory,
                       ByteStore& store)
    : bus(config.bus, clock_mhz, memory, store),
      scene_port(bus.add_port("scene")),
      pair_port(bus.add_port("pairs")),
      sort_read_port(bus.add_port("sort_read")),
      sort_port(bus.add_port("sort")),
      leaf_read_port(bus.add_port("leaf_read")),
      leaf_code_port(bus.add_port("leaf_codes")),
      leaf_row_port(bus.add_port("leaf_rows")),
      internal_read_port(bus.add_port("internal_read")),
      node_port(bus.add_port("nodes")),
      clear_port(bus.add_port("clear")),
      cache_port(bus.add_port("cache")),
      climb_read_port(bus.add_port("climb_read")),
      link_port(bus.add_port("links")),
      scene_reader(config, scene_port),
      lower_bound(SceneBoundUnit::Side::lower, config.scene_bound),
      upper_bound(SceneBoundUnit::Side::upper, config.scene_bound),
      morton_code(make_morton_code(config)),
      pair_writer(config, pair_port),
      prefix_sum(make_prefix_sum(config)),
      radix_sort(config, sort_read_port, sort_port, pointers(prefix_sum)),
      leaf_node(config, leaf_read_port, leaf_code_port, leaf_row_port),
      split_plane(config, node_port),
      mark_cache(config, cache_port),
      bit_encoding(config, clear_port, mark_cache.requests),
      internal_node(config, internal_read_port, split_plane.input, bit_encoding.input),
      path_compression(config, climb_read_port, link_port, mark_cache.requests,
                       mark_cache.answers) {}

std::vector<Unit*> PaperUnits::all() {
  std::vector<Unit*> units{&bus, &scene_reader, &lower_bound, &upper_bound};
  for (auto& unit : morton_code) units.push_back(unit.get());
  units.push_back(&pair_writer);
  for (auto& unit : prefix_sum) units.push_back(unit.get());
  for (Unit* unit :
       std::initializer_list<Unit*>{&radix_sort, &leaf_node, &internal_node, &split_plane,
                                    &bit_encoding, &mark_cache, &path_compression}) {
    units.push_back(unit);
  }
  return units;
}

Phase PaperUnits::bound_phase() {
  Phase phase;
  phase.units = {&scene_reader, &lower_bound, &upper_bound};
  phase.ports = {&scene_port};
  phase.clocks.add(lower_bound);
  phase.clocks.add(upper_bound);
  return phase;
}

Phase PaperUnits::code_phase() {
  Phase phase;
  phase.units = {&scene_reader, &pair_writer};
  phase.ports = {&scene_port, &pair_port};
  for (auto& unit : morton_code) {
    phase.units.push_back(unit.get());
    phase.clocks.add(*unit);
  }
  return phase;
}

Phase PaperUnits::sort_phase() {
  Phase phase;
  phase.units = {&radix_sort};
  phase.ports = {&sort_read_port, &sort_port};
  for (auto& unit : prefix_sum) {
    phase.units.push_back(unit.get());
    phase.clocks.add(*unit);
  }
  return phase;
}

Phase PaperUnits::leaf_phase() {
  Phase phase;
  phase.units = {&leaf_node};
  phase.ports = {&leaf_read_port, &leaf_code_port, &leaf_row_port};
  return phase;
}

Phase PaperUnits::clear_phase() {
  Phase phase;
  phase.units = {&bit_encoding};
  phase.ports = {&clear_port};
  return phase;
}

Phase PaperUnits::internal_phase() {
  Phase phase;
  phase.units = {&internal_node, &split_plane, &bit_encoding, &mark_cache};
  phase.ports = {&internal_read_port, &node_port, &cache_port};
  phase.clocks.add(split_plane);
  phase.clocks.add(bit_encoding);
  phase.clocks.add(mark_cache);
  return phase;
}

Phase PaperUnits::climb_phase() {
  Phase phase;
  phase.units = {&path_compression, &mark_cache};
  phase.ports = {&climb_read_port, &link_port, &cache_port};
  phase.clocks.add(mark_cache);
  return phase;
}

}  // namespace fasttree::model
