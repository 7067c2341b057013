// SPDX-License-Identifier: Apache-2.0
// An evaluation as JSON, in full precision and with the units in the names of the keys.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "report/evaluation.h"

namespace fasttree::app {

nlohmann::ordered_json json_of(const Evaluation& evaluation);

}  // namespace fasttree::app
