// SPDX-License-Identifier: Apache-2.0
// A window that shows pictures and says what hands do. window_sdl.cpp is made with SDL2,
// window_none.cpp stands in where that is not installed.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "fasttree/status.h"
#include "render/image.h"

namespace fasttree::live {

/// What happened since the last poll().
struct Input {
  bool quit = false;
  bool pause = false;  ///< Space was pressed an odd number of times; the same for the next two
  bool heat = false;
  bool reset = false;
  double turn_right = 0;  ///< dragged, in pixels
  double turn_down = 0;
  double zoom = 0;       ///< notches of the wheel, away from the hand
  double pan_right = 0;  ///< seconds that the key was held, to the left negative
  double pan_up = 0;
  std::optional<std::pair<std::uint32_t, std::uint32_t>> size;  ///< the window's new width, height
};

class Window {
 public:
  virtual ~Window() = default;
  virtual Input poll() = 0;
  virtual Status show(const render::Image& image) = 0;
};

/// invalid_argument: built without SDL2, or there is no screen to open a window on; the message
/// says what to do.
Result<std::unique_ptr<Window>> open_window(const std::string& title, std::uint32_t width,
                                            std::uint32_t height);

}  // namespace fasttree::live
