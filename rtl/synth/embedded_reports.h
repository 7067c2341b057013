// SPDX-License-Identifier: Apache-2.0
// The committed figures of synthesis, as the program has them.
#pragma once

#include <string_view>

namespace fasttree::rtl {

/// JSON: {"units": [units.json], "reasons": {row: text}, "reports": [reports of the units]}.
std::string_view embedded_synthesis();

}  // namespace fasttree::rtl
