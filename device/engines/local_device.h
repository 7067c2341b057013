// SPDX-License-Identifier: Apache-2.0
// A device in this process: an engine in a thread of its own.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "device/device.h"
#include "device/engines/engine.h"
#include "device/engines/job.h"

namespace fasttree::device {

class LocalDevice : public Device {
 public:
  /// Builds on so many threads; 0: all.
  LocalDevice(Engine engine, int threads);

  Result<Description> describe() override;
  Status write_scene(const MeshView& mesh) override;
  Status start(const Order& order, std::function<void()> ended) override;
  std::optional<Status> wait_for(std::chrono::milliseconds time) override;
  BuildProgress progress() const override { return job_.progress(); }
  void cancel() override { job_.cancel(); }
  Result<Outcome> read_result() override;

 private:
  Engine engine_;
  int threads_;
  std::optional<MeshView> mesh_;
  std::optional<Outcome> outcome_;
  Job job_;  ///< last: its thread uses the others
};

}  // namespace fasttree::device
