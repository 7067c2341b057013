// SPDX-License-Identifier: Apache-2.0
#include "device/device.h"

namespace fasttree::device {
namespace {

constexpr std::chrono::milliseconds kLook{50};

}  // namespace

Result<Outcome> build_on(Device& device, const MeshView& mesh, const Order& order,
                         const ProgressCallback& progress) {
  if (Status s = device.write_scene(mesh); !s.ok()) return s;
  if (Status s = device.start(order); !s.ok()) return s;
  for (;;) {
    if (const auto status = device.wait_for(kLook)) {
      if (!status->ok()) return *status;
      return device.read_result();
    }
    const BuildProgress now = device.progress();
    if (progress && !progress(now.stage.c_str(), now.fraction)) device.cancel();
  }
}

}  // namespace fasttree::device
