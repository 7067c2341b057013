// SPDX-License-Identifier: Apache-2.0
// Generation: a triangle becomes its box of cells, and the box becomes one record for each bucket
// it touches. Cells are not gone over here: that is deferred until a lane holds the bucket.
#pragma once

#include "model/fasttree2/cell_levels.h"
#include "model/fasttree2/pipeline.h"
#include "model/fasttree2/record.h"
#include "model/fasttree2/registers.h"
#include "model/fasttree2/scene_reader.h"
#include "model/kernel/queue.h"
#include "model/kernel/unit.h"

namespace fasttree::model::ft2 {

/// A record and the bucket it goes to.
struct BucketRecord {
  std::uint32_t bucket = 0;
  Record record;
};

/// Six quantised corners of the box, several a cycle, and the records, one a cycle.
class MortonCode : public Unit {
 public:
  MortonCode(Registers& registers, Queue<SceneTriangle>& in, Queue<BucketRecord>& out);

  /// The grid is in the registers.
  void begin();
  /// Drops what is under way, and takes no more.
  void abandon();
  void tick() override;
  bool done() const override;
  std::string waits_for() const override;

  std::uint64_t references() const { return references_; }
  std::uint64_t records() const { return records_; }

 private:
  struct TriangleBox {
    std::uint32_t id = 0;
    CellBox box;
  };
  bool quantise();
  bool emit();

  Registers& r_;
  Queue<SceneTriangle>& in_;
  Queue<BucketRecord>& out_;
  Pipeline<TriangleBox> boxes_;
  std::uint32_t credit_ = 0;  ///< quantisations the units could have started, up to one triangle's
  BoxWalk walk_;
  std::uint32_t id_ = 0;
  std::uint32_t taken_ = 0;
  std::uint64_t references_ = 0;
  std::uint64_t records_ = 0;
  bool active_ = false;
};

}  // namespace fasttree::model::ft2
