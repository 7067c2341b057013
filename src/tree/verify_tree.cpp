// SPDX-License-Identifier: Apache-2.0
// What a tree can be held to without its mesh. Made for any bytes: nodes are read in the order in
// which they lie, and links are compared with where they have to point, never followed.
#include <algorithm>
#include <bit>
#include <cmath>

#include "fasttree/verify.h"
#include "grid/grid.h"
#include "tree/verify_report.h"

namespace fasttree {
namespace {

using verifier::Report;
using verifier::text;

// The least index of a plane at or above `position`, or 2^bits: planes of an axis do not fall.
std::uint32_t first_plane_at(const Grid& grid, std::size_t axis, float position) {
  std::uint32_t below = 1;
  std::uint32_t above = 1u << grid.bits()[axis];
  while (below < above) {
    const std::uint32_t middle = below + (above - below) / 2;
    if (grid.plane(axis, middle) >= position) {
      above = middle;
    } else {
      below = middle + 1;
    }
  }
  return above;
}

class TreeChecker {
 public:
  explicit TreeChecker(const Tree& tree)
      : info_(tree.info()), nodes_(tree.nodes()), ids_(tree.ids()) {}

  Verification check() {
    if (check_info() && check_grid() && check_nodes()) check_coverage();
    return report_.found();
  }

 private:
  // An inner node whose upper child has not come yet.
  struct Open {
    std::uint32_t position;
    std::uint32_t depth;
    Box3 cell;
  };

  bool gridded() const { return info_.profile == Profile::paper; }

  bool check_info() {
    const auto profile = static_cast<unsigned>(info_.profile);
    const auto axes = static_cast<unsigned>(info_.axes);
    return report_.holds(profile <= static_cast<unsigned>(kLastProfile), "profile", [&] {
      return text("profile ", profile, " is not known");
    }) && report_.holds(axes <= static_cast<unsigned>(AxisSchedule::longest), "axis-schedule", [&] {
      return text("axis schedule ", axes, " is not known");
    }) && report_.holds(info_.triangle_count <= kMaxTriangles, "triangle-count", [&] {
      return text(info_.triangle_count, " triangles; at most ", kMaxTriangles);
    }) && report_.holds(nodes_.size() % 2 == 1 && nodes_.size() < kMaxNodes, "node-count", [&] {
      return text(nodes_.size(), " nodes; an odd number under ", kMaxNodes, " is needed");
    }) && report_.holds(bounds_are_sound(), "bounds", [&] {
      return text(verifier::text_of(info_.bounds), " of ", info_.triangle_count,
                  " triangles; finite, lower before upper, no minus zero, all zero for an "
                  "empty mesh");
    });
  }

  bool bounds_are_sound() const {
    const auto& [lo, hi] = info_.bounds;
    for (std::size_t a = 0; a < 3; ++a) {
      if (!std::isfinite(hi[a] - lo[a]) || !(lo[a] <= hi[a])) return false;
      for (const float v : {lo[a], hi[a]}) {
        if (v == 0.0f && std::signbit(v)) return false;
        if (info_.triangle_count == 0 && v != 0.0f) return false;
      }
    }
    return true;
  }

  bool check_grid() {
    if (gridded()) grid_ = Grid(info_.bounds, info_.axes, info_.depth);
    const auto shape = [](int depth, const std::array<std::uint8_t, 3>& bits) {
      return text("depth ", depth, " with ", int{bits[0]}, "+", int{bits[1]}, "+", int{bits[2]},
                  " bits");
    };
    return report_.holds(info_.depth == grid_.depth() && info_.bits == grid_.bits(), "grid", [&] {
      return shape(info_.depth, info_.bits) + "; these bounds, axes and profile make " +
             shape(grid_.depth(), grid_.bits());
    });
  }

  bool check_nodes() {
    depth_limit_ = gridded() ? info_.depth : kMaxTreeDepth;
    cell_ = info_.bounds;
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
      if (!(nodes_[i].is_leaf() ? check_leaf(i) && go_on_after_leaf(i) : check_inner(i))) {
        return false;
      }
    }
    return report_.holds(open_.empty(), "every-node-once", [&] {
      return text("node ", open_.back().position, " has its upper child at ",
                  nodes_[open_.back().position].upper(),
                  ", which is a node of another parent: the nodes end inside its lower "
                  "subtree");
    }) && report_.holds(next_id_ == ids_.size(), "leaf-order", [&] {
      return text("the leaves hold ", next_id_, " of ", ids_.size(), " triangle ids");
    });
  }

  bool check_inner(std::uint32_t i) {
    const Node& node = nodes_[i];
    const std::uint32_t axis = node.axis();
    const float split = node.split();
    if (!report_.holds(node.upper() > i + 1 && node.upper() < nodes_.size(), "upper-child-range",
                       [&] {
                         return text("node ", i, " has its upper child at ", node.upper(),
                                     "; allowed is ", i + 2, " to ", nodes_.size() - 1);
                       }) ||
        !report_.holds(depth_ < depth_limit_, "depth",
                       [&] {
                         return text("node ", i, " has ", depth_, " inner nodes above it; at most ",
                                     depth_limit_, " may be above a leaf");
                       }) ||
        !report_.holds(std::isfinite(split), "split-finite",
                       [&] { return text("node ", i, " splits at ", split); }) ||
        !report_.holds(cell_.lo[axis] <= split && split <= cell_.hi[axis], "split-in-cell", [&] {
          return text("node ", i, " splits axis ", axis, " at ", split, ", outside its cell ",
                      cell_.lo[axis], " to ", cell_.hi[axis]);
        })) {
      return false;
    }
    if (gridded()) {
      const std::uint32_t k = first_plane_at(grid_, axis, split);
      if (!report_.holds(k < 1u << info_.bits[axis] && grid_.plane(axis, k) == split,
                         "split-on-plane", [&] {
                           return text("node ", i, " splits axis ", axis, " at ", split,
                                       ", which is not a plane of the grid");
                         })) {
        return false;
      }
    }
    open_.push_back({i, depth_, cell_});
    ++depth_;
    cell_.hi[axis] = split;
    return true;
  }

  bool check_leaf(std::uint32_t i) {
    const Node& node = nodes_[i];
    const std::uint64_t first = node.first();
    if (!report_.holds(first <= ids_.size() && node.count() <= ids_.size() - first, "leaf-range",
                       [&] {
                         return text("leaf ", i, " is the run of ", node.count(), " from ", first,
                                     ", outside the ", ids_.size(), " triangle ids");
                       }) ||
        !report_.holds(first == next_id_, "leaf-order",
                       [&] {
                         return text("leaf ", i, " begins at ", first,
                                     ", but the leaves before it end at ", next_id_);
                       }) ||
        !report_.holds(
            !gridded() || (node.count() > 0) == (info_.triangle_count > 0), "leaf-occupied", [&] {
              return text("leaf ", i, " holds ", node.count(), " of ", info_.triangle_count,
                          " triangles; a leaf of the grid is a cell with triangles, "
                          "and only an empty mesh has one without");
            })) {
      return false;
    }
    next_id_ += node.count();
    const std::span<const std::uint32_t> run = ids_.subspan(first, node.count());
    for (std::size_t k = 0; k < run.size(); ++k) {
      if (!report_.holds(run[k] < info_.triangle_count, "triangle-id-range",
                         [&] {
                           return text("leaf ", i, " refers to triangle ", run[k], " of ",
                                       info_.triangle_count);
                         }) ||
          !report_.holds(k == 0 || run[k - 1] < run[k], "reference-order", [&] {
            return text("leaf ", i, " has triangle ", run[k], " after ", run[k - 1],
                        "; ids have to ascend");
          })) {
        return false;
      }
    }
    return true;
  }

  // In pre-order a leaf ends the lower subtree of the innermost open node, whose upper child is the
  // node behind the leaf, or it ends the tree.
  bool go_on_after_leaf(std::uint32_t i) {
    const std::uint32_t next = i + 1;
    if (next == nodes_.size()) return true;
    if (!report_.holds(!open_.empty(), "every-node-once", [&] {
          return text("the tree ends with node ", i, ", but there are ", nodes_.size(), " nodes");
        })) {
      return false;
    }
    const std::uint32_t parent = open_.back().position;
    depth_ = open_.back().depth + 1;
    cell_ = open_.back().cell;
    cell_.lo[nodes_[parent].axis()] = nodes_[parent].split();
    open_.pop_back();
    return report_.holds(nodes_[parent].upper() == next, "pre-order", [&] {
      return text("node ", parent, " has its upper child at ", nodes_[parent].upper(),
                  ", but its lower subtree ends before ", next);
    });
  }

  void check_coverage() {
    // First what bounds the memory by that of the tree.
    if (!report_.holds(info_.triangle_count <= ids_.size(), "triangle-coverage", [&] {
          return text(ids_.size(), " references cannot cover ", info_.triangle_count, " triangles");
        })) {
      return;
    }
    std::vector<bool> seen(info_.triangle_count);
    for (const std::uint32_t id : ids_) seen[id] = true;
    report_.count(seen.size());
    const auto missing = std::find(seen.begin(), seen.end(), false);
    if (missing != seen.end()) {
      report_.fail("triangle-coverage",
                   text("triangle ", missing - seen.begin(), " is in no leaf"));
    }
  }

  const TreeInfo& info_;
  std::span<const Node> nodes_;
  std::span<const std::uint32_t> ids_;
  Grid grid_;  // of depth 0 where the profile has none
  Report report_;

  std::uint32_t depth_limit_ = 0;
  std::vector<Open> open_;   // innermost last; never longer than the depth limit
  std::uint32_t depth_ = 0;  // inner nodes above the node that is read next
  Box3 cell_;                // of that node
  std::uint64_t next_id_ = 0;
};

}  // namespace

Verification verify(const Tree& tree) {
  return TreeChecker(tree).check();
}

}  // namespace fasttree
