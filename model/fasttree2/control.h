// SPDX-License-Identifier: Apache-2.0
// The units of the machine, how they are connected, and the control that takes them through the
// stages of a build.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "model/fasttree2/bucket_lane.h"
#include "model/fasttree2/bucket_walker.h"
#include "model/fasttree2/chunk_pool.h"
#include "model/fasttree2/dma.h"
#include "model/fasttree2/host.h"
#include "model/fasttree2/machine.h"
#include "model/fasttree2/morton_code.h"
#include "model/fasttree2/node_emitter.h"
#include "model/fasttree2/registers.h"
#include "model/fasttree2/scene_bound.h"
#include "model/fasttree2/scene_reader.h"
#include "model/fasttree2/timeline.h"
#include "model/fasttree2/write_combiner.h"

namespace fasttree::model::ft2 {

class Machine {
 public:
  Machine(const HostPlan& plan, std::uint32_t triangles, const FastTree2Config& config,
          const Extras& extras, double clock_mhz, Memory& memory, ByteStore& store,
          const SimulationOptions& options);

  /// The whole build. Afterwards the tree is in memory, its root in root_slot().
  Status build();

  const Registers& registers() const { return r_; }
  std::uint64_t root_slot() const { return emitter_.root_slot(); }
  /// Stages, units and timeline; once, after build().
  void report(SimulationResult& result);
  Figures figures() const;

 private:
  Status scene_bound();
  Status morton_code(const Box3& bounds, bool check, bool& right);
  Status sort_and_emit();

  void begin_stage(const char* name);
  void end_stage();
  void set_grid(const Box3& bounds);
  /// One cycle. Not ok: stuck, cancelled, over a limit, or a unit has failed.
  Status cycle(double fraction);
  Status look_round(double fraction);
  void dispatch();
  std::string who_waits() const;

  const SimulationOptions& options_;
  const HostPlan& plan_;
  Registers r_;
  Memory& memory_;
  Dma dma_;
  Queue<SceneTriangle> to_bounds_, to_codes_;
  Queue<BucketRecord> to_first_, to_second_;
  Queue<BucketTask> ready_;
  BucketOrder order_;
  ChunkPool pool_;
  SceneReader reader_;
  SceneBound bound_;
  MortonCode codes_;
  WriteCombiner first_, second_;
  BucketWalker walker_;
  std::vector<std::unique_ptr<BucketLane>> lanes_;
  NodeEmitter emitter_;
  std::vector<Unit*> units_;
  Timeline timeline_;

  Box3 given_;
  bool sorting_ = false;
  std::size_t next_lane_ = 0;
  std::uint32_t generations_ = 0;
  std::vector<StageRecord> stages_;
  std::vector<std::uint64_t> moved_;  ///< bytes of every port at the start of the stage
  std::uint64_t last_progress_ = 0;   ///< cycle
  std::uint64_t last_busy_ = 0;       ///< cycles of all units together
};

}  // namespace fasttree::model::ft2
