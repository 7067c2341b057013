// SPDX-License-Identifier: Apache-2.0
// A frame's heat map: what the primary ray of each pixel costs.
#pragma once

#include <cstdint>
#include <vector>

#include "fasttree/trace.h"
#include "render/camera.h"
#include "render/image.h"

namespace fasttree::live {

struct HeatFigures {
  double trace_ms = 0;   ///< of rays that are counted one by one, not in packets
  double shade_ms = 0;   ///< colours and legend
  double mean_cost = 0;  ///< inner nodes, leaves and triangle tests a pixel
  double scale_max = 0;  ///< cost at the top of the scale
};

class HeatFrame {
 public:
  HeatFrame(std::uint32_t width, std::uint32_t height);

  /// Traces and draws, with a legend. The scale ends at 1, 2 or 5 times a power of ten, so that it
  /// holds still while the scene moves a little.
  HeatFigures draw(const Tracer& tracer, const render::Camera& camera, render::Image& image);

 private:
  std::uint32_t width_;
  std::uint32_t height_;
  std::vector<std::uint32_t> costs_;
  std::vector<std::uint32_t> sample_;
};

/// The least of 1, 2 or 5 times a power of ten that is not under `value`; at least 1.
double round_scale(double value);

}  // namespace fasttree::live
