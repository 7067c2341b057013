// SPDX-License-Identifier: Apache-2.0
// Somebody who builds trees when asked to, wherever it is: a builder in this process, a simulated
// machine, or whatever answers at an address.
#pragma once

#include <chrono>
#include <functional>
#include <optional>

#include "device/link/messages.h"
#include "device/order.h"
#include "fasttree/build.h"
#include "fasttree/mesh.h"
#include "fasttree/status.h"

namespace fasttree::device {

/// As a driver has it: write the scene, start, wait, read. One build at a time. To be called from
/// one thread, cancel() and progress() from any.
class Device {
 public:
  virtual ~Device() = default;

  virtual Result<Description> describe() = 0;

  /// Takes the scene for the next builds. The mesh is viewed, and has to stay as it is while they
  /// run.
  virtual Status write_scene(const MeshView& mesh) = 0;

  /// Starts a build and returns. `ended` is called when it is over, from another thread.
  /// invalid_argument: no scene, or a build runs.
  virtual Status start(const Order& order, std::function<void()> ended = {}) = 0;

  /// Waits until the build is over, at most so long. Nothing: it still runs.
  virtual std::optional<Status> wait_for(std::chrono::milliseconds time) = 0;

  virtual BuildProgress progress() const = 0;

  /// Asks the build to end soon, with status cancelled.
  virtual void cancel() = 0;

  /// Of a build that ended well; once, it is handed over. Its links are unchecked: see verify().
  virtual Result<Outcome> read_result() = 0;
};

/// Writes, starts, waits and reads; `progress` as in BuildSettings.
Result<Outcome> build_on(Device& device, const MeshView& mesh, const Order& order,
                         const ProgressCallback& progress = {});

}  // namespace fasttree::device
