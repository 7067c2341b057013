// SPDX-License-Identifier: Apache-2.0
// fasttree serve: the board's side. Builds trees for whoever asks over the network, one at a time.
#include <csignal>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command.h"
#include "device/engines/local_device.h"
#include "device/net/server.h"
#include "devices.h"
#include "inputs.h"
#include "model/config/machine_config.h"
#include "options.h"
#include "output.h"
#include "progress.h"

namespace fasttree::app {
namespace {

using nlohmann::ordered_json;

enum class EngineChoice { library, model, rtl };

class ServeCommand : public Command {
 public:
  const char* name() const override { return "serve"; }
  const char* summary() const override { return "Build trees for others, over the network"; }
  const char* details() const override {
    return "Does what a board with the accelerator would do: takes a scene over UDP, builds its "
           "tree\n"
           "and sends it back, one session at a time; others are told that it is busy. The other "
           "side is\n"
           "fasttree build, verify or render with --device. docs/protocol.md describes the "
           "frames.\n"
           "It listens to this machine alone unless --listen says otherwise. There is no "
           "encryption and\n"
           "nobody is asked who they are: listen to networks you trust. Ctrl-C ends it.\n\n"
           "Example:\n"
           "  fasttree serve --engine model --config paper-fpga\n"
           "  fasttree build bunny.ply --device udp://127.0.0.1:18004     (in another terminal)";
  }

  void declare(Options& options) override {
    memory_limit_ = most_of_memory();
    options.choice(engine_, "--engine", "Who builds: the library, the machine's model, or its RTL",
                   Choices<EngineChoice>{{"library", EngineChoice::library},
                                         {"model", EngineChoice::model},
                                         {"rtl", EngineChoice::rtl}});
    options.text(config_, "--config", "NAME|FILE",
                 "The machine, for model and rtl; paper-asic65 where there is none");
    options.texts(set_, "--set", "SECTION.KEY=VALUE", "Change a key; may be given again");
    options.text(listen_, "--listen", "ADDRESS:PORT",
                 "Where to listen; 0.0.0.0 for every network, port 0 for any that is free");
    options.size(memory_limit_, "--memory-limit",
                 "Memory for a scene, and with engine library for its build, such as 512M; larger "
                 "ones are refused. A machine has what its configuration says",
                 bytes_text(memory_limit_));
    options.number(timeout_s_, "--timeout", "Seconds of silence after which a client is given up",
                   0.1, 60);
    options.count(payload_, "--payload", "Most bytes of a scene in a frame; clients may want less",
                  device::kLeastPayload, device::kLargestPayload);
    options.count(sessions_, "--sessions", "End after so many; 0: at Ctrl-C", 0, ~std::uint64_t{0});
  }

  int run(Context& context) override {
    device::LocalDevice engine(make_engine(), context.threads);
    device::ServeSettings settings;
    settings.listen = take(device::parse_address(listen_));
    settings.memory_limit_bytes = memory_limit_;
    settings.payload = payload_;
    settings.timeout_ms = static_cast<std::uint32_t>(timeout_s_ * 1000);
    settings.program = "fasttree " FASTTREE_VERSION;
    const auto server = take(device::Server::open(settings, engine));
    const device::Description what = take(engine.describe());
    context.output.line("listening            {}", server->address().text());
    context.output.line("engine               {}{}{}", what.engine, what.config.empty() ? "" : " ",
                        what.config);
    context.output.line("scenes               up to {}", bytes_text(server->most_scene_bytes()));
    context.output.finish();  // somebody may be waiting for the port

    // A service manager's way of saying Ctrl-C.
    std::signal(SIGTERM, [](int) { std::raise(SIGINT); });
    const ProgressCallback show = context.progress.callback("building");
    server->run(
        [&] {
          if (const auto progress = server->progress()) {
            show(progress->stage.c_str(), progress->fraction);
          }
          return !cancelled() && (sessions_ == 0 || served_ + failed_ < sessions_);
        },
        [&](const device::SessionEnd& end) { tell(context, end); });
    return finish(context, *server, what);
  }

 private:
  device::Engine make_engine() const {
    if (engine_ == EngineChoice::library) {
      if (!config_.empty() || !set_.empty()) {
        throw Failure{kUsage, "--config and --set are for --engine model or rtl"};
      }
      return device::library_engine();
    }
    model::MachineConfig config =
        take(model::load_config(config_.empty() ? "paper-asic65" : config_));
    for (const std::string& assignment : set_) check(apply_override(config, assignment));
    if (engine_ == EngineChoice::model) return device::model_engine(config);
    return take(device::rtl_engine(config));
  }

  void tell(Context& context, const device::SessionEnd& end) {
    ++(end.status.ok() ? served_ : failed_);
    scene_bytes_ += end.scene_bytes;
    result_bytes_ += end.result_bytes;
    context.progress.clear();
    context.output.line(
        "{:<20} {} triangles, {}", text_of(end.peer),
        with_commas(end.scene_bytes / device::kTriangleBytes),
        end.status.ok() ? bytes_text(end.result_bytes) + " of tree" : end.status.message());
    context.output.finish();
  }

  int finish(Context& context, const device::Server& server, const device::Description& what) {
    context.progress.clear();
    const device::LinkCounts& link = server.counts();
    context.output.line("served               {} sessions, {} others failed", with_commas(served_),
                        with_commas(failed_));
    context.output.line("frames               {} received, {} sent, {} dropped",
                        with_commas(link.frames_received), with_commas(link.frames_sent),
                        with_commas(link.dropped()));
    ordered_json json = json_of_program();
    json["listening"] = server.address().text();
    json["engine"] = what.engine;
    json["config"] = what.config.empty() ? ordered_json(nullptr) : ordered_json(what.config);
    json["sessions"] = served_ + failed_;
    json["served"] = served_;
    json["failed"] = failed_;
    json["scene_bytes"] = scene_bytes_;
    json["result_bytes"] = result_bytes_;
    json["link"] = json_of(link);
    context.output.json(json, context.common.json);
    return kDone;
  }

  EngineChoice engine_ = EngineChoice::library;
  std::string config_;
  std::vector<std::string> set_;
  std::string listen_ = "127.0.0.1:18004";
  std::uint64_t memory_limit_ = 0;
  double timeout_s_ = 5;
  std::uint32_t payload_ = device::kLargestPayload;
  std::uint64_t sessions_ = 0;

  std::uint64_t served_ = 0, failed_ = 0;
  std::uint64_t scene_bytes_ = 0, result_bytes_ = 0;
};

}  // namespace

std::unique_ptr<Command> make_serve_command() {
  return std::make_unique<ServeCommand>();
}

}  // namespace fasttree::app
