// SPDX-License-Identifier: Apache-2.0
// The paper's Table I beside what synthesis makes of the RTL.
#pragma once

#include <string>

#include "command.h"

namespace fasttree::app {

/// Prints it, and writes it as CSV and JSON where asked for. 0, or 1 where the design is larger
/// than the paper's.
int reproduce_table1(Context& context, const std::string& csv);

}  // namespace fasttree::app
