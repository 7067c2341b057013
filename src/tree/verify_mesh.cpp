// SPDX-License-Identifier: Apache-2.0
// Whether a tree and a mesh belong together.
#include <cmath>

#include "fasttree/verify.h"
#include "tree/verify_report.h"

namespace fasttree {
namespace {

using verifier::Report;
using verifier::text;

// Bounds as the tree should have them, computed here again on purpose: the verifier shares no code
// with the builders it judges.
Box3 bounds_of(const MeshView& mesh) {
  if (mesh.triangle_count == 0) return {{0, 0, 0}, {0, 0, 0}};
  Box3 bounds;
  for (std::uint32_t t = 0; t < mesh.triangle_count; ++t) {
    for (const Vec3& corner : mesh.triangle(t)) bounds.include(corner);
  }
  return bounds;
}

bool finite(const std::array<Vec3, 3>& triangle) {
  for (const Vec3& p : triangle) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return false;
  }
  return true;
}

bool check_mesh(const MeshView& mesh, Report& report) {
  const Status shape = validate(mesh);
  if (!report.holds(shape.ok(), "mesh", [&] { return shape.message(); })) return false;
  for (std::uint32_t t = 0; t < mesh.triangle_count; ++t) {
    if (!report.holds(finite(mesh.triangle(t)), "mesh", [&] {
          return text("triangle ", t, " has a coordinate that is not finite");
        })) {
      return false;
    }
  }
  return true;
}

bool check_match(const Tree& tree, const MeshView& mesh, Report& report) {
  const TreeInfo& info = tree.info();
  if (!report.holds(info.triangle_count == mesh.triangle_count, "mesh-triangle-count", [&] {
        return text("the tree is for ", info.triangle_count, " triangles, the mesh has ",
                    mesh.triangle_count);
      })) {
    return false;
  }
  const Box3 bounds = bounds_of(mesh);
  return report.holds(info.bounds == bounds, "mesh-bounds", [&] {
    return "the tree's bounds are " + verifier::text_of(info.bounds) + ", the mesh's " +
           verifier::text_of(bounds);
  });
}

}  // namespace

Verification verify(const Tree& tree, const MeshView& mesh) {
  const Verification alone = verify(tree);
  if (!alone.ok) return alone;
  Report report;
  report.count(alone.checks);
  if (check_mesh(mesh, report) && check_match(tree, mesh, report)) {
    if (tree.info().profile == Profile::paper) {
      verifier::check_grid_cells(tree, mesh, report);
    } else {
      verifier::check_overlaps(tree, mesh, report);
    }
  }
  return report.found();
}

}  // namespace fasttree
