// SPDX-License-Identifier: Apache-2.0
#include "render/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "render/camera_frame.h"
#include "render/math.h"
#include "render/sampling.h"

namespace fasttree::render {

namespace {

constexpr std::array kViews{View::outside, View::tight, View::corner, View::inside};

struct Extent {
  Double3 centre, half;
  double diagonal = 0;  ///< 1 where the bounds are empty or one point

  explicit Extent(const Box3& bounds) {
    if (!bounds.empty()) {
      half = (Double3(bounds.hi) - Double3(bounds.lo)) * 0.5;
      centre = Double3(bounds.lo) + half;
    }
    diagonal = 2 * length(half);
    if (!(diagonal > 0)) diagonal = 1;
  }
};

Camera look(Double3 eye, Double3 target) {
  Camera camera;
  camera.eye = to_float(eye);
  camera.target = to_float(target);
  // A scene far from the origin and tiny: at least one step of binary32 between eye and target.
  if (camera.eye == camera.target) {
    camera.eye.z =
        std::nextafter(camera.target.z, camera.target.z < 0 ? std::numeric_limits<float>::lowest()
                                                            : std::numeric_limits<float>::max());
  }
  return camera;
}

// From a fixed direction, as near as leaves all eight corners in a square picture.
Camera corner_view(const Extent& e) {
  const Double3 back = normalized({0.5, 0.38, 1.0});
  CameraFrame frame(look(back, {}));
  const double reach = 0.92 * frame.half_side;
  double distance = 0;
  for (int i = 0; i < 8; ++i) {
    const Double3 corner{(i & 1) != 0 ? e.half.x : -e.half.x, (i & 2) != 0 ? e.half.y : -e.half.y,
                         (i & 4) != 0 ? e.half.z : -e.half.z};
    const double aside =
        std::max(std::fabs(dot(corner, frame.right)), std::fabs(dot(corner, frame.up)));
    distance = std::max(distance, aside / reach - dot(corner, frame.forward));
  }
  if (!(distance > 0)) distance = e.diagonal;
  return look(e.centre + back * distance, e.centre);
}

Camera inside_view(const Extent& e) {
  const Double3 along = e.half.x > e.half.z ? Double3(1, 0, 0) : Double3(0, 0, 1);
  const Double3 low = e.centre - Double3(0, 0.4 * e.half.y, 0);
  const double reach = dot(along, e.half) > 0 ? dot(along, e.half) : 0.5 * e.diagonal;
  return look(low + along * (0.75 * reach), low - along * reach);
}

// What an eye sees of the scene around it.
struct Surroundings {
  double enclosed = 0;   ///< share of all directions that hit something
  double clearance = 0;  ///< distance to the nearest thing hit
};

Surroundings look_around(const Tracer& tracer, Double3 eye, double diagonal) {
  constexpr std::uint32_t kDirections = 256;
  Surroundings s;
  s.clearance = diagonal;
  for (std::uint32_t i = 0; i < kDirections; ++i) {
    const Hit hit = tracer.closest(make_ray(eye, spiral_direction(i, kDirections)));
    if (!hit.hit()) continue;
    s.enclosed += 1.0 / kDirections;
    s.clearance = std::min(s.clearance, static_cast<double>(hit.t));
  }
  return s;
}

// How interesting a view is: the mean distance seen in a cone, what is open counting half the
// diagonal, times how varied it is: bare walls are dull, however far they are.
struct Prospect {
  double depth = 0;
  double interest = 0;
};

Prospect look_ahead(const Tracer& tracer, Double3 eye, Double3 direction, double diagonal) {
  const Basis basis(direction);
  constexpr std::uint32_t kRays = 24;
  std::array<std::uint32_t, kRays> seen;
  double sum = 0;
  for (std::uint32_t i = 0; i < kRays; ++i) {
    const Sample2 s = disc({(i + 0.5) / kRays, i * 0.618033988749895});
    const Hit hit = tracer.closest(make_ray(eye, normalized(basis(0.45 * s.u, 0.45 * s.v, 1.0))));
    sum += hit.hit() ? std::min(static_cast<double>(hit.t), diagonal) : 0.5 * diagonal;
    seen[i] = hit.triangle;
  }
  std::sort(seen.begin(), seen.end());
  const auto distinct = std::unique(seen.begin(), seen.end()) - seen.begin();
  Prospect p;
  p.depth = sum / kRays;
  const double varied = static_cast<double>(distinct) / kRays;
  p.interest = p.depth * std::pow(varied, 4);
  return p;
}

double cell_middle(int i, int cells) {
  return 2 * (i + 0.5) / cells - 1;
}

// Keeps the best of the views it is shown.
class InsideSearch {
 public:
  InsideSearch(const Tracer& tracer, double diagonal) : tracer_(tracer), diagonal_(diagonal) {}

  void consider(Double3 eye) {
    constexpr int kDirections = 16;
    const Surroundings s = look_around(tracer_, eye, diagonal_);
    // Being enclosed matters most; beyond a thirtieth of the diagonal more room is no better.
    const double room = std::min(s.clearance / diagonal_, 1.0 / 30);
    const double worth = std::pow(s.enclosed, 4) * std::sqrt(room);
    if (worth * diagonal_ <= best_) return;
    for (int k = 0; k < kDirections; ++k) {
      const double angle = 2 * std::numbers::pi * k / kDirections;
      const Double3 ahead = normalized({std::cos(angle), 0.06, std::sin(angle)});
      const Prospect prospect = look_ahead(tracer_, eye, ahead, diagonal_);
      if (worth * prospect.interest <= best_) continue;
      best_ = worth * prospect.interest;
      eye_ = eye;
      target_ = eye + ahead * prospect.depth;
    }
  }

  bool found() const { return best_ > 0; }
  Double3 eye() const { return eye_; }
  Double3 target() const { return target_; }

 private:
  const Tracer& tracer_;
  double diagonal_;
  double best_ = 0;
  Double3 eye_, target_;
};

}  // namespace

const char* to_string(View view) {
  switch (view) {
    case View::outside:
      return "outside";
    case View::tight:
      return "tight";
    case View::corner:
      return "corner";
    case View::inside:
      return "inside";
  }
  return "unknown";
}

Result<View> parse_view(const std::string& name) {
  for (const View view : kViews)
    if (name == to_string(view)) return view;
  return Status(StatusCode::invalid_argument,
                "no view is called '" + name + "'; there are: outside, tight, corner, inside");
}

Camera automatic_camera(const Box3& bounds, View view) {
  const Extent e(bounds);
  switch (view) {
    case View::outside:
      break;
    case View::tight:
      return look(e.centre + Double3(0, 0, 0.75 * e.diagonal), e.centre);
    case View::corner:
      return corner_view(e);
    case View::inside:
      return inside_view(e);
  }
  return look(e.centre + Double3(0, 0, 1.5 * e.diagonal), e.centre);
}

Camera automatic_camera(const Box3& bounds, View view, const Tracer& tracer) {
  if (view != View::inside || bounds.empty()) return automatic_camera(bounds, view);
  const Extent e(bounds);
  InsideSearch search(tracer, e.diagonal);
  // First all over the floor, at heights a person's eyes could be at; then around the best place.
  constexpr int kGrid = 9, kFine = 5;
  constexpr std::array kHeights{0.08, 0.12, 0.17};
  for (int ix = 0; ix < kGrid; ++ix)
    for (int iz = 0; iz < kGrid; ++iz)
      for (const double height : kHeights)
        search.consider(e.centre +
                        Double3(cell_middle(ix, kGrid), 2 * height - 1, cell_middle(iz, kGrid)) *
                            e.half);
  if (!search.found()) return inside_view(e);
  const Double3 middle = search.eye(), cell = e.half * (1.0 / kGrid);
  for (int ix = 0; ix < kFine; ++ix)
    for (int iz = 0; iz < kFine; ++iz)
      search.consider(middle +
                      Double3(cell_middle(ix, kFine) * cell.x, 0, cell_middle(iz, kFine) * cell.z));
  return look(search.eye(), search.target());
}

}  // namespace fasttree::render
