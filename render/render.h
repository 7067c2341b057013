// SPDX-License-Identifier: Apache-2.0
// Pictures of a mesh through its tree: shaded, of the cost of tracing, and of the tree itself.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "fasttree/build.h"
#include "fasttree/mesh.h"
#include "fasttree/status.h"
#include "fasttree/trace.h"
#include "fasttree/tree.h"
#include "render/camera.h"
#include "render/image.h"

namespace fasttree::render {

/// What the picture shows.
enum class Mode {
  shaded,  ///< the mesh, lit
  heat,    ///< nodes and triangle tests of each pixel's primary rays, with a legend
  leaves,  ///< the tree's leaves cut by an axis-aligned plane, by number of triangles, with a
           ///< legend
};

/// "shaded", "heat", "leaves".
const char* to_string(Mode mode);
/// invalid_argument lists the names.
Result<Mode> parse_mode(const std::string& name);

/// What to draw. Every field has the default a newcomer wants, but for the camera: see
/// automatic_camera().
struct RenderSettings {
  std::uint32_t width = 800;   ///< pixels, 1 to 32768
  std::uint32_t height = 800;  ///< pixels, 1 to 32768
  Camera camera;
  Mode mode = Mode::shaded;
  std::uint32_t samples = 1;  ///< antialiasing: primary rays a pixel, 1 to 4096

  // Mode::shaded
  bool smooth = true;   ///< shade with vertex normals where the mesh has indices
  bool shadows = true;  ///< one shadow ray a hit
  bool ground = false;  ///< an endless floor under the bounds (it is drawn, not part of the mesh)
  std::optional<Vec3> light;          ///< point light; none: above the camera, where it lights most
  std::optional<float> light_radius;  ///< for soft shadows; none: soft from 4 samples a pixel on
  std::uint32_t ao_samples = 0;       ///< ambient-occlusion rays a hit, 0 to 4096
  float ao_radius = 0.0f;             ///< how far they reach; 0: by the bounds and the camera

  // Mode::heat
  double heat_max =
      0.0;  ///< cost at the top of the colour scale; 0: the picture's 99.5th percentile

  // Mode::leaves
  std::uint32_t slice_axis = 2;         ///< the plane is perpendicular to this axis: 0, 1, 2
  std::optional<float> slice_position;  ///< none: the centre of the bounds

  /// Count what the rays cost. Always on in Mode::heat; elsewhere it slows tracing a little.
  bool count_cost = false;

  /// Bytes the renderer may hold at once, the picture included; 0: no limit.
  std::uint64_t memory_limit_bytes = 0;

  ProgressCallback progress;
};

/// Rays of one kind: how many, wall-clock time of the passes that traced them (ray generation and,
/// for the last kind, shading included), and their cost where it was counted.
struct RayStats {
  std::uint64_t rays = 0;
  double ms = 0;
  TraceCounters counters;
  double mrays_per_s() const { return ms > 0 ? static_cast<double>(rays) / (ms * 1e3) : 0.0; }
};

/// What a picture took.
struct RenderStats {
  double total_ms = 0;
  RayStats primary;
  RayStats shadow;
  RayStats ao;
  double mrays_per_s = 0;        ///< all rays over the time of all passes
  TraceCounters counters;        ///< sum over the kinds, where counted
  std::uint64_t hit_pixels = 0;  ///< pixels of which at least one primary ray hit the mesh
  double scale_max = 0;          ///< heat: cost at the top of the legend; leaves: triangles there
  double mean_cost = 0;          ///< heat: mean over the pixels
};

/// Draws the picture on the threads of the task arena it is called in. The same settings give the
/// same pixels for every number of threads. A mesh without triangles gives the background.
/// `tree` and `mesh` are those `tracer` was made from; `stats` may be null.
/// invalid_argument: settings; resource_limit: memory; cancelled: by the callback.
Result<Image> render(const Tree& tree, const Tracer& tracer, const MeshView& mesh,
                     const RenderSettings& settings, RenderStats* stats = nullptr);

}  // namespace fasttree::render
