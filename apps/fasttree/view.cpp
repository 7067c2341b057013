// SPDX-License-Identifier: Apache-2.0
// fasttree view: a window in which the tree is rebuilt for every picture.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "command.h"
#include "live/frames.h"
#include "live/heat_frame.h"
#include "live/orbit.h"
#include "live/overlay.h"
#include "live/series.h"
#include "live/window.h"
#include "moving.h"
#include "options.h"
#include "output.h"
#include "progress.h"
#include "render/image.h"

namespace fasttree::app {
namespace {

using Clock = std::chrono::steady_clock;

struct Times {
  live::Series tree, layout, build, primary, shadow, trace, shade, show, frame;
  std::vector<std::pair<std::string, live::Series>> stages;

  void add_stage(const std::string& name, double ms) {
    for (auto& [known, series] : stages) {
      if (known == name) {
        series.add(ms);
        return;
      }
    }
    stages.emplace_back(name, live::Series());
    stages.back().second.add(ms);
  }
};

class ViewCommand : public Command {
 public:
  const char* name() const override { return "view"; }
  const char* summary() const override {
    return "Look at a scene whose tree is rebuilt all the time";
  }
  const char* details() const override {
    return "SOURCE is a scene, or an animation as for fasttree animate. Tree and tracer are made\n"
           "anew for every picture, also where nothing moves: that is what is shown.\n\n"
           "  drag          turn                      Space   hold the animation\n"
           "  wheel         nearer, farther           H       heat map: what each pixel costs\n"
           "  WASD, arrows  sideways, up and down     R       camera as at the start\n"
           "                                          Esc, Q  end\n\n"
           "Example:\n"
           "  fasttree view scene:breakup:50k\n"
           "  fasttree view bunny.ply --frames 100 --json bunny.json --screenshot bunny.png";
  }

  void declare(Options& options) override {
    options_.width = 960;
    options_.height = 640;
    options_.declare(options, "A scene, a folder of mesh files, or a procedural scene that moves");
    options.flag(heat_, "--heat", "Begin with the heat map");
    options.count(frames_, "--frames", "End after so many pictures; 0: never", 0, 1'000'000'000);
    options.count(max_fps_, "--max-fps", "Pictures a second at most; 0: as many as it can", 0,
                  10'000);
    options.text(screenshot_, "--screenshot", "FILE", "Write the last picture, as a PNG");
  }

  int run(Context& context) override {
    // Before anything is read: where no window can be had, one learns it at once.
    std::unique_ptr<live::Window> window = take(
        live::open_window("fasttree view: " + options_.source, options_.width, options_.height));
    const std::uint64_t limit = options_.build.settings.memory_limit_bytes;
    // A quarter of the memory for meshes that are kept, so that a loop is read once.
    const std::uint64_t keep = limit > 0 ? limit / 4 : std::numeric_limits<std::uint64_t>::max();
    Moving moving(context, options_, take(live::list_frames(options_.source)), keep,
                  picture_bytes());
    resize(moving, options_.width, options_.height);
    live::OrbitCamera orbit(moving.shot().camera);

    std::uint64_t shown = 0;
    std::size_t frame = 0;
    bool paused = false;
    for (bool quit = false; !quit;) {
      const auto start = Clock::now();
      stop_if_cancelled();
      const live::Input input = window->poll();
      if (input.quit) break;
      if (input.pause) paused = !paused;
      if (input.heat) heat_ = !heat_;
      if (input.size) resize(moving, input.size->first, input.size->second);
      move_camera(input, orbit);
      draw_frame(context, moving, frame, orbit, *window);
      ++shown;
      if (!paused) frame = (frame + 1) % moving.frames();
      quit = frames_ > 0 && shown >= frames_;
      if (!quit && max_fps_ > 0) {
        std::this_thread::sleep_until(start + std::chrono::nanoseconds(1'000'000'000 / max_fps_));
      }
    }
    window.reset();
    if (!screenshot_.empty()) {
      if (shown == 0) throw Failure{kUsage, "no picture was shown, so there is no screenshot"};
      check(render::write_png(image_, screenshot_));
    }
    report(context, moving, shown);
    return kDone;
  }

 private:
  std::uint64_t picture_bytes() const {
    // The heat map's costs beside the rays.
    return live::FrameTracer::bytes(options_.width, options_.height) +
           std::uint64_t{5} * options_.width * options_.height;
  }

  void resize(Moving& moving, std::uint32_t width, std::uint32_t height) {
    options_.width = width;
    options_.height = height;
    tracer_.reset();
    heat_frame_.reset();
    moving.set_trace_bytes(picture_bytes());
    moving.memory_left();  // throws where there is not enough
    tracer_.emplace(width, height);
    heat_frame_.emplace(width, height);
  }

  void move_camera(const live::Input& input, live::OrbitCamera& orbit) const {
    if (input.reset) orbit.reset();
    const double side = std::min(options_.width, options_.height);
    orbit.turn(input.turn_right / side, input.turn_down / side);
    orbit.zoom(input.zoom);
    // Half of what is seen in a second.
    orbit.pan(0.5 * input.pan_right, 0.5 * input.pan_up);
  }

  void draw_frame(Context& context, Moving& moving, std::size_t frame,
                  const live::OrbitCamera& orbit, live::Window& window) {
    moving.rebuild(frame);
    const live::Rebuild& built = moving.built();
    live::Shot shot = moving.shot();
    shot.camera = orbit.camera();
    double trace_ms, shade_ms;
    if (heat_) {
      const live::HeatFigures figures = heat_frame_->draw(built.tracer(), shot.camera, image_);
      trace_ms = figures.trace_ms;
      shade_ms = figures.shade_ms;
    } else {
      const live::TraceFigures figures = tracer_->trace(built.tracer(), moving.mesh(), shot);
      times_.primary.add(figures.primary_ms);
      times_.shadow.add(figures.shadow_ms);
      trace_ms = figures.trace_ms();
      const auto start = Clock::now();
      tracer_->shade(image_);
      shade_ms = milliseconds_since(start);
    }
    auto start = Clock::now();
    live::draw_overlay(image_, figures_on_screen(context, moving, frame));
    shade_ms += milliseconds_since(start);
    start = Clock::now();
    check(window.show(image_));
    const double show_ms = milliseconds_since(start);

    times_.tree.add(built.tree_ms());
    times_.layout.add(built.layout_ms());
    times_.build.add(built.build_ms());
    for (const StageTime& stage : built.stages()) times_.add_stage(stage.stage, stage.ms);
    times_.trace.add(trace_ms);
    times_.shade.add(shade_ms);
    times_.show.add(show_ms);
    times_.frame.add(built.build_ms() + trace_ms + shade_ms + show_ms);
  }

  /// Means of the last frames: the figures of this one are not known before it is shown.
  std::vector<live::OverlayLine> figures_on_screen(Context& context, const Moving& moving,
                                                   std::size_t frame) const {
    const auto ms = [](const live::Series& series) {
      return fmt::format("{:.2f} ms", series.recent());
    };
    std::vector<live::OverlayLine> lines;
    lines.push_back({moving.frames() > 1
                         ? fmt::format("frame {} of {}", frame + 1, moving.frames())
                         : moving.name().substr(moving.name().find_last_of('/') + 1),
                     "", false});
    lines.push_back({"triangles", with_commas(moving.mesh().triangle_count), false});
    lines.push_back({"profile", to_string(options_.build.settings.profile), false});
    lines.push_back({"threads", std::to_string(context.threads), false});
    lines.push_back({"build", ms(times_.build), false});
    for (const auto& [stage, series] : times_.stages) lines.push_back({stage, ms(series), true});
    lines.push_back({"layout", ms(times_.layout), true});
    lines.push_back({heat_ ? "trace, counting" : "trace", ms(times_.trace), false});
    if (!heat_) {
      lines.push_back({"primary rays", ms(times_.primary), true});
      if (options_.shadows) lines.push_back({"shadow rays", ms(times_.shadow), true});
    }
    lines.push_back({"shade", ms(times_.shade), false});
    lines.push_back({"show", ms(times_.show), false});
    const double frame_ms = times_.frame.recent();
    lines.push_back({"frame", ms(times_.frame), false});
    lines.push_back(
        {"frames a second", fmt::format("{:.0f}", frame_ms > 0 ? 1000 / frame_ms : 0.0), false});
    return lines;
  }

  void report(Context& context, const Moving& moving, std::uint64_t shown) const {
    const double frame_ms = times_.frame.median();
    const double fps = frame_ms > 0 ? 1000 / frame_ms : 0;
    context.output.line("pictures             {} of {} ({} triangles)", shown, moving.name(),
                        with_commas(moving.mesh().triangle_count));
    context.output.line(
        "median               build {:.2f} ms, trace {:.2f} ms, shade {:.2f} ms, "
        "show {:.2f} ms",
        times_.build.median(), times_.trace.median(), times_.shade.median(), times_.show.median());
    context.output.line("frame                {:.2f} ms ({:.0f} fps), worst {:.2f} ms", frame_ms,
                        fps, times_.frame.worst());
    if (!screenshot_.empty()) context.output.line("screenshot           {}", screenshot_);

    nlohmann::ordered_json json = json_of_program();
    json["scene"] = moving.name();
    json["source"] = options_.source;
    json["profile"] = to_string(options_.build.settings.profile);
    json["threads"] = context.threads;
    json["width"] = options_.width;
    json["height"] = options_.height;
    json["shadows"] = options_.shadows;
    json["heat"] = heat_;
    json["frames"] = shown;
    json["frames_of_source"] = moving.frames();
    json["triangles"] = moving.mesh().triangle_count;
    json["first_build_ms"] = moving.first_build_ms();
    json["build_ms"] = times_.build.median();
    json["tree_ms"] = times_.tree.median();
    json["layout_ms"] = times_.layout.median();
    json["stages_ms"] = nlohmann::ordered_json::object();
    for (const auto& [stage, series] : times_.stages) json["stages_ms"][stage] = series.median();
    json["trace_ms"] = times_.trace.median();
    json["primary_ms"] = times_.primary.median();
    json["shadow_ms"] = times_.shadow.median();
    json["shade_ms"] = times_.shade.median();
    json["show_ms"] = times_.show.median();
    json["frame_ms"] = frame_ms;
    json["worst_frame_ms"] = times_.frame.worst();
    json["fps"] = fps;
    context.output.json(json, context.common.json);
  }

  MovingOptions options_;
  bool heat_ = false;
  std::uint64_t frames_ = 0;
  std::uint32_t max_fps_ = 60;
  std::string screenshot_;
  std::optional<live::FrameTracer> tracer_;
  std::optional<live::HeatFrame> heat_frame_;
  render::Image image_;
  Times times_;
};

}  // namespace

std::unique_ptr<Command> make_view_command() {
  return std::make_unique<ViewCommand>();
}

}  // namespace fasttree::app
