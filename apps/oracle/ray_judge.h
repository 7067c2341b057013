// SPDX-License-Identifier: Apache-2.0
// Rays through a tree against an oracle, one verdict a ray.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fasttree/build.h"
#include "fasttree/mesh.h"
#include "fasttree/status.h"
#include "fasttree/trace.h"
#include "fasttree/tree.h"
#include "oracle/ray_sets.h"

namespace fasttree::oracle {

/// Who judges.
enum class Oracle : std::uint8_t {
  brute,   ///< every triangle for every ray: t to the bit and the triangle
  embree,  ///< Embree; brute force where the two differ
};

const char* to_string(Oracle oracle);

struct JudgeSettings {
  Oracle oracle = Oracle::brute;
  std::uint64_t rays = 10'000;  ///< over all sets, split evenly
  std::uint64_t seed = 1;
  ProgressCallback progress;
};

/// What happened to the rays of one set.
struct SetReport {
  RaySet set{};
  std::uint64_t rays = 0;
  std::uint64_t hits = 0;
  std::uint64_t brute_checked = 0;  ///< rays for which every triangle was tested
  std::uint64_t settled = 0;        ///< Embree said otherwise, brute force agreed with the tree
  std::uint64_t wrong = 0;          ///< the tree is wrong
};

struct RayReport {
  Oracle oracle = Oracle::brute;
  std::vector<SetReport> sets;
  std::string first_wrong;  ///< the wrong ray with the lowest set and number, for a person

  SetReport total() const;
  bool ok() const { return total().wrong == 0; }
};

/// Traces rays of every set through the tree, one by one and in batches, closest and any hit, and
/// judges each. Runs on the threads of the calling task arena.
///
/// Oracle::brute: t to the bit, u, v and the triangle equal brute force. Oracle::embree: the hit is
/// one of its triangle to the bit; the triangle that Embree names is not nearer; and hit or miss
/// and t (within a relative 1e-4 and 1e-5 of the scene's size) agree with Embree, or else brute
/// force on that ray agrees with the tree to the bit.
///
/// cancelled: by the callback; invalid_argument: Embree asked for and not available.
Result<RayReport> judge_rays(const MeshView& mesh, const Tree& tree, const Tracer& tracer,
                             const JudgeSettings& settings);

}  // namespace fasttree::oracle
