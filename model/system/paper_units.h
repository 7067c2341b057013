// SPDX-License-Identifier: Apache-2.0
// All units of the paper's machine with their ports, and which of them each step uses.
#pragma once

#include <memory>
#include <vector>

#include "model/config/paper_config.h"
#include "model/memory/byte_store.h"
#include "model/memory/memory.h"
#include "model/system/bus.h"
#include "model/units/bit_encoding.h"
#include "model/units/internal_node.h"
#include "model/units/leaf_node.h"
#include "model/units/mark_cache.h"
#include "model/units/morton_code.h"
#include "model/units/pair_writer.h"
#include "model/units/path_compression.h"
#include "model/units/prefix_sum.h"
#include "model/units/radix_sort.h"
#include "model/units/scene_bound.h"
#include "model/units/scene_reader.h"
#include "model/units/split_plane.h"

namespace fasttree::model {

/// Queues that end their cycle together.
class Clocks {
 public:
  template <typename T>
  void add(T& clocked) {
    list_.push_back({&clocked, [](void* c) { static_cast<T*>(c)->clock(); }});
  }
  void clock() const {
    for (const Entry& entry : list_) entry.clock(entry.clocked);
  }

 private:
  struct Entry {
    void* clocked;
    void (*clock)(void*);
  };
  std::vector<Entry> list_;
};

/// What is active in a phase of the run. All else stands still.
struct Phase {
  std::vector<Unit*> units;
  std::vector<BusPort*> ports;
  Clocks clocks;
};

struct PaperUnits {
  PaperUnits(const PaperConfig& config, double clock_mhz, Memory& memory, ByteStore& store);

  Bus bus;
  BusPort& scene_port;
  BusPort& pair_port;
  BusPort& sort_read_port;
  BusPort& sort_port;
  BusPort& leaf_read_port;
  BusPort& leaf_code_port;
  BusPort& leaf_row_port;
  BusPort& internal_read_port;
  BusPort& node_port;
  BusPort& clear_port;
  BusPort& cache_port;
  BusPort& climb_read_port;
  BusPort& link_port;

  SceneReader scene_reader;
  SceneBoundUnit lower_bound, upper_bound;
  std::vector<std::unique_ptr<MortonCodeUnit>> morton_code;
  PairWriter pair_writer;
  std::vector<std::unique_ptr<PrefixSumUnit>> prefix_sum;
  RadixSortUnit radix_sort;
  LeafNodeUnit leaf_node;
  SplitPlaneUnit split_plane;
  MarkCache mark_cache;
  BitEncodingUnit bit_encoding;
  InternalNodeUnit internal_node;
  PathCompressionUnit path_compression;

  std::vector<Unit*> all();

  Phase bound_phase();
  Phase code_phase();
  Phase sort_phase();
  Phase leaf_phase();
  Phase clear_phase();
  Phase internal_phase();
  Phase climb_phase();
};

}  // namespace fasttree::model
