// SPDX-License-Identifier: Apache-2.0
// Whom a lane may wait for, in the order of its stall reasons.
#pragma once

#include <cstddef>

namespace fasttree::model::ft2 {

enum LaneReason : std::size_t { kRecords, kOrder, kMemory, kNodes, kBack };

}  // namespace fasttree::model::ft2
