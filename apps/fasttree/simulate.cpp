// SPDX-License-Identifier: Apache-2.0
// fasttree simulate: a scene's tree from the cycle-level model of an accelerator, with the account
// of every cycle and byte.
#include "model/report/simulate.h"

#include <charconv>
#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command.h"
#include "fasttree/tree_file.h"
#include "inputs.h"
#include "model/config/machine_config.h"
#include "model/report/costs.h"
#include "model/report/first_difference.h"
#include "model/report/html_report.h"
#include "model/report/report_csv.h"
#include "model/report/report_json.h"
#include "model/report/timeline_json.h"
#include "options.h"
#include "output.h"
#include "progress.h"
#include "rtl/engine/rtl_machine.h"
#include "simulate_report.h"

namespace fasttree::app {
namespace {

using model::MachineConfig;
using nlohmann::ordered_json;

// Windows of the timeline: a trace can be zoomed into, a page cannot.
constexpr std::uint32_t kTraceWindows = 2000;
constexpr std::uint32_t kPageWindows = 400;

class SimulateCommand : public Command {
 public:
  const char* name() const override { return "simulate"; }
  const char* summary() const override { return "Build a tree on the accelerator: model or RTL"; }
  const char* details() const override {
    return "Runs a scene through the machine of a configuration, cycle by cycle: the machine of "
           "the\n"
           "paper (paper-fpga, paper-asic65, paper-asic28) or fasttree-2, ours. Says for how many\n"
           "cycles each unit was busy, stalled and on whom, and idle, and what went to memory and\n"
           "back. No key of a configuration changes the tree but those of the grid (axes, "
           "depth).\n"
           "--engine rtl runs the SystemVerilog instead, through Verilator, with the same reports\n"
           "and a memory of the same timing; --wave writes its waveforms.\n\n"
           "Example:\n"
           "  fasttree simulate bunny.ply --config paper-asic65 --verify --html bunny.html\n"
           "  fasttree simulate bunny.ply --config paper-asic65 --set "
           "paper.bus_bytes_per_cycle=32\n"
           "  fasttree simulate bunny.ply --config paper-fpga --engine rtl --wave 1000:3000 "
           "\\\n    --wave-file bunny.fst\n"
           "  fasttree simulate --config fasttree-2 --print-config";
  }

  void declare(Options& options) override {
    options.positional(scene_, "SCENE", "A mesh file, or scene:NAME", false);
    options.text(config_, "--config", "NAME|FILE", "The machine: a name, or a TOML file");
    options.texts(set_, "--set", "SECTION.KEY=VALUE", "Change a key; may be given again");
    options.choice(rtl_, "--engine", "What runs: the cycle-level model, or the RTL",
                   Choices<bool>{{"model", false}, {"rtl", true}});
    options.text(wave_, "--wave", "FROM:TO", "Write waveforms of these cycles (engine rtl)");
    options.text(wave_file_, "--wave-file", "FILE",
                 "Where to: FST, which GTKWave opens (fasttree.fst)");
    options.flag(list_, "--list-configs", "Name the configurations, and stop");
    options.flag(print_, "--print-config",
                 "Print the configuration as TOML, with what each key means, and stop");
    options.flag(verify_, "--verify",
                 "Compare every array and the tree with the reference builder's");
    options.count(max_cycles_, "--max-cycles", "Give up after so many cycles; 0: never", 0,
                  ~std::uint64_t{0});
    options.text(out_, "--out", "FILE", "Save the tree that the machine has built");
    options.text(csv_, "--csv", "FILE", "Write a row a stage and unit");
    options.text(timeline_, "--timeline", "FILE", "Write a Chrome trace, which Perfetto opens");
    options.text(html_, "--html", "FILE", "Write a page with plots and tables");
  }

  int run(Context& context) override {
    if (list_) return list(context);
    model::SimulationReport report;
    report.config = configuration();
    report.engine = rtl_ ? "rtl" : "model";
    const rtl::RtlOptions rtl_options = waves();
    if (print_) {
      context.output.write(to_toml(report.config));
      return kDone;
    }
    if (scene_.empty()) throw Failure{kUsage, "SCENE is required; see fasttree simulate --help"};

    const LoadedScene scene = load_scene(context, scene_, most_of_memory());
    report.scene = scene.mesh.name;
    simulate(context, scene.view, rtl_options, report);
    if (verify_) {
      report.compared = true;
      report.difference = take(first_difference(scene.view, report.config, report.result,
                                                context.progress.callback("reference:")));
    }
    report.costs = cost_tables(report.config, report.result);
    context.progress.clear();
    print_simulation(context.output, report);
    if (!out_.empty()) {
      check(save_tree(report.result.tree, out_));
      context.output.line("saved                {}", out_);
    }
    if (!rtl_options.wave_file.empty()) {
      context.output.line("waveforms            {}", rtl_options.wave_file);
    }
    write(context.output, csv_, model::report_csv, report);
    write(context.output, timeline_, model::timeline_json, report);
    write(context.output, html_, model::html_report, report);
    write_json(context, report);
    return report.difference.empty() ? kDone : kCheckFailed;
  }

 private:
  MachineConfig configuration() const {
    MachineConfig config = take(model::load_config(config_));
    for (const std::string& assignment : set_) check(apply_override(config, assignment));
    return config;
  }

  // "FROM:TO", cycles of the build; either may be left out.
  rtl::RtlOptions waves() const {
    rtl::RtlOptions options;
    if (wave_.empty()) {
      if (wave_file_.empty()) return options;
      throw Failure{kUsage, "--wave-file needs to know of which cycles: --wave FROM:TO"};
    }
    if (!rtl_) throw Failure{kUsage, "--wave is for --engine rtl: the model has no waveforms"};
    const std::size_t colon = wave_.find(':');
    const auto read = [&](const std::string& text, std::uint64_t& value) {
      if (text.empty()) return;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
      if (error != std::errc() || end != text.data() + text.size()) wrong_wave();
    };
    if (colon == std::string::npos) wrong_wave();
    read(wave_.substr(0, colon), options.wave_from);
    read(wave_.substr(colon + 1), options.wave_to);
    if (options.wave_from >= options.wave_to) wrong_wave();
    options.wave_file = wave_file_.empty() ? "fasttree.fst" : wave_file_;
    return options;
  }
  [[noreturn]] void wrong_wave() const {
    throw Failure{kUsage, "--wave " + wave_ +
                              " is not FROM:TO, two cycles of the build, the first " +
                              "less than the second, such as 1000:3000"};
  }

  void simulate(Context& context, const MeshView& mesh, const rtl::RtlOptions& rtl_options,
                model::SimulationReport& report) const {
    model::SimulationOptions options;
    options.keep_arrays = verify_;
    options.timeline_windows = !timeline_.empty() ? kTraceWindows
                               : !html_.empty()   ? kPageWindows
                                                  : 0;
    options.max_cycles = max_cycles_;
    options.progress = context.progress.callback("simulating:");
    const auto start = std::chrono::steady_clock::now();
    report.result = take(rtl_ ? rtl::simulate_rtl(mesh, report.config, options, rtl_options)
                              : model::simulate(mesh, report.config, options));
    report.wall_s = milliseconds_since(start) / 1000;
    stop_if_cancelled();
    if (!wave_.empty() && rtl_options.wave_from >= report.result.cycles) {
      throw Failure{kUsage, fmt::format("--wave {} begins after the build's {} cycles: there are "
                                        "no waveforms of it",
                                        wave_, report.result.cycles)};
    }
  }

  static void write(Output& output, const std::string& path,
                    std::string (*text)(const model::SimulationReport&),
                    const model::SimulationReport& report) {
    if (path.empty()) return;
    output.file(text(report), path);
    output.line("written              {}", path);
  }

  void write_json(const Context& context, const model::SimulationReport& report) const {
    if (context.common.json.empty()) return;
    ordered_json json = json_of_program();
    json["source"] = scene_;
    json.update(report_json(report));
    context.output.json(json, context.common.json);
  }

  static int list(Context& context) {
    ordered_json configs = ordered_json::array();
    Table table({"configuration", "architecture", "clock, MHz", "memory"});
    for (const std::string& name : model::config_names()) {
      const MachineConfig config = take(model::load_config(name));
      table.row(
          {name, config.architecture, fmt::format("{}", config.clock_mhz), config.memory.preset});
      configs.push_back({{"config", name},
                         {"architecture", config.architecture},
                         {"clock_mhz", config.clock_mhz},
                         {"memory", config.memory.preset}});
    }
    table.print(context.output);
    ordered_json json = json_of_program();
    json["configs"] = configs;
    context.output.json(json, context.common.json);
    return kDone;
  }

  std::string scene_;
  std::string config_ = "paper-asic65";
  std::vector<std::string> set_;
  bool rtl_ = false;
  std::string wave_;
  std::string wave_file_;
  bool list_ = false;
  bool print_ = false;
  bool verify_ = false;
  std::uint64_t max_cycles_ = 0;
  std::string out_, csv_, timeline_, html_;
};

}  // namespace

std::unique_ptr<Command> make_simulate_command() {
  return std::make_unique<SimulateCommand>();
}

}  // namespace fasttree::app
