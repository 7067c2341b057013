// SPDX-License-Identifier: Apache-2.0
// What the units of a machine cost, in whatever is counted: gates, bits of memory, energy.
#pragma once

#include <string>
#include <vector>

namespace fasttree::model {

/// A row a unit; the total is the sum of the rows, column by column.
struct CostTable {
  struct Column {
    std::string key;    ///< of the JSON, with the unit in it: "sram_bits", "dynamic_uj"
    std::string title;  ///< for a person: "SRAM, bits"
    int digits = 0;     ///< after the point
  };
  struct Row {
    std::string unit;
    std::vector<double> values;  ///< a column
  };

  /// A figure of the whole, beside the columns.
  struct Figure {
    std::string key;
    std::string title;
    double value = 0;
    int digits = 0;
  };

  std::string key;  ///< of the JSON: "area"
  std::string title;
  std::string basis;  ///< what the model rests on and what it leaves out, in a sentence or two
  std::vector<Column> columns;
  std::vector<Row> rows;
  std::vector<Figure> figures;

  double total(std::size_t column) const {
    double sum = 0;
    for (const Row& row : rows) sum += row.values[column];
    return sum;
  }
};

}  // namespace fasttree::model
