// SPDX-License-Identifier: Apache-2.0
// The binned builder. A cell's references are boxes; the span they fill is divided into 32 bins on
// each axis, and only the 33 borders are candidate planes, the two ends of the span among them.
// Counting where boxes begin and where they end ("min-max binning") gives both children's counts
// for all borders in one pass. Triangles that straddle the chosen plane are clipped to both sides,
// as in the exact builder.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "baseline/axis_bins.h"
#include "baseline/baseline.h"
#include "baseline/grow_tree.h"
#include "baseline/memory_budget.h"
#include "baseline/split_cost.h"
#include "baseline/triangle_clip.h"

namespace fasttree {
namespace baseline {
namespace {

/// A triangle and its box inside the cell.
struct Reference {
  Box3 box;
  std::uint32_t triangle = 0;
};

class BinnedSplitter {
 public:
  BinnedSplitter(const BaselineInput& input, MemoryBudget& budget)
      : input_(input), budget_(budget) {}

  Status prepare() {
    const std::size_t n = input_.mesh.triangle_count;
    if (Status status = budget_.reserve(references_, n); !status.ok()) return status;
    for (std::uint32_t t = 0; t < n; ++t) {
      Reference reference{{}, t};
      for (const Vec3& p : input_.mesh.triangle(t)) reference.box.include(p);
      references_.push_back(reference);
    }
    begins_.push_back(0);
    return {};
  }

  std::optional<Split> best_split(const OpenCell& cell) {
    const Reference* const first = references_.data() + begins_.back();
    const Reference* const last = references_.data() + references_.size();
    Box3 filled;
    for (const Reference* r = first; r != last; ++r) {
      filled.include(r->box.lo);
      filled.include(r->box.hi);
    }
    for (std::size_t a = 0; a < 3; ++a) bins_[a].place(filled.lo[a], filled.hi[a]);
    for (const Reference* r = first; r != last; ++r) {
      for (std::size_t a = 0; a < 3; ++a) bins_[a].add(r->box.lo[a], r->box.hi[a]);
    }

    std::optional<Split> best;
    double best_cost = leaf_cost(cell.count, input_.costs);
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const SplitCost cost(cell.box, axis, input_.costs);
      bins_[axis].sweep(cell.count, [&](std::size_t k, std::uint64_t lower, std::uint64_t upper) {
        const float position = bins_[axis].border(k);
        if (!(cell.box.lo[axis] < position && position < cell.box.hi[axis])) return;
        const double c = cost(position, lower, upper);
        if (c < best_cost) {
          best_cost = c;
          best = Split{axis, position, false, lower, upper, c};
        }
      });
    }
    return best;
  }

  Status partition(const OpenCell& cell, Split& split) {
    const std::size_t axis = split.axis;
    const std::size_t begin = begins_.back();
    const auto lower_count = static_cast<std::size_t>(split.lower_count);
    const auto upper_count = static_cast<std::size_t>(split.upper_count);
    if (Status status = budget_.reserve(lower_, lower_count); !status.ok()) return status;
    if (Status status = budget_.reserve(references_, begin + upper_count + lower_count);
        !status.ok()) {
      return status;
    }
    lower_.clear();
    std::size_t kept = begin;
    for (std::size_t i = begin; i < references_.size(); ++i) {
      const Reference reference = references_[i];
      const float lo = reference.box.lo[axis];
      const float hi = reference.box.hi[axis];
      const bool in_lower = goes_lower(lo, split.position);
      const bool in_upper = goes_upper(lo, hi, split.position);
      if (in_lower && in_upper) {
        const std::uint32_t t = reference.triangle;
        const CutBounds parts = cut_bounds(input_.mesh.triangle(t), cell.box, axis, split.position);
        if (parts.in_lower) lower_.push_back({parts.lower, t});
        if (parts.in_upper) references_[kept++] = {parts.upper, t};
      } else if (in_lower) {
        lower_.push_back(reference);
      } else {
        references_[kept++] = reference;
      }
    }
    references_.resize(kept);
    references_.insert(references_.end(), lower_.begin(), lower_.end());
    begins_.push_back(kept);
    split.lower_count = lower_.size();
    split.upper_count = kept - begin;
    return {};
  }

  void take(std::vector<std::uint32_t>& ids) {
    // Partition keeps the order, so ids ascend.
    for (std::size_t i = begins_.back(); i < references_.size(); ++i) {
      ids.push_back(references_[i].triangle);
    }
    references_.resize(begins_.back());
    begins_.pop_back();
  }

 private:
  const BaselineInput& input_;
  MemoryBudget& budget_;
  std::vector<Reference> references_;  ///< of all open cells
  std::vector<std::size_t> begins_;    ///< where each open cell's references begin
  std::vector<Reference> lower_;       ///< scratch of one split
  std::array<AxisBins, 3> bins_;
};

}  // namespace
}  // namespace baseline

Result<Tree> build_sah_binned(const BaselineInput& input) {
  return baseline::build_with<baseline::BinnedSplitter>(input, Profile::sah_binned, "sah_binned");
}

}  // namespace fasttree
