// SPDX-License-Identifier: Apache-2.0
#include "device/order.h"

namespace fasttree::device {

Order order_of(const BuildSettings& settings) {
  Order order;
  order.profile = settings.profile;
  order.axes = settings.axes;
  order.depth = settings.depth;
  order.extra_depth = settings.extra_depth;
  order.max_growth = settings.max_growth;
  order.memory_limit_bytes = settings.memory_limit_bytes;
  order.sah_costs = settings.sah_costs;
  order.implementation = settings.implementation;
  order.simd = settings.simd;
  return order;
}

BuildSettings settings_of(const Order& order) {
  BuildSettings settings;
  settings.profile = order.profile;
  settings.axes = order.axes;
  settings.depth = order.depth;
  settings.extra_depth = order.extra_depth;
  settings.max_growth = order.max_growth;
  settings.memory_limit_bytes = order.memory_limit_bytes;
  settings.sah_costs = order.sah_costs;
  settings.implementation = order.implementation;
  settings.simd = order.simd;
  return settings;
}

}  // namespace fasttree::device
