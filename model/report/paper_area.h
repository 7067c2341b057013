// SPDX-License-Identifier: Apache-2.0
// The structure of the paper's units, counted, against Table I.
#pragma once

#include "model/config/paper_config.h"
#include "model/report/area.h"

namespace fasttree::model {

/// One row of the account: what is counted, and the rest of Table I's row that no count explains
/// (control, mostly). The rest grows with the number of units and with nothing else.
struct PaperAreaRow {
  const char* kind = "";
  std::uint32_t count = 1;
  Resources counted;  ///< of all units
  Resources rest;     ///< of all units
};

std::vector<PaperAreaRow> paper_area_rows(const PaperConfig& config);

/// The last row of Table I.
Resources paper_area_total();

}  // namespace fasttree::model
