// SPDX-License-Identifier: Apache-2.0
// fasttree reproduce all: the paper's whole evaluation as one page.
#pragma once

#include <string>

#include "command.h"
#include "report/evaluation.h"

namespace fasttree::app {

/// Evaluates, and writes report.html, report.json and a CSV file a table into the folder, which is
/// made where it is not there. Without scenes built-in ones stand in. 0; or 1 where a machine built
/// another tree than the library, or a ratio of Table II is further from 1 than `within_percent`.
int reproduce_all(Context& context, EvaluationSettings settings, const std::string& folder,
                  std::optional<double> within_percent);

}  // namespace fasttree::app
