// SPDX-License-Identifier: Apache-2.0
// fasttree animate: rebuilds a tree for every frame of a moving scene, traces it, and says what
// each took.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <vector>

#include "command.h"
#include "live/frames.h"
#include "moving.h"
#include "options.h"
#include "output.h"
#include "plot.h"
#include "progress.h"
#include "render/render.h"

namespace fasttree::app {
namespace {

using nlohmann::ordered_json;

/// One frame, each time a median over the loops.
struct FrameRecord {
  std::string name;
  std::uint64_t triangles = 0;
  live::TraceFigures rays;  ///< counts; the same in every loop
  std::vector<double> tree_ms, layout_ms, build_ms, primary_ms, shadow_ms, trace_ms, frame_ms;
  std::vector<std::string> stage_names;
  std::vector<std::vector<double>> stage_ms;

  void add(const live::Rebuild& built, const live::TraceFigures& figures) {
    rays = figures;
    tree_ms.push_back(built.tree_ms());
    layout_ms.push_back(built.layout_ms());
    build_ms.push_back(built.build_ms());
    primary_ms.push_back(figures.primary_ms);
    shadow_ms.push_back(figures.shadow_ms);
    trace_ms.push_back(figures.trace_ms());
    frame_ms.push_back(built.build_ms() + figures.trace_ms());
    for (const StageTime& stage : built.stages()) add_stage(stage.stage, stage.ms);
  }

  double stage(const std::string& stage_name) const {
    const auto found = std::find(stage_names.begin(), stage_names.end(), stage_name);
    if (found == stage_names.end()) return 0;
    return median(stage_ms[static_cast<std::size_t>(found - stage_names.begin())]);
  }

 private:
  void add_stage(const std::string& stage_name, double ms) {
    const auto found = std::find(stage_names.begin(), stage_names.end(), stage_name);
    const auto place = static_cast<std::size_t>(found - stage_names.begin());
    if (found == stage_names.end()) {
      stage_names.push_back(stage_name);
      stage_ms.emplace_back();
    }
    stage_ms[place].push_back(ms);
  }
};

double fps(double frame_ms) {
  return frame_ms > 0 ? 1000 / frame_ms : 0;
}

class AnimateCommand : public Command {
 public:
  const char* name() const override { return "animate"; }
  const char* summary() const override { return "Rebuild and trace every frame of an animation"; }
  const char* details() const override {
    return "SOURCE is a folder with one mesh file a frame, in the order of their names (9.ply is\n"
           "before 10.ply), or a procedural scene that moves. Tree and tracer are made anew for\n"
           "every frame, in the memory of the frame before. build is the tree and the tracer's\n"
           "layout, trace the primary and shadow rays, frame their sum. Reading is not timed.\n\n"
           "Example:\n"
           "  fasttree animate scene:breakup:50k --loops 3 --svg breakup.svg\n"
           "  fasttree animate run/ --out-dir pictures --csv run.csv";
  }

  void declare(Options& options) override {
    options_.declare(options, "A folder of mesh files, or a procedural scene that moves");
    options.count(frames_, "--frames", "Frames to take, from the first on; 0: all", 0, 1'000'000);
    options.count(loops_, "--loops", "Times to go through them; figures are medians", 1, 10'000);
    options.text(csv_, "--csv", "FILE", "Write a row a frame");
    options.text(svg_, "--svg", "FILE", "Write a plot of build and trace times");
    options.text(out_dir_, "--out-dir", "DIR", "Draw the frames: DIR/frame_0000.png and so on");
  }

  int run(Context& context) override {
    live::Frames frames = take(live::list_frames(options_.source));
    if (frames.specs.size() == 1 && !frames.folder) {
      // What is not there or no scene at all is the reader's to say.
      load_scene(context, options_.source, options_.build.settings.memory_limit_bytes);
      throw Failure{kUsage, live::not_moving(options_.source)};
    }
    if (frames_ > frames.specs.size()) {
      throw Failure{kUsage, fmt::format("--frames {}: {} has {} frames; give --loops to go through "
                                        "them more often",
                                        frames_, options_.source, frames.specs.size())};
    }
    if (frames_ > 0) frames.specs.resize(frames_);
    folder_ = frames.folder;
    if (!out_dir_.empty()) make_out_dir();

    Moving moving(context, options_, std::move(frames), 0,
                  live::FrameTracer::bytes(options_.width, options_.height));
    live::FrameTracer tracer(options_.width, options_.height);
    std::vector<FrameRecord> records(moving.frames());
    measure(context, moving, tracer, records);
    summarise(context.output, records);
    write_files(context, moving, records);
    return kDone;
  }

 private:
  void make_out_dir() const {
    std::error_code error;
    std::filesystem::create_directories(out_dir_, error);
    if (error) {
      throw Failure{kBadInput, fmt::format("cannot make the folder {}: {}; give another --out-dir",
                                           out_dir_, error.message())};
    }
  }

  void measure(Context& context, Moving& moving, live::FrameTracer& tracer,
               std::vector<FrameRecord>& records) {
    const ProgressCallback say = context.progress.callback("frame");
    for (std::uint32_t loop = 0; loop < loops_; ++loop) {
      for (std::size_t f = 0; f < records.size(); ++f) {
        FrameRecord& record = records[f];
        const auto done = static_cast<double>(loop * records.size() + f);
        say(moving.label(f).c_str(), done / (static_cast<double>(records.size()) * loops_));
        moving.rebuild(f);
        record.add(moving.built(),
                   tracer.trace(moving.built().tracer(), moving.mesh(), moving.shot()));
        stop_if_cancelled();
        if (loop + 1 < loops_) continue;
        record.name = moving.label(f);
        record.triangles = moving.mesh().triangle_count;
        context.progress.clear();
        print_frame(context.output, f, record);
        if (!out_dir_.empty()) draw(context, moving, f);
      }
    }
    context.progress.clear();
  }

  void draw(Context& context, const Moving& moving, std::size_t frame) const {
    render::RenderSettings settings;
    settings.width = options_.width;
    settings.height = options_.height;
    settings.camera = moving.shot().camera;
    settings.light = moving.shot().light;
    settings.shadows = options_.shadows;
    settings.memory_limit_bytes = moving.memory_left();
    settings.progress = context.progress.callback("drawing " + moving.label(frame));
    const render::Image image = take(
        render::render(moving.built().tree(), moving.built().tracer(), moving.mesh(), settings));
    const auto path = std::filesystem::path(out_dir_) / fmt::format("frame_{:04}.png", frame);
    check(render::write_png(image, path.string()));
    context.progress.clear();
  }

  void print_frame(Output& output, std::size_t frame, const FrameRecord& record) {
    const std::string label = folder_ ? record.name : std::to_string(frame);
    if (frame == 0) {
      stages_ = record.stage_names;
      std::string header = fmt::format("{:<12} {:>11}", "frame", "triangles");
      for (const std::string& stage : stages_) header += "  " + stage;
      output.line("{}  layout  build ms  trace ms  frame ms    fps", header);
    }
    std::string line = fmt::format("{:<12} {:>11}", label, with_commas(record.triangles));
    for (const std::string& stage : stages_) {
      line += fmt::format("  {:>{}.2f}", record.stage(stage), stage.size());
    }
    const double frame_ms = median(record.frame_ms);
    output.line("{}  {:>6.2f}  {:>8.2f}  {:>8.2f}  {:>8.2f}  {:>5.0f}", line,
                median(record.layout_ms), median(record.build_ms), median(record.trace_ms),
                frame_ms, fps(frame_ms));
  }

  using Times = std::vector<double> FrameRecord::*;

  static double overall(const std::vector<FrameRecord>& records, Times times) {
    std::vector<double> medians;
    for (const FrameRecord& record : records) medians.push_back(median(record.*times));
    return median(medians);
  }

  static double worst(const std::vector<FrameRecord>& records, Times times) {
    double most = 0;
    for (const FrameRecord& record : records) most = std::max(most, median(record.*times));
    return most;
  }

  void summarise(Output& output, const std::vector<FrameRecord>& records) const {
    const auto slowest = std::max_element(
        records.begin(), records.end(),
        [](const auto& a, const auto& b) { return median(a.frame_ms) < median(b.frame_ms); });
    const auto line = [&](const char* what, auto figure) {
      const double frame_ms = figure(records, &FrameRecord::frame_ms);
      output.line("{:<8} build {:.2f} ms, trace {:.2f} ms, frame {:.2f} ms ({:.0f} fps)", what,
                  figure(records, &FrameRecord::build_ms), figure(records, &FrameRecord::trace_ms),
                  frame_ms, fps(frame_ms));
    };
    line("median", overall);
    line("worst", worst);
    output.line("slowest  {}", slowest->name);
  }

  ordered_json json_of_frame(std::size_t frame, const FrameRecord& record) const {
    ordered_json stages = ordered_json::object();
    for (const std::string& stage : record.stage_names) stages[stage] = record.stage(stage);
    const double frame_ms = median(record.frame_ms);
    return {{"frame", frame},
            {"name", record.name},
            {"triangles", record.triangles},
            {"build_ms", median(record.build_ms)},
            {"tree_ms", median(record.tree_ms)},
            {"layout_ms", median(record.layout_ms)},
            {"stages_ms", stages},
            {"trace_ms", median(record.trace_ms)},
            {"primary_ms", median(record.primary_ms)},
            {"shadow_ms", median(record.shadow_ms)},
            {"frame_ms", frame_ms},
            {"fps", fps(frame_ms)},
            {"primary_rays", record.rays.primary_rays},
            {"shadow_rays", record.rays.shadow_rays},
            {"hits", record.rays.hits},
            {"lit", record.rays.lit}};
  }

  void write_files(Context& context, const Moving& moving,
                   const std::vector<FrameRecord>& records) const {
    ordered_json json = json_of_program();
    json["scene"] = moving.name();
    json["source"] = options_.source;
    json["profile"] = to_string(options_.build.settings.profile);
    json["threads"] = context.threads;
    json["width"] = options_.width;
    json["height"] = options_.height;
    json["shadows"] = options_.shadows;
    json["camera"] = json_of(moving.shot().camera);
    json["light"] = json_of(moving.shot().light);
    json["bounds"] = json_of(moving.bounds());
    json["loops"] = loops_;
    json["first_build_ms"] = moving.first_build_ms();
    for (const auto& [key, figure] : {std::pair{"median", &AnimateCommand::overall},
                                      std::pair{"worst", &AnimateCommand::worst}}) {
      json[key] = {{"build_ms", figure(records, &FrameRecord::build_ms)},
                   {"trace_ms", figure(records, &FrameRecord::trace_ms)},
                   {"frame_ms", figure(records, &FrameRecord::frame_ms)},
                   {"fps", fps(figure(records, &FrameRecord::frame_ms))}};
    }
    json["frame_count"] = records.size();
    json["frames"] = ordered_json::array();
    for (std::size_t f = 0; f < records.size(); ++f) {
      json["frames"].push_back(json_of_frame(f, records[f]));
    }
    context.output.json(json, context.common.json);
    if (!csv_.empty()) context.output.file(csv_of(records), csv_);
    if (!svg_.empty()) context.output.file(plot_of(moving.name(), records), svg_);
  }

  std::string csv_of(const std::vector<FrameRecord>& records) const {
    std::vector<std::string> header = {"frame",     "name",      "triangles", "build_ms",
                                       "tree_ms",   "layout_ms", "trace_ms",  "primary_ms",
                                       "shadow_ms", "frame_ms",  "fps"};
    for (const std::string& stage : stages_) header.push_back(stage + "_ms");
    Table table(header);
    for (std::size_t f = 0; f < records.size(); ++f) {
      const FrameRecord& record = records[f];
      std::vector<std::string> row = {std::to_string(f), record.name,
                                      std::to_string(record.triangles)};
      for (const Times times :
           {&FrameRecord::build_ms, &FrameRecord::tree_ms, &FrameRecord::layout_ms,
            &FrameRecord::trace_ms, &FrameRecord::primary_ms, &FrameRecord::shadow_ms,
            &FrameRecord::frame_ms}) {
        row.push_back(fmt::format("{:.4f}", median(record.*times)));
      }
      row.push_back(fmt::format("{:.2f}", fps(median(record.frame_ms))));
      for (const std::string& stage : stages_) {
        row.push_back(fmt::format("{:.4f}", record.stage(stage)));
      }
      table.row(row);
    }
    return table.csv();
  }

  std::string plot_of(const std::string& scene, const std::vector<FrameRecord>& records) const {
    const auto line = [&](const char* label, Times times) {
      PlotLine result{label, {}};
      for (const FrameRecord& record : records) result.values.push_back(median(record.*times));
      return result;
    };
    return line_plot_svg(
        fmt::format("{}: every frame rebuilt, {}, {} x {}", scene,
                    to_string(options_.build.settings.profile), options_.width, options_.height),
        "frame", "milliseconds",
        {line("build", &FrameRecord::build_ms), line("trace", &FrameRecord::trace_ms),
         line("frame: build + trace", &FrameRecord::frame_ms)});
  }

  MovingOptions options_;
  std::uint32_t frames_ = 0;
  std::uint32_t loops_ = 1;
  std::string csv_;
  std::string svg_;
  std::string out_dir_;
  bool folder_ = false;
  std::vector<std::string> stages_;
};

}  // namespace

std::unique_ptr<Command> make_animate_command() {
  return std::make_unique<AnimateCommand>();
}

}  // namespace fasttree::app
