// SPDX-License-Identifier: Apache-2.0
#include "device/engines/local_device.h"

#include <oneapi/tbb/task_arena.h>

#include <utility>

namespace fasttree::device {

LocalDevice::LocalDevice(Engine engine, int threads)
    : engine_(std::move(engine)), threads_(threads) {}

Result<Description> LocalDevice::describe() {
  Description description;
  description.engine = engine_.name;
  description.config = engine_.config;
  description.program = "fasttree, in this process";
  description.most_scene_bytes = engine_.most_scene_bytes;
  description.busy = job_.runs();
  return description;
}

Status LocalDevice::write_scene(const MeshView& mesh) {
  if (job_.runs()) return {StatusCode::invalid_argument, "a build still runs on the device"};
  if (Status s = validate(mesh); !s.ok()) return s;
  mesh_ = mesh;
  return {};
}

Status LocalDevice::start(const Order& order, std::function<void()> ended) {
  if (job_.runs()) return {StatusCode::invalid_argument, "a build still runs on the device"};
  if (!mesh_) return {StatusCode::invalid_argument, "the device has no scene; write one first"};
  outcome_.reset();
  job_.start(
      [this, order](const ProgressCallback& progress) -> Status {
        oneapi::tbb::task_arena arena(threads_ > 0 ? threads_ : oneapi::tbb::task_arena::automatic);
        Result<Outcome> outcome =
            arena.execute([&] { return engine_.build(*mesh_, order, progress); });
        if (!outcome.ok()) return outcome.status();
        outcome_ = std::move(outcome).value();
        return {};
      },
      std::move(ended));
  return {};
}

std::optional<Status> LocalDevice::wait_for(std::chrono::milliseconds time) {
  return job_.wait_for(time);
}

Result<Outcome> LocalDevice::read_result() {
  if (job_.runs() || !outcome_) {
    return Status(StatusCode::invalid_argument, "the device has no result to read");
  }
  Outcome outcome = std::move(*outcome_);
  outcome_.reset();
  return outcome;
}

}  // namespace fasttree::device
