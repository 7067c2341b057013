// SPDX-License-Identifier: Apache-2.0
// Profile paper against its mesh: the tree has to be the one that the definition gives, node for
// node. The references are made again from the grid and sorted; then
//   - leaf i has to be the i-th run of equal codes (leaf-cells),
//   - the inner node between leaves i and i + 1 has to split where their cells part (split-plane),
//   - a node has to part its leaves at a deeper level than its parent (path-compression).
// A binary tree over given leaves whose levels rise downwards is unique, so nothing is left open.
// None of this uses links of the device image, bitmaps or climbing.
#include <tbb/parallel_sort.h>

#include <bit>
#include <vector>

#include "grid/grid.h"
#include "tree/verify_report.h"

namespace fasttree::verifier {
namespace {

// A reference as one number that sorts by code, then by triangle.
using Reference = std::uint64_t;

Reference make_reference(std::uint32_t code, std::uint32_t triangle) {
  return std::uint64_t{code} << 32 | triangle;
}
std::uint32_t code_of(Reference r) {
  return static_cast<std::uint32_t>(r >> 32);
}
std::uint32_t triangle_of(Reference r) {
  return static_cast<std::uint32_t>(r);
}

std::vector<Reference> sorted_references(const Grid& grid, const MeshView& mesh,
                                         std::size_t count) {
  std::vector<Reference> references;
  references.reserve(count);
  for (std::uint32_t t = 0; t < mesh.triangle_count; ++t) {
    const auto [lo, hi] = grid.cells_of(mesh.triangle(t));
    for (std::uint32_t z = lo[2]; z <= hi[2]; ++z) {
      for (std::uint32_t y = lo[1]; y <= hi[1]; ++y) {
        for (std::uint32_t x = lo[0]; x <= hi[0]; ++x) {
          references.push_back(make_reference(grid.morton_code({x, y, z}), t));
        }
      }
    }
  }
  tbb::parallel_sort(references.begin(), references.end());
  return references;
}

class GridChecker {
 public:
  GridChecker(const Tree& tree, const MeshView& mesh, Report& report)
      : tree_(tree),
        mesh_(mesh),
        report_(report),
        grid_(tree.info().bounds, tree.info().axes, tree.info().depth) {}

  void check() {
    if (!check_count()) return;
    references_ = sorted_references(grid_, mesh_, tree_.ids().size());
    check_leaves() && check_splits() && check_levels();
  }

 private:
  // Before the references are made: this bounds their memory by the tree's own.
  bool check_count() {
    std::uint64_t count = 0;
    for (std::uint32_t t = 0; t < mesh_.triangle_count; ++t) {
      count += grid_.cells_of(mesh_.triangle(t)).count();
    }
    return report_.holds(count == tree_.ids().size(), "reference-count", [&] {
      return text(tree_.ids().size(), " references; the grid makes ", count, " of this mesh");
    });
  }

  std::string cell_text(std::uint32_t code) const {
    const Cell cell = grid_.cell_of(code);
    return text("cell (", cell[0], ", ", cell[1], ", ", cell[2], ")");
  }

  bool check_leaves() {
    const std::span<const Node> nodes = tree_.nodes();
    const std::span<const std::uint32_t> ids = tree_.ids();
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
      if (!nodes[i].is_leaf() || nodes[i].count() == 0) continue;
      const std::size_t first = nodes[i].first();
      const std::size_t end = first + nodes[i].count();
      const std::uint32_t code = code_of(references_[first]);
      for (std::size_t r = first; r < end; ++r) {
        const Reference expected = references_[r];
        if (!report_.holds(expected == make_reference(code, ids[r]), "leaf-cells", [&] {
              return text("leaf ", i, " of ", cell_text(code), " has triangle ", ids[r],
                          " where triangle ", triangle_of(expected), " of ",
                          cell_text(code_of(expected)), " belongs");
            })) {
          return false;
        }
      }
      if (!report_.holds(
              end == references_.size() || code_of(references_[end]) != code, "leaf-cells", [&] {
                return text("leaf ", i, " of ", cell_text(code), " ends before triangle ",
                            triangle_of(references_[end]), " of that cell");
              })) {
        return false;
      }
    }
    return true;
  }

  bool check_splits() {
    const std::span<const Node> nodes = tree_.nodes();
    bit_.resize(nodes.size());
    std::vector<std::uint32_t> open;
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
      if (!nodes[i].is_leaf()) {
        open.push_back(i);
        continue;
      }
      if (open.empty()) return true;  // the last leaf
      const std::uint32_t parent = open.back();
      open.pop_back();
      const std::size_t end = std::size_t{nodes[i].first()} + nodes[i].count();
      const std::uint32_t below = code_of(references_[end - 1]);
      const std::uint32_t above = code_of(references_[end]);
      const int m = std::bit_width(below ^ above) - 1;
      const Grid::Split split = grid_.split_below(above, m);
      if (!report_.holds(
              nodes[parent] == Node::inner(split.axis, split.position, i + 1), "split-plane", [&] {
                return text("node ", parent, " splits axis ", nodes[parent].axis(), " at ",
                            nodes[parent].split(), "; ", cell_text(below), " and ",
                            cell_text(above), " part on axis ", split.axis, " at ", split.position);
              })) {
        return false;
      }
      bit_[parent] = static_cast<std::uint8_t>(m);
    }
    return true;
  }

  bool check_levels() {
    const std::span<const Node> nodes = tree_.nodes();
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
      if (nodes[i].is_leaf()) continue;
      for (const std::uint32_t child : {i + 1, nodes[i].upper()}) {
        if (!report_.holds(
                nodes[child].is_leaf() || bit_[child] < bit_[i], "path-compression", [&] {
                  return text("node ", child, " splits at level ", grid_.depth() - 1 - bit_[child],
                              " of the grid, its parent ", i, " at level ",
                              grid_.depth() - 1 - bit_[i]);
                })) {
          return false;
        }
      }
    }
    return true;
  }

  const Tree& tree_;
  const MeshView& mesh_;
  Report& report_;
  Grid grid_;
  std::vector<Reference> references_;
  std::vector<std::uint8_t> bit_;  // of each inner node: the highest bit its two leaves differ in
};

}  // namespace

void check_grid_cells(const Tree& tree, const MeshView& mesh, Report& report) {
  GridChecker(tree, mesh, report).check();
}

}  // namespace fasttree::verifier
