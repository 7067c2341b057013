// SPDX-License-Identifier: Apache-2.0
// The loop both yardstick builders share: cells are split depth first, lower child first, so that
// nodes and leaves come out in the tree's order as they are made.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "baseline/baseline.h"
#include "baseline/memory_budget.h"
#include "baseline/split_cost.h"

namespace fasttree::baseline {

/// A cell that is not a node yet.
struct OpenCell {
  static constexpr std::uint32_t kRoot = 0xffffffffu;

  Box3 box;
  std::uint64_t count = 0;  ///< references
  std::uint32_t depth = 0;
  std::uint32_t upper_child_of = kRoot;  ///< parent whose link is still open; kRoot: none
  double work = 1.0;                     ///< its share of the whole, for progress
};

/// Levels a tree may have: 8 + 1.3 log2 N, as pbrt and Havran's thesis choose, at most 64.
inline std::uint32_t depth_bound(std::uint64_t triangles) {
  const auto log2 = static_cast<std::uint32_t>(triangles <= 1 ? 0 : std::bit_width(triangles - 1));
  return std::min(8 + 13 * log2 / 10, 64u);
}

/// References a tree may have. Real scenes stay under 10 a triangle; this bounds inputs made to
/// explode, whose remaining cells become leaves.
inline std::uint64_t reference_bound(std::uint64_t triangles) {
  return std::min(32 * triangles + 4096, std::uint64_t{0xffffffffu});
}

/// Reports progress about every hundred thousand references looked at.
class ProgressMeter {
 public:
  ProgressMeter(const char* stage, const ProgressCallback& callback)
      : stage_(stage), callback_(callback) {}

  /// `looked_at` references since the last call, `fraction` of the whole done. False: cancelled.
  bool advance(std::uint64_t looked_at, double fraction) {
    if (!callback_) return true;
    pending_ += looked_at;
    if (pending_ < 100'000) return true;
    return report(fraction);
  }

  bool report(double fraction) {
    pending_ = 0;
    return !callback_ || callback_(stage_, std::clamp(fraction, 0.0, 1.0));
  }

 private:
  const char* stage_;
  const ProgressCallback& callback_;
  std::uint64_t pending_ = 0;
};

/// Grows a tree with a splitter, which keeps the references of all open cells on a stack, those of
/// the cell to be split next on top:
///   Status prepare()                       puts all triangles on the stack, as the root's
///   std::optional<Split> best_split(cell)  of the top; none: a leaf is cheaper, or nothing can be
///   cut Status partition(cell, Split&)         replaces the top by the upper child's references
///   with the
///                                          lower's over them; corrects the split's counts
///   void take(std::vector<uint32_t>& ids)  takes the top off, appending its ids in ascending order
template <typename Splitter>
Status grow(Splitter& splitter, const BaselineInput& input, const char* stage, MemoryBudget& budget,
            std::vector<Node>& nodes, std::vector<std::uint32_t>& ids) {
  const std::uint32_t triangles = input.mesh.triangle_count;
  const std::uint32_t max_depth = depth_bound(triangles);
  const std::uint64_t max_references = reference_bound(triangles);
  const Status cancelled(StatusCode::cancelled,
                         std::string(stage) + ": cancelled by the progress callback");

  ProgressMeter progress(stage, input.progress);
  if (!progress.report(0.0)) return cancelled;
  if (Status status = splitter.prepare(); !status.ok()) return status;

  std::uint64_t references = triangles;  // of leaves and open cells together
  double done = 0.0;
  OpenCell root;
  root.box = input.bounds;
  root.count = triangles;
  std::vector<OpenCell> open{root};
  while (!open.empty()) {
    const OpenCell cell = open.back();
    open.pop_back();
    if (!progress.advance(cell.count + 1, done)) return cancelled;

    if (nodes.size() >= kMaxNodes) {
      return {StatusCode::resource_limit,
              std::string(stage) + ": the tree has more than " + std::to_string(kMaxNodes) +
                  " nodes; raise the traversal cost or choose profile paper"};
    }
    if (Status status = budget.reserve(nodes, nodes.size() + 1); !status.ok()) return status;
    const auto index = static_cast<std::uint32_t>(nodes.size());
    if (cell.upper_child_of != OpenCell::kRoot) {
      const Node parent = nodes[cell.upper_child_of];
      nodes[cell.upper_child_of] = Node::inner(parent.axis(), parent.split(), index);
    }

    std::optional<Split> split;
    if (cell.count > 0 && cell.depth < max_depth && half_area(cell.box) > 0) {
      split = splitter.best_split(cell);
    }
    if (split &&
        references - cell.count + split->lower_count + split->upper_count > max_references) {
      split.reset();
    }

    if (!split) {
      if (Status status = budget.reserve(ids, ids.size() + cell.count); !status.ok()) return status;
      nodes.push_back(Node::leaf(static_cast<std::uint32_t>(ids.size()),
                                 static_cast<std::uint32_t>(cell.count)));
      splitter.take(ids);
      done += cell.work;
      continue;
    }

    if (Status status = splitter.partition(cell, *split); !status.ok()) return status;
    references += split->lower_count + split->upper_count - cell.count;
    nodes.push_back(Node::inner(split->axis, split->position, 0));

    OpenCell lower = cell;
    OpenCell upper = cell;
    lower.box.hi[split->axis] = split->position;
    upper.box.lo[split->axis] = split->position;
    lower.count = split->lower_count;
    upper.count = split->upper_count;
    lower.depth = upper.depth = cell.depth + 1;
    lower.upper_child_of = OpenCell::kRoot;
    upper.upper_child_of = index;
    const auto sum = static_cast<double>(lower.count + upper.count);
    lower.work = cell.work * static_cast<double>(lower.count) / sum;
    upper.work = cell.work * static_cast<double>(upper.count) / sum;
    open.push_back(upper);
    open.push_back(lower);
  }
  return progress.report(1.0) ? Status() : cancelled;
}

/// Checks the costs, grows the tree, and turns a failed allocation into a status.
template <typename Splitter>
Result<Tree> build_with(const BaselineInput& input, Profile profile, const char* stage) {
  const auto valid = [](double cost) { return std::isfinite(cost) && cost >= 0; };
  if (!valid(input.costs.traversal) || !valid(input.costs.intersection)) {
    return Status(StatusCode::invalid_argument,
                  std::string(stage) +
                      ": the costs of the surface-area heuristic have to be finite "
                      "and not negative");
  }
  try {
    MemoryBudget budget(stage, input.memory_limit_bytes);
    Splitter splitter(input, budget);
    std::vector<Node> nodes;
    std::vector<std::uint32_t> ids;
    if (Status status = grow(splitter, input, stage, budget, nodes, ids); !status.ok()) {
      return status;
    }
    TreeInfo info;
    info.profile = profile;
    info.triangle_count = input.mesh.triangle_count;
    if (info.triangle_count > 0) info.bounds = input.bounds;
    return Tree(info, std::move(nodes), std::move(ids));
  } catch (const std::bad_alloc&) {
  } catch (const std::length_error&) {
  }
  return Status(StatusCode::resource_limit,
                std::string(stage) +
                    ": the machine has not enough memory for this mesh; choose "
                    "profile paper, or build fewer triangles");
}

}  // namespace fasttree::baseline
