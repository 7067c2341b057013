// SPDX-License-Identifier: Apache-2.0
// The paper's Figure 1: of a frame that is rebuilt and traced, how much is construction. And its
// Figure 5: the scene, drawn through its tree.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "command.h"
#include "exploration.h"

namespace fasttree::app {

struct FrameSplitSettings {
  std::uint32_t width = 1024, height = 1024;  ///< of the frame that is measured
  std::uint32_t repeat = 5;                   ///< frames, for medians; one more comes first
  std::uint32_t picture_width = 800, picture_height = 600;
  std::uint32_t samples = 4;  ///< rays a pixel of the picture
  std::uint64_t memory_bytes = 0;
};

/// A frame with the library's tree of one profile: medians, measured on this machine.
struct MeasuredFrame {
  std::string profile;
  double tree_ms = 0;
  double layout_ms = 0;  ///< of the tracer's own data, made from the tree
  double trace_ms = 0;   ///< primary and shadow rays

  double frame_ms() const { return tree_ms + layout_ms + trace_ms; }
};

struct FrameSplit {
  std::vector<MeasuredFrame> library;  ///< profile paper, profile realtime
  std::string tree_hash;               ///< of profile paper
  std::uint32_t depth = 0;             ///< of its grid
  std::uint64_t rays = 0;              ///< of a frame
  std::vector<std::byte> png;          ///< the scene, drawn through profile paper's tree
  std::uint32_t picture_width = 0, picture_height = 0;
};

FrameSplit split_frame(Context& context, const ExploredScene& scene,
                       const FrameSplitSettings& settings);

}  // namespace fasttree::app
