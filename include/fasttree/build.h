// SPDX-License-Identifier: Apache-2.0
// Building trees: one object, any profile, memory kept from build to build.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "fasttree/mesh.h"
#include "fasttree/quality.h"
#include "fasttree/status.h"
#include "fasttree/tree.h"

namespace fasttree {

/// Called now and then during long work, from one thread at a time: the stage's name (static) and
/// how far the whole work is, 0 to 1. Return false to cancel.
using ProgressCallback = std::function<bool(const char* stage, double fraction)>;

/// Which code runs the vectorised stages. Both write the same bytes.
enum class Simd : std::uint8_t {
  scalar = 0,  ///< plain C++
  widest = 1,  ///< the widest instruction set this processor has, chosen at run time
};

/// How a profile is carried out. All of them write the same bytes.
enum class Implementation : std::uint8_t {
  fast = 0,       ///< parallel, vectorised
  reference = 1,  ///< the definition literally, scalar, one thread (paper and realtime)
};

inline constexpr int kAutoDepth = -1;

/// How to build. Every field has the default a newcomer wants.
struct BuildSettings {
  Profile profile = Profile::realtime;

  /// Profile paper only: realtime always has `longest`.
  AxisSchedule axes = AxisSchedule::cyclic;

  /// D, the levels of the grid (0 to 30), or kAutoDepth for the rule in docs/grid.md. A grid with
  /// fewer levels than asked (dead axes; 15 bits an axis) uses all it has. Profile realtime: of its
  /// top grid, with the rule in docs/realtime.md. The other profiles have no grid.
  int depth = kAutoDepth;

  /// k of the rule: D is at most ceil(log2 N) + k. Profile paper only.
  int extra_depth = 1;

  /// The rule keeps M(D) at or under this many references a triangle. Profile paper only.
  double max_growth = 6.0;

  /// Bytes the builder may hold at once, its result included; 0: no limit. Checked against M(D)
  /// before anything that grows with M is allocated. Baseline profiles check as they grow.
  std::uint64_t memory_limit_bytes = 0;

  /// Leaves of the surface-area-heuristic profiles.
  SahCosts sah_costs;

  Implementation implementation = Implementation::fast;
  Simd simd = Simd::widest;

  ProgressCallback progress;
};

/// One named, timed part of a build.
struct StageTime {
  const char* stage = "";
  double ms = 0;
};

/// What the last build did.
struct BuildStats {
  double build_ms = 0;
  std::vector<StageTime> stages;    ///< in order of execution
  std::uint64_t triangles = 0;      ///< N
  std::uint64_t references = 0;     ///< M
  std::uint64_t planned_bytes = 0;  ///< memory the plan asked for, the result included
};

/// Builds trees, and keeps its working memory for the next build. Not thread-safe: one builder a
/// thread. A build runs on the threads of the task arena it is called in (tbb::task_arena) and
/// changes nothing process-wide.
class Builder {
 public:
  Builder();
  ~Builder();
  Builder(Builder&&) noexcept;
  Builder& operator=(Builder&&) noexcept;

  /// Builds a tree for the mesh. invalid_argument: settings; bad_input: the mesh (a bad index, a
  /// coordinate that is not finite, an extent that overflows; the message names the triangle);
  /// resource_limit: M(D) or memory over a limit; cancelled: by the callback.
  Result<Tree> build(const MeshView& mesh, const BuildSettings& settings = {});

  /// The same into an existing tree, whose memory is reused. On failure the tree is the empty one.
  Status build(const MeshView& mesh, const BuildSettings& settings, Tree& tree);

  const BuildStats& stats() const;

  /// Frees the working memory kept from build to build.
  void shrink();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fasttree
