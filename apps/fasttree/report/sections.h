// SPDX-License-Identifier: Apache-2.0
// The sections of an evaluation's page.
#pragma once

#include <string>
#include <vector>

#include "report/evaluation.h"
#include "report/html.h"

namespace fasttree::app {

// What the paper prints.
report::PageSection scenes_section(const Evaluation& evaluation);
report::PageSection figure1_section(const Evaluation& evaluation);
report::PageSection table1_section(const Evaluation& evaluation);
report::PageSection table2_section(const Evaluation& evaluation);
report::PageSection table3_section(const Evaluation& evaluation);
report::PageSection text_section(const Evaluation& evaluation);

// What it leaves open.
report::PageSection machines_section(const Evaluation& evaluation);
report::PageSection stages_section(const Evaluation& evaluation);
report::PageSection bandwidth_section(const Evaluation& evaluation);
report::PageSection assumptions_section(const Evaluation& evaluation);
report::PageSection method_section(const Evaluation& evaluation);

/// The whole page.
std::string page_of(const Evaluation& evaluation);

}  // namespace fasttree::app
