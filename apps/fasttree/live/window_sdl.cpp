// SPDX-License-Identifier: Apache-2.0
#define SDL_MAIN_HANDLED  // main() is ours
#include <SDL.h>

#include <chrono>

#include "live/window.h"

namespace fasttree::live {
namespace {

Status sdl_error(const std::string& what) {
  return Status(StatusCode::invalid_argument, what + ": " + SDL_GetError());
}

class SdlWindow : public Window {
 public:
  ~SdlWindow() override {
    if (texture_ != nullptr) SDL_DestroyTexture(texture_);
    if (renderer_ != nullptr) SDL_DestroyRenderer(renderer_);
    if (window_ != nullptr) SDL_DestroyWindow(window_);
    SDL_Quit();
  }

  Status open(const std::string& title, std::uint32_t width, std::uint32_t height) {
    SDL_SetMainReady();
    // Ctrl-C is the program's.
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    if (SDL_Init(SDL_INIT_VIDEO) != 0) {
      return Status(StatusCode::invalid_argument,
                    std::string("there is no screen for a window: ") + SDL_GetError() +
                        "; set DISPLAY, run under xvfb-run, or set SDL_VIDEODRIVER=dummy to show "
                        "nothing");
    }
    window_ =
        SDL_CreateWindow(title.c_str(), SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED,
                         static_cast<int>(width), static_cast<int>(height), SDL_WINDOW_RESIZABLE);
    if (window_ == nullptr) return sdl_error("cannot open a window");
    renderer_ = SDL_CreateRenderer(window_, -1, 0);
    if (renderer_ == nullptr) renderer_ = SDL_CreateRenderer(window_, -1, SDL_RENDERER_SOFTWARE);
    if (renderer_ == nullptr) return sdl_error("cannot draw into the window");
    polled_ = std::chrono::steady_clock::now();
    return Status();
  }

  Input poll() override {
    Input input;
    SDL_Event event;
    while (SDL_PollEvent(&event) != 0) take(event, input);
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - polled_).count();
    polled_ = now;
    const Uint8* held = SDL_GetKeyboardState(nullptr);
    const auto way = [&](SDL_Scancode a, SDL_Scancode b) {
      return held[a] != 0 || held[b] != 0 ? seconds : 0.0;
    };
    input.pan_right += way(SDL_SCANCODE_D, SDL_SCANCODE_RIGHT);
    input.pan_right -= way(SDL_SCANCODE_A, SDL_SCANCODE_LEFT);
    input.pan_up += way(SDL_SCANCODE_W, SDL_SCANCODE_UP);
    input.pan_up -= way(SDL_SCANCODE_S, SDL_SCANCODE_DOWN);
    return input;
  }

  Status show(const render::Image& image) override {
    const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
    if (texture_ == nullptr || width != texture_width_ || height != texture_height_) {
      if (texture_ != nullptr) SDL_DestroyTexture(texture_);
      texture_ = SDL_CreateTexture(renderer_, SDL_PIXELFORMAT_RGB24, SDL_TEXTUREACCESS_STREAMING,
                                   width, height);
      if (texture_ == nullptr) return sdl_error("cannot draw into the window");
      texture_width_ = width;
      texture_height_ = height;
    }
    if (SDL_UpdateTexture(texture_, nullptr, image.rgb.data(), 3 * width) != 0 ||
        SDL_RenderCopy(renderer_, texture_, nullptr, nullptr) != 0) {
      return sdl_error("cannot draw into the window");
    }
    SDL_RenderPresent(renderer_);
    return Status();
  }

 private:
  static void take(const SDL_Event& event, Input& input) {
    switch (event.type) {
      case SDL_QUIT:
        input.quit = true;
        break;
      case SDL_KEYDOWN:
        if (event.key.repeat == 0) press(event.key.keysym.sym, input);
        break;
      case SDL_MOUSEMOTION:
        if (event.motion.state != 0) {
          input.turn_right += event.motion.xrel;
          input.turn_down += event.motion.yrel;
        }
        break;
      case SDL_MOUSEWHEEL:
        input.zoom += event.wheel.y;
        break;
      case SDL_WINDOWEVENT:
        if (event.window.event == SDL_WINDOWEVENT_SIZE_CHANGED && event.window.data1 > 0 &&
            event.window.data2 > 0) {
          input.size = {static_cast<std::uint32_t>(event.window.data1),
                        static_cast<std::uint32_t>(event.window.data2)};
        }
        break;
      default:
        break;
    }
  }

  static void press(SDL_Keycode key, Input& input) {
    if (key == SDLK_ESCAPE || key == SDLK_q) input.quit = true;
    if (key == SDLK_SPACE) input.pause = !input.pause;
    if (key == SDLK_h) input.heat = !input.heat;
    if (key == SDLK_r) input.reset = true;
  }

  SDL_Window* window_ = nullptr;
  SDL_Renderer* renderer_ = nullptr;
  SDL_Texture* texture_ = nullptr;
  int texture_width_ = 0;
  int texture_height_ = 0;
  std::chrono::steady_clock::time_point polled_;
};

}  // namespace

Result<std::unique_ptr<Window>> open_window(const std::string& title, std::uint32_t width,
                                            std::uint32_t height) {
  auto window = std::make_unique<SdlWindow>();
  const Status status = window->open(title, width, height);
  if (!status.ok()) return status;
  return std::unique_ptr<Window>(std::move(window));
}

}  // namespace fasttree::live
