// SPDX-License-Identifier: Apache-2.0
// The figures of an evaluation as tables: the same ones for the page and for the CSV files.
#pragma once

#include <string>
#include <vector>

#include "output.h"
#include "report/evaluation.h"

namespace fasttree::app {

Table scene_table(const Evaluation& evaluation);
Table skipped_table(const Evaluation& evaluation);
Table figure1_table(const Evaluation& evaluation);
Table claim_table(const Evaluation& evaluation);
Table machine_table(const Evaluation& evaluation);
Table stage_table(const Evaluation& evaluation);
Table bandwidth_table(const Evaluation& evaluation);
Table change_table(const Sensitivity& sensitivity);

struct NamedTable {
  std::string name;  ///< of its file, without ".csv"
  Table table;
};
std::vector<NamedTable> all_tables(const Evaluation& evaluation);

}  // namespace fasttree::app
