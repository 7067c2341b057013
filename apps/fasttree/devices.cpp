// SPDX-License-Identifier: Apache-2.0
#include "devices.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "device/engines/local_device.h"
#include "device/net/remote_device.h"
#include "fasttree/verify.h"
#include "inputs.h"
#include "progress.h"

namespace fasttree::app {
namespace {

using device::Device;
using nlohmann::ordered_json;

// "library", "model", "rtl", "model:CONFIG", "rtl:CONFIG"; null where it is something else.
std::unique_ptr<Device> open_local(const std::string& spec, int threads) {
  const std::size_t colon = spec.find(':');
  const std::string engine = spec.substr(0, colon);
  if (engine != "library" && engine != "model" && engine != "rtl") return nullptr;
  const std::string config = colon == std::string::npos ? "" : spec.substr(colon + 1);
  return std::make_unique<device::LocalDevice>(take(device::make_engine(engine, config)), threads);
}

}  // namespace

void DeviceOptions::declare(Options& options) {
  options.text(device_, "--device", "DEVICE",
               "Take the tree from a device: udp://HOST:PORT, where fasttree serve runs, or "
               "library, model:CONFIG, rtl:CONFIG in this process");
  options.count(payload_, "--device-payload",
                "Most bytes of a scene in a frame; 1440 fits Ethernet, 8928 jumbo frames, 65448 "
                "loopback",
                device::kLeastPayload, device::kLargestPayload);
  options.number(timeout_s_, "--device-timeout",
                 "Seconds of silence after which the device is given up", 0.1, 60);
  options.number(wait_s_, "--device-wait",
                 "Seconds to wait for a device that is busy with another session", 0, 86400);
}

DeviceTree DeviceOptions::build(Context& context, const MeshView& mesh,
                                const BuildSettings& settings) const {
  DeviceTree built;
  std::unique_ptr<Device> device = open_local(device_, context.threads);
  device::RemoteDevice* remote = nullptr;
  if (!device) {
    device::ClientSettings client;
    client.payload = payload_;
    client.timeout_ms = static_cast<std::uint32_t>(timeout_s_ * 1000);
    client.patience_ms = static_cast<std::uint32_t>(wait_s_ * 1000);
    if (settings.memory_limit_bytes > 0) client.most_result_bytes = settings.memory_limit_bytes;
    auto owned =
        std::make_unique<device::RemoteDevice>(take(device::parse_address(device_)), client);
    remote = owned.get();
    device = std::move(owned);
  }
  built.device = take(device->describe());
  const auto start = std::chrono::steady_clock::now();
  device::Outcome outcome =
      take(device::build_on(*device, mesh, device::order_of(settings),
                            context.progress.callback(built.device.engine + ":")));
  built.total_ms = milliseconds_since(start);
  built.tree = std::move(outcome.tree);
  built.counters = std::move(outcome.counters);
  if (remote != nullptr) built.link = remote->counts();
  stop_if_cancelled();
  return built;
}

void check_tree_of(const DeviceTree& built, const MeshView& mesh) {
  const Verification verification = verify(built.tree, mesh);
  if (verification.ok) return;
  throw Failure{kBadInput, fmt::format("the device's tree breaks the invariant '{}': {}; see "
                                       "fasttree verify --device",
                                       verification.invariant, verification.detail)};
}

ordered_json json_of(const device::LinkCounts& counts) {
  return {{"frames_sent", counts.frames_sent},
          {"frames_received", counts.frames_received},
          {"data_bytes_sent", counts.data_bytes_sent},
          {"data_bytes_received", counts.data_bytes_received},
          {"retransmitted", counts.retransmitted},
          {"timeouts", counts.timeouts},
          {"bad_length", counts.bad_length},
          {"bad_checksum", counts.bad_checksum},
          {"bad_type", counts.bad_type},
          {"bad_content", counts.bad_content},
          {"wrong_session", counts.wrong_session},
          {"out_of_window", counts.out_of_window},
          {"duplicates", counts.duplicates}};
}

ordered_json json_of(const DeviceTree& built) {
  ordered_json stages = ordered_json::array();
  for (const device::StageCount& stage : built.counters.stages) {
    ordered_json entry = {{"stage", stage.stage}};
    if (built.counters.cycles > 0) {
      entry["begin_cycle"] = stage.begin_cycle;
      entry["end_cycle"] = stage.end_cycle;
    } else {
      entry["time_ms"] = stage.ms;
    }
    stages.push_back(std::move(entry));
  }
  const bool machine = built.counters.cycles > 0;
  return {{"engine", built.device.engine},
          {"config",
           built.device.config.empty() ? ordered_json(nullptr) : ordered_json(built.device.config)},
          {"program", built.device.program},
          {"cycles", machine ? ordered_json(built.counters.cycles) : ordered_json(nullptr)},
          {"clock_mhz", machine ? ordered_json(built.counters.clock_mhz) : ordered_json(nullptr)},
          {"build_ms", built.counters.build_ms},
          {"total_ms", built.total_ms},
          {"stages", stages},
          {"link", built.link ? json_of(*built.link) : ordered_json(nullptr)}};
}

void print_device(Output& output, const DeviceTree& built) {
  output.line("device               {}{}{} ({})", built.device.engine,
              built.device.config.empty() ? "" : " ", built.device.config, built.device.program);
  const device::Counters& counters = built.counters;
  if (counters.cycles > 0) {
    output.line("cycles               {} at {:g} MHz", with_commas(counters.cycles),
                counters.clock_mhz);
  }
  output.line("order to tree        {:.1f} ms, {:.2f} ms of them the build{}", built.total_ms,
              counters.build_ms, counters.cycles > 0 ? ", had it been the machine" : "");
  if (!built.link) return;
  const device::LinkCounts& link = *built.link;
  output.line("network              {} sent, {} received; {} frames sent again, {} dropped",
              bytes_text(link.data_bytes_sent), bytes_text(link.data_bytes_received),
              with_commas(link.retransmitted), with_commas(link.dropped()));
}

}  // namespace fasttree::app
