// SPDX-License-Identifier: Apache-2.0
// What a comparison comes to: medians, the best way to trace, frames, ratios.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "contender.h"
#include "measure.h"

namespace fasttree::app {

/// Number of rays of each kind.
using RayCounts = std::array<std::size_t, kRayKinds.size()>;
RayCounts count_of(const MeasuredRays& rays);

/// One kind of rays, each way that a contender traces them.
struct KindFigures {
  std::size_t rays = 0;
  std::vector<double> ms;       ///< a way: the median of the rounds
  std::size_t best = 0;         ///< the fastest way
  std::size_t best_packet = 0;  ///< the fastest way but the first, which is single rays

  double mrays_per_s(std::size_t way) const;
};

/// A contender's medians.
struct Figures {
  std::string name;
  double build_ms = 0;   ///< all that has to happen before the first ray
  double layout_ms = 0;  ///< what of it is the tracer's layout; 0 for Embree
  /// What ratios of builds compare: profile realtime and Embree with all that their tracers need;
  /// the other profiles, which are kd-trees to be walked as they are, without the tracer's layout.
  double rated_ms = 0;
  std::array<KindFigures, kRayKinds.size()> kinds;
  /// A picture with shadows of a scene that moved: the build, and the primary and the shadow rays
  /// each the fastest way.
  double frame_ms = 0;

  const KindFigures& of(RayKind kind) const { return kinds[static_cast<std::size_t>(kind)]; }
};
Figures figures_of(const Record& record, const RayCounts& counts);

/// How many times as fast a tree is as an Embree: more than 1 where the tree is faster. Nothing
/// where there are no such rays.
struct Ratios {
  std::string against;  ///< the Embree's name
  std::optional<double> build, frame;
  std::array<std::optional<double>, kRayKinds.size()> single;
  std::array<std::optional<double>, kRayKinds.size()> packet;  ///< the fastest width of each
};
Ratios ratios_of(const Figures& tree, const Figures& embree);

/// One tree head to head with Embree.
struct HeadToHead {
  Figures tree;
  std::vector<Ratios> each;  ///< one an Embree that took part; may be empty
  /// Against whichever Embree is fastest at it.
  std::optional<double> build, frame;
  std::string build_against, frame_against;

  /// Of "embree-medium"; null where it took no part.
  const Ratios* find(const std::string& name) const;
};
HeadToHead head_to_head(const Figures& tree, const std::vector<Figures>& embrees);

}  // namespace fasttree::app
