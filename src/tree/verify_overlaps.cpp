// SPDX-License-Identifier: Apache-2.0
// Trees without a grid against their mesh: every part of every triangle has to be in a leaf that
// lists it (missing-reference), and no leaf may list a triangle its cell does not touch
// (extra-reference). Parts thinner than a rounding error of the coordinates decide nothing.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "tree/verify_report.h"

namespace fasttree::verifier {
namespace {

using Point = std::array<double, 3>;
using Polygon = std::vector<Point>;

Polygon polygon_of(const std::array<Vec3, 3>& triangle) {
  Polygon polygon;
  for (const Vec3& p : triangle) polygon.push_back({p.x, p.y, p.z});
  return polygon;
}

// The part of a convex polygon on one side of a plane, the plane included (Sutherland and Hodgman
// 1974). Corners made by a plane lie in it exactly.
void clip(const Polygon& in, std::size_t axis, double plane, bool keep_lower, Polygon& out) {
  out.clear();
  for (std::size_t i = 0; i < in.size(); ++i) {
    const Point& a = in[i];
    const Point& b = in[i + 1 == in.size() ? 0 : i + 1];
    const double da = keep_lower ? plane - a[axis] : a[axis] - plane;
    const double db = keep_lower ? plane - b[axis] : b[axis] - plane;
    if (da >= 0) out.push_back(a);
    if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
      Point p;
      for (std::size_t k = 0; k < 3; ++k) p[k] = a[k] + (b[k] - a[k]) * (da / (da - db));
      p[axis] = plane;
      out.push_back(p);
    }
  }
}

// How far a coordinate may be off: one unit in the last place of the largest.
Point tolerance_of(const Box3& bounds) {
  Point tolerance;
  for (std::size_t a = 0; a < 3; ++a) {
    const double largest =
        std::max(std::fabs(double{bounds.lo[a]}), std::fabs(double{bounds.hi[a]}));
    tolerance[a] = std::max<double>(largest * std::numeric_limits<float>::epsilon(),
                                    std::numeric_limits<float>::denorm_min());
  }
  return tolerance;
}

// Looks for parts of one triangle that no leaf lists. One per task: it keeps its polygons.
//
// A point clearly below a plane has to be found below it, one clearly above it above. Strips along
// a plane, as wide as the tolerance, are not looked at, unless all there is of a polygon lies in
// one: then each of its points has to be found on either side, since a ray looks at both.
class CoverSearch {
 public:
  CoverSearch(const Tree& tree, const Point& tolerance)
      : nodes_(tree.nodes()), ids_(tree.ids()), tolerance_(tolerance), parts_(kMaxTreeDepth) {}

  /// A part of the triangle that is in a leaf, by its index, which does not list it.
  struct Missing {
    std::uint32_t leaf = 0;
    Polygon part;
  };

  std::vector<Missing> missing(std::uint32_t id, const std::array<Vec3, 3>& triangle) {
    id_ = id;
    std::vector<Missing> found;
    search(0, 0, polygon_of(triangle), found);
    return found;
  }

 private:
  void search(std::uint32_t index, std::size_t depth, const Polygon& polygon,
              std::vector<Missing>& missing) {
    const Node& node = nodes_[index];
    if (node.is_leaf()) {
      const auto run = ids_.subspan(node.first(), node.count());
      if (!std::binary_search(run.begin(), run.end(), id_)) missing.push_back({index, polygon});
      return;
    }
    const std::size_t axis = node.axis();
    const double below = node.split() - tolerance_[axis];
    const double above = node.split() + tolerance_[axis];
    const auto [lo, hi] = range(polygon, axis);
    if (lo >= below && hi <= above) {
      std::vector<Missing> not_above;
      search(node.upper(), depth + 1, polygon, not_above);
      for (const Missing& m : not_above) search(index + 1, depth + 1, m.part, missing);
      return;
    }
    // `polygon` is in the slot of an ancestor or in a list of missing parts, never in this one.
    Polygon& part = parts_[depth];
    if (lo < below) {
      if (hi > below) clip(polygon, axis, below, true, part);
      search(index + 1, depth + 1, hi > below ? part : polygon, missing);
    }
    if (hi > above) {
      if (lo < above) clip(polygon, axis, above, false, part);
      search(node.upper(), depth + 1, lo < above ? part : polygon, missing);
    }
  }

  static std::pair<double, double> range(const Polygon& polygon, std::size_t axis) {
    double lo = polygon.front()[axis];
    double hi = lo;
    for (const Point& p : polygon) {
      lo = std::min(lo, p[axis]);
      hi = std::max(hi, p[axis]);
    }
    return {lo, hi};
  }

  std::span<const Node> nodes_;
  std::span<const std::uint32_t> ids_;
  Point tolerance_;
  std::vector<Polygon> parts_;
  std::uint32_t id_ = 0;
};

// The lowest number in [0, count) that `good` does not hold for, or count. `make()` gives each
// task its own `good`, a callable that may keep working memory.
template <typename Make>
std::uint32_t first_bad(std::uint32_t count, const Make& make) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::uint32_t>(0, count, 256), count,
      [&](const tbb::blocked_range<std::uint32_t>& range, std::uint32_t found) {
        auto good = make();
        for (std::uint32_t i = range.begin(); i < std::min(range.end(), found); ++i) {
          if (!good(i)) found = i;
        }
        return found;
      },
      [](std::uint32_t a, std::uint32_t b) { return std::min(a, b); });
}

bool check_missing(const Tree& tree, const MeshView& mesh, Report& report) {
  const Point tolerance = tolerance_of(tree.info().bounds);
  const std::uint32_t bad = first_bad(mesh.triangle_count, [&] {
    return [&mesh, search = CoverSearch(tree, tolerance)](std::uint32_t t) mutable {
      return search.missing(t, mesh.triangle(t)).empty();
    };
  });
  report.count(mesh.triangle_count);
  if (bad == mesh.triangle_count) return true;
  const auto missing = CoverSearch(tree, tolerance).missing(bad, mesh.triangle(bad));
  report.fail("missing-reference", text("triangle ", bad, " reaches into leaf ",
                                        missing.front().leaf, ", which does not list it"));
  return false;
}

struct LeafCell {
  std::uint32_t node = 0;
  Box3 cell;
};

// Whether a triangle touches a cell, by its own part inside it or only by its box.
class TouchTest {
 public:
  TouchTest(const Point& tolerance, bool exact) : tolerance_(tolerance), exact_(exact) {}

  bool operator()(const std::array<Vec3, 3>& triangle, const Box3& cell) {
    Box3 box;
    for (const Vec3& p : triangle) box.include(p);
    for (std::size_t a = 0; a < 3; ++a) {
      if (box.lo[a] > cell.hi[a] + tolerance_[a] || box.hi[a] < cell.lo[a] - tolerance_[a]) {
        return false;
      }
    }
    if (!exact_) return true;
    part_ = polygon_of(triangle);
    for (std::size_t a = 0; a < 3; ++a) {
      clip(part_, a, cell.lo[a] - tolerance_[a], false, next_);
      clip(next_, a, cell.hi[a] + tolerance_[a], true, part_);
    }
    return !part_.empty();
  }

 private:
  Point tolerance_;
  bool exact_;
  Polygon part_;
  Polygon next_;
};

// The id of the first triangle that a leaf lists though it does not touch it, or kNone.
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

std::uint32_t first_extra(const Tree& tree, const MeshView& mesh, const LeafCell& leaf,
                          TouchTest& touches) {
  const Node& node = tree.nodes()[leaf.node];
  for (const std::uint32_t id : tree.ids().subspan(node.first(), node.count())) {
    if (!touches(mesh.triangle(id), leaf.cell)) return id;
  }
  return kNone;
}

void check_extra(const Tree& tree, const MeshView& mesh, Report& report) {
  std::vector<LeafCell> leaves;
  leaves.reserve(tree.leaf_count());
  for_each_leaf(tree, [&](std::uint32_t node, const Box3& cell) {
    leaves.push_back({node, cell});
  });
  const auto count = static_cast<std::uint32_t>(leaves.size());
  // The binned builder sorts triangles by their boxes, the exact one by their clipped parts.
  const TouchTest touch_test(tolerance_of(tree.info().bounds),
                             tree.info().profile == Profile::sah_exact);
  const std::uint32_t bad = first_bad(count, [&] {
    return [&, touches = touch_test](std::uint32_t i) mutable {
      return first_extra(tree, mesh, leaves[i], touches) == kNone;
    };
  });
  report.count(tree.ids().size());
  if (bad == count) return;
  TouchTest touches = touch_test;
  report.fail("extra-reference",
              text("leaf ", leaves[bad].node, " lists triangle ",
                   first_extra(tree, mesh, leaves[bad], touches),
                   ", which does not touch its cell ", text_of(leaves[bad].cell)));
}

}  // namespace

void check_overlaps(const Tree& tree, const MeshView& mesh, Report& report) {
  if (check_missing(tree, mesh, report)) check_extra(tree, mesh, report);
}

}  // namespace fasttree::verifier
