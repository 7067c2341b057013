// SPDX-License-Identifier: Apache-2.0
// What the parts of the verifier share: counting facts, keeping the first that is broken, and a
// walk over the leaves' cells.
#pragma once

#include <array>
#include <cstdint>
#include <sstream>
#include <string>
#include <utility>

#include "fasttree/mesh.h"
#include "fasttree/tree.h"
#include "fasttree/verify.h"

namespace fasttree::verifier {

/// Text from pieces, floats with all their digits.
template <typename... Parts>
std::string text(const Parts&... parts) {
  std::ostringstream out;
  out.precision(9);
  (out << ... << parts);
  return std::move(out).str();
}

inline std::string text_of(Vec3 p) {
  return text("(", p.x, ", ", p.y, ", ", p.z, ")");
}
inline std::string text_of(const Box3& b) {
  return text_of(b.lo) + " to " + text_of(b.hi);
}

class Report {
 public:
  /// Counts a fact. A broken one is recorded with what `detail()` says, which is called only then.
  template <typename Detail>
  bool holds(bool fact, const char* invariant, const Detail& detail) {
    ++found_.checks;
    if (!fact) fail(invariant, detail());
    return fact;
  }

  void fail(const char* invariant, std::string detail) {
    found_.ok = false;
    found_.invariant = invariant;
    found_.detail = std::move(detail);
  }

  /// Facts that were checked elsewhere.
  void count(std::uint64_t checks) { found_.checks += checks; }

  const Verification& found() const { return found_; }

 private:
  Verification found_;
};

/// Calls leaf(index of the node, its cell) in order, for a tree that passed verify(tree).
template <typename Leaf>
void for_each_leaf(const Tree& tree, const Leaf& leaf) {
  struct Waiting {
    std::uint32_t axis;
    float split;
    Box3 cell;
  };
  std::array<Waiting, kMaxTreeDepth> waiting;
  std::size_t depth = 0;
  Box3 cell = tree.info().bounds;
  const std::span<const Node> nodes = tree.nodes();
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    if (!nodes[i].is_leaf()) {
      waiting[depth++] = {nodes[i].axis(), nodes[i].split(), cell};
      cell.hi[nodes[i].axis()] = nodes[i].split();
      continue;
    }
    leaf(i, cell);
    if (depth == 0) return;
    const Waiting& parent = waiting[--depth];
    cell = parent.cell;
    cell.lo[parent.axis] = parent.split;
  }
}

/// The parts of verify(tree, mesh), for trees and meshes that passed all before.
void check_grid_cells(const Tree& tree, const MeshView& mesh, Report& report);
void check_overlaps(const Tree& tree, const MeshView& mesh, Report& report);

}  // namespace fasttree::verifier
