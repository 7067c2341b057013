// SPDX-License-Identifier: Apache-2.0
// A device at the other end of a network.
#pragma once

#include <memory>
#include <optional>

#include "device/device.h"
#include "device/engines/job.h"
#include "device/link/client_session.h"
#include "device/link/counts.h"
#include "device/net/address.h"

namespace fasttree::device {

/// Every build is a session of its own: the scene goes when the build starts. Errors of the network
/// are io_error, and say who did not answer.
class RemoteDevice : public Device {
 public:
  explicit RemoteDevice(const Address& address, const ClientSettings& settings = {});

  Result<Description> describe() override;
  Status write_scene(const MeshView& mesh) override;
  Status start(const Order& order, std::function<void()> ended) override;
  std::optional<Status> wait_for(std::chrono::milliseconds time) override;
  BuildProgress progress() const override { return job_.progress(); }
  void cancel() override { job_.cancel(); }
  Result<Outcome> read_result() override;

  /// Of all sessions that have ended.
  const LinkCounts& counts() const { return counts_; }

 private:
  Status run_session(const Order& order, const ProgressCallback& progress);
  Status at_device(const Status& status) const;

  Address address_;
  ClientSettings settings_;
  std::optional<MeshView> mesh_;
  std::optional<Outcome> outcome_;
  LinkCounts counts_;
  Job job_;  ///< last: its thread uses the others
};

}  // namespace fasttree::device
