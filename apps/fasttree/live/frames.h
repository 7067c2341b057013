// SPDX-License-Identifier: Apache-2.0
// What an animation is made of: a scene's name for each frame.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "fasttree/status.h"

namespace fasttree::live {

struct Frames {
  std::string name;                ///< of the whole, for people
  std::vector<std::string> specs;  ///< one a frame, for scene::load_scene(); never empty
  bool folder = false;
};

/// Lists the frames of a source, without reading them:
///   a folder            its mesh files (PLY, OBJ, STL, glTF, GLB), in natural order
///   scene:wave:20k      a procedural scene that moves: one loop
///   anything else       a single frame
/// io_error: the folder cannot be read; bad_input: there is no mesh file in it.
Result<Frames> list_frames(const std::string& source);

/// The order a person expects of file names: numbers count as numbers, so 9.ply is before 10.ply.
bool natural_less(std::string_view a, std::string_view b);

/// A frame's name for people: a file's name without its folder, or the scene's specification.
std::string frame_label(const Frames& frames, std::size_t frame);

/// Why a source of one frame is not an animation, and what would be.
std::string not_moving(const std::string& source);

}  // namespace fasttree::live
