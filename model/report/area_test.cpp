// SPDX-License-Identifier: Apache-2.0
#include "model/report/area.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "model/config/sections.h"
#include "model/fasttree2/area.h"
#include "model/report/paper_area.h"

namespace fasttree::model {
namespace {

MachineConfig config_of(const std::string& name) {
  return load_config(name).value();
}

TEST(Area, ThePapersMachineHasThePapersTotals) {
  for (const char* name : {"paper-fpga", "paper-asic65", "paper-asic28"}) {
    const AreaReport report = area(config_of(name));
    EXPECT_NEAR(report.total.luts, 173391, 1e-6) << name;
    EXPECT_NEAR(report.total.registers, 180057, 1e-6) << name;
    EXPECT_NEAR(report.total.ram_kbits, 172, 1e-9) << name;
    EXPECT_NEAR(report.mm2_65nm, 5.4, 1e-9) << name;
    EXPECT_NEAR(report.mm2_28nm, 1.4, 1e-9) << name;
  }
}

TEST(Area, NoRowIsCountedBeyondTableI) {
  // A rest below nothing would mean that the structure as counted does not fit in the paper's.
  const PaperConfig paper;
  for (const PaperAreaRow& row : paper_area_rows(paper)) {
    EXPECT_GE(row.rest.luts, -1e-6) << row.kind;
    EXPECT_GE(row.rest.registers, -1e-6) << row.kind;
    EXPECT_GE(row.rest.ram_kbits, -1e-9) << row.kind;
  }
}

TEST(Area, WhatTableIImplies) {
  // 89 adders a PSU, and a cache of data and 2048 tags of 22 bits, explain their rows.
  for (const PaperAreaRow& row : paper_area_rows(PaperConfig{})) {
    if (row.kind == std::string("prefix_sum")) {
      EXPECT_EQ(row.counted.luts, 4 * 89 * 32);
    } else if (row.kind == std::string("mark_cache")) {
      EXPECT_EQ(row.counted.ram_kbits, 128 + 44);
    }
  }
}

TEST(Area, RowsAddUp) {
  const AreaReport report = area(config_of("paper-asic65"));
  Resources sum;
  double mm2 = 0;
  for (const AreaRow& row : report.rows) {
    sum += row.resources;
    mm2 += row.mm2_65nm;
  }
  EXPECT_DOUBLE_EQ(sum.luts, report.total.luts);
  EXPECT_DOUBLE_EQ(mm2, report.mm2_65nm);
}

/// Keys of which more has to cost something, and others of which more may cost nothing.
const std::vector<std::string> kCostly = {"scene_bound_inputs",
                                          "scene_bound_queue",
                                          "morton_code_units",
                                          "morton_code_quantisers",
                                          "morton_code_input_queue",
                                          "morton_code_output_queue",
                                          "morton_code_combine_bytes",
                                          "prefix_sum_units",
                                          "prefix_sum_section",
                                          "prefix_sum_stages",
                                          "radix_sort_radix_bits",
                                          "radix_sort_pairs_per_cycle",
                                          "radix_sort_combine_bytes",
                                          "radix_sort_double_buffer",
                                          "leaf_node_width",
                                          "leaf_node_pool",
                                          "leaf_node_rows_per_cycle",
                                          "internal_node_shifts_per_cycle",
                                          "internal_node_plane_latency",
                                          "internal_node_queue",
                                          "mark_cache_bytes",
                                          "mark_cache_ways",
                                          "mark_cache_write_back",
                                          "bus_bytes_per_cycle",
                                          "bus_duplex",
                                          "bus_commands_per_cycle",
                                          "bus_read_ahead_bytes",
                                          "bus_request_queue",
                                          "bus_reads_in_flight"};

const Section& section_of(const std::string& name) {
  for (const Section& section : config_sections()) {
    if (section.name == name) return section;
  }
  throw std::logic_error(name);
}

const Field& field_of(const Section& section, const std::string& key) {
  for (const Field& field : section.fields) {
    if (field.key == key) return field;
  }
  throw std::logic_error(key);
}

FieldValue value_between(const Field& field, double part) {
  if (field.kind == Field::Kind::flag) return part > 0.5;
  if (field.kind == Field::Kind::power_of_two) {
    const double least = std::log2(field.least), most = std::log2(field.most);
    return static_cast<std::uint64_t>(std::exp2(std::floor(least + part * (most - least))));
  }
  return static_cast<std::uint64_t>(field.least + part * (field.most - field.least));
}

RC_GTEST_PROP(Area, MoreNeverCostsLess, ()) {
  const Section& section = section_of("paper");
  // Everything anywhere, then one key from less to more.
  MachineConfig config;
  config.name = "any";
  for (const std::string& key : kCostly) {
    const Field& field = field_of(section, key);
    const double part = *rc::gen::inRange(0, 101) / 100.0;
    RC_ASSERT(set_field(section, field, config, value_between(field, part), "").ok());
  }
  const std::string key = *rc::gen::elementOf(kCostly);
  const Field& field = field_of(section, key);
  int a = *rc::gen::inRange(0, 101), b = *rc::gen::inRange(0, 101);
  if (a > b) std::swap(a, b);
  MachineConfig less = config, more = config;
  RC_ASSERT(set_field(section, field, less, value_between(field, a / 100.0), "").ok());
  RC_ASSERT(set_field(section, field, more, value_between(field, b / 100.0), "").ok());
  const AreaReport small = area(less), large = area(more);
  RC_ASSERT(small.mm2_65nm <= large.mm2_65nm * (1 + 1e-12));
  RC_ASSERT(small.total.luts <= large.total.luts + 1e-6);
  RC_ASSERT(small.total.registers <= large.total.registers + 1e-6);
  RC_ASSERT(small.total.ram_kbits <= large.total.ram_kbits + 1e-6);
  for (const AreaRow& row : small.rows) RC_ASSERT(row.mm2_65nm > 0);
}

TEST(Area, OfFastTree2IsThatOfItsBlocks) {
  const MachineConfig config = config_of("fasttree-2");
  const AreaReport report = area(config);
  const FastTree2Area blocks = fasttree2_area(config.fasttree2);
  EXPECT_NEAR(report.total.luts, blocks.luts(), 1e-6);
  EXPECT_NEAR(report.total.registers, blocks.registers(), 1e-6);
  EXPECT_NEAR(report.total.ram_kbits * 1024, static_cast<double>(blocks.sram_bits()), 1e-3);
  // At the paper's size of a gate.
  EXPECT_NEAR(report.mm2_65nm, 5.4 * gates_of(report.total) / gates_of(paper_area_total()), 1e-9);
  for (const AreaRow& row : report.rows) {
    EXPECT_GE(row.mm2_65nm, 0) << row.kind;
    if (row.kind == "lane") {
      EXPECT_EQ(row.count, config.fasttree2.lanes);
    }
  }
}

// Not of buckets, though: of more of them, each is a smaller box, and lanes need fewer bits for it.
TEST(Area, MoreOfFastTree2NeverCostsLess) {
  const std::vector<std::string> costly = {"quantisers",        "free_chunks",
                                           "ready_buckets",     "lanes",
                                           "lane_records",      "lane_cells",
                                           "place_width",       "plane_cache",
                                           "leaf_queue",        "queue_depth",
                                           "stream_ids",        "lane_references",
                                           "sub_buckets",       "record_prefetch_bytes",
                                           "write_buffer_bytes"};
  const Section& section = section_of("fasttree2");
  for (const std::string& key : costly) {
    const Field& field = field_of(section, key);
    double last = 0;
    for (int part = 0; part <= 20; ++part) {
      MachineConfig config = config_of("fasttree-2");
      ASSERT_TRUE(set_field(section, field, config, value_between(field, part / 20.0), "").ok());
      const double mm2 = area(config).mm2_65nm;
      EXPECT_GE(mm2, last * (1 - 1e-12)) << key << " step " << part;
      last = mm2;
    }
  }
}

TEST(Area, MoreOfTheseCostsMore) {
  const Section& section = section_of("paper");
  for (const std::string& key : kCostly) {
    const Field& field = field_of(section, key);
    MachineConfig less = config_of("paper-asic65"), more = less;
    ASSERT_TRUE(set_field(section, field, less, value_between(field, 0), "").ok());
    ASSERT_TRUE(set_field(section, field, more, value_between(field, 1), "").ok());
    EXPECT_LT(area(less).mm2_65nm, area(more).mm2_65nm) << key;
  }
}

}  // namespace
}  // namespace fasttree::model
