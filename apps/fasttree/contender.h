// SPDX-License-Identifier: Apache-2.0
// Who takes part in a comparison: the builders' trees with their tracer, and Embree.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fasttree/build.h"
#include "fasttree/quality.h"
#include "fasttree/trace.h"
#include "measure.h"

namespace fasttree::app {

/// Results of one kind of rays, to be compared with those of somebody else.
struct Traced {
  Measured<Hit> hits;               ///< primary and diffuse rays
  std::vector<std::uint8_t> flags;  ///< shadow rays
};

/// What is measured of a kd-tree only.
struct TreeRecord {
  Profile profile = Profile::realtime;
  std::vector<double> layout_ms;  ///< a counted round: what of the build is the tracer's
  int depth = 0;
  std::uint64_t hash = 0;
  Quality quality;
  std::array<TraceCounters, kRayKinds.size()> counters;
};

/// What is measured of a contender. All times have one entry a counted round.
struct Record {
  std::string name;
  std::vector<std::string> ways;  ///< of tracing; the first is single rays, the others packets
  std::vector<double> build_ms;   ///< all that has to happen before the first ray
  std::array<std::vector<std::vector<double>>, kRayKinds.size()> trace_ms;  ///< [kind][way][round]

  std::optional<TreeRecord> tree;  ///< nothing for Embree

  /// Of Embree only: rays of each kind that hit here and miss in the trees, or the reverse.
  std::array<std::uint64_t, kRayKinds.size()> other_outcomes{};
};

class Contender {
 public:
  Contender(std::string name, std::vector<std::string> ways);
  virtual ~Contender() = default;
  Contender(const Contender&) = delete;
  Contender& operator=(const Contender&) = delete;

  /// Builds anew, in the memory of the last build. Milliseconds on the wall clock.
  virtual double build(const MeshView& mesh) = 0;

  /// Traces all rays one way, on the threads of the calling arena. Milliseconds on the wall clock.
  /// `traced` is where results go, though some arrive there only with read().
  virtual double trace(RayKind kind, std::size_t way, std::span<const Ray> rays,
                       Traced& traced) = 0;

  /// Sees to it that `traced` holds the results of the last trace().
  virtual void read(RayKind, Traced&) {}

  bool is_tree() const { return record.tree.has_value(); }

  Record record;
};

/// A builder, its tree and the library's tracer, all kept from round to round.
class TreeContender : public Contender {
 public:
  TreeContender(std::string name, BuildSettings settings);

  double build(const MeshView& mesh) override;
  double trace(RayKind kind, std::size_t way, std::span<const Ray> rays, Traced& traced) override;

  /// Fills in the figures that are the same each round.
  void study(const MeasuredRays& rays);

  const Tree& tree() const { return tree_; }
  const Tracer& tracer() const { return tracer_; }
  double layout_ms() const { return layout_ms_; }

 private:
  BuildSettings settings_;
  Builder builder_;
  Tree tree_;
  Tracer tracer_;
  double layout_ms_ = 0;
};

/// What --builders may name.
std::vector<std::string> contender_names();

/// The names in "a,b,c", each once, trees before Embree; "embree" stands for both of its build
/// qualities. Throws Failure for names that are not there, and where there is no tree among them.
std::vector<std::string> parse_contenders(const std::string& list);

/// Who is compared without --builders: the trees given (or realtime's and the paper's) and Embree,
/// where the program was built with it.
std::vector<std::string> default_contenders(std::optional<Profile> profile);

/// The contenders of these names. `settings` has what all builders share; `depth` is for the
/// builders that take one.
std::vector<std::unique_ptr<Contender>> make_contenders(const std::vector<std::string>& names,
                                                        const BuildSettings& settings, int depth);

}  // namespace fasttree::app
