// SPDX-License-Identifier: Apache-2.0
#include "model/report/simulation.h"

namespace fasttree::model {

double SimulationResult::time_ms() const {
  return clock_mhz > 0 ? static_cast<double>(cycles) / clock_mhz / 1e3 : 0;
}

}  // namespace fasttree::model
