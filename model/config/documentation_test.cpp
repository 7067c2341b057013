// SPDX-License-Identifier: Apache-2.0
// docs/configurations.md lists every key of a configuration as it is: what it is by default, what
// is allowed, what it means.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "model/config/sections.h"

namespace fasttree::model {
namespace {

/// A key's row in the page's table of its section.
std::string row_of(const Section& section, const Field& field) {
  MachineConfig config;
  const std::string value = text_of(field.get(section.of(config)));
  return "| `" + field.key + "` | " + (value.empty() ? "-" : value) + " | " + allowed(field) +
         " | " + field.comment + " |";
}

/// Rows of keys below the heading of a section, up to the next heading.
std::vector<std::string> rows_of(const std::string& section) {
  std::ifstream page(FASTTREE_CONFIGURATIONS_PAGE);
  std::vector<std::string> rows;
  const std::string heading =
      section.empty() ? "### Before the sections" : "### `[" + section + "]`";
  bool inside = false;
  for (std::string line; std::getline(page, line);) {
    if (line.rfind("#", 0) == 0) inside = line == heading;
    if (inside && line.rfind("| `", 0) == 0) rows.push_back(line);
  }
  return rows;
}

TEST(ConfigurationsPage, HasEveryKeyOfEverySectionAndNoOther) {
  for (const Section& section : config_sections()) {
    std::vector<std::string> expected;
    std::string table;
    for (const Field& field : section.fields) {
      expected.push_back(row_of(section, field));
      table += expected.back() + "\n";
    }
    EXPECT_EQ(rows_of(section.name), expected)
        << "The table of [" << section.name << "] has to be:\n"
        << table;
  }
}

}  // namespace
}  // namespace fasttree::model
