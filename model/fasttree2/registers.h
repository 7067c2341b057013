// SPDX-License-Identifier: Apache-2.0
// What the control unit and the host hand to all units: where things lie, the grid, the formats,
// and the place where a unit reports that what it reads cannot be.
#pragma once

#include <cstdint>
#include <string>

#include "model/config/fasttree2_config.h"
#include "model/fasttree2/cell_levels.h"
#include "model/fasttree2/record.h"
#include "model/kernel/quantities.h"

namespace fasttree::model::ft2 {

/// Regions of off-chip memory. Each begins at a multiple of 4096.
struct Layout {
  Address scene;   ///< nine binary32 a triangle
  Address chunks;  ///< of records
  std::uint64_t chunk_count = 0;
  Address spill;  ///< free chunks beyond those kept on chip
  Address nodes;  ///< filled from its end
  std::uint64_t node_slots = 0;
  Address ids;
  std::uint64_t id_slots = 0;
  std::uint64_t bytes = 0;  ///< all of it
};

/// Deliberate damage, so that tests can show that it is noticed.
struct Faults {
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  std::uint64_t drop_record = kNone;  ///< this record of the first partition never reaches a bucket
  std::uint64_t wrong_link =
      kNone;  ///< this link between chunks names the chunk after the right one
  std::uint64_t lost_beat = kNone;  ///< the scene's reader never asks for this access
};

struct Registers {
  FastTree2Config config;
  Layout layout;
  Faults faults;
  std::uint32_t triangles = 0;
  CellLevels levels;    ///< from the bounds and D
  int bucket_bits = 0;  ///< of the first partition
  RecordFormat records;
  ChunkFormat chunks;
  std::uint64_t references = 0;  ///< M, counted while generating
  std::uint64_t cycle = 0;

  std::string failure;  ///< the first thing that cannot be, in words
  void fail(const std::string& what) {
    if (failure.empty()) failure = what;
  }
};

}  // namespace fasttree::model::ft2
