// SPDX-License-Identifier: Apache-2.0
// The sections of a machine's configuration, for reading, overriding and writing alike.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "model/config/fields.h"
#include "model/config/machine_config.h"

namespace fasttree::model {

struct Section {
  std::string name;  ///< empty: the keys before the first section
  std::string comment;
  std::string architecture;  ///< the only one it belongs to; empty: all
  std::vector<Field> fields;
  std::function<void*(MachineConfig&)> of;  ///< its struct inside the configuration
};

/// In the order they are written out; made once.
const std::vector<Section>& config_sections();

/// Sets one field after checking what is allowed. `where` opens the message ("line 3: ").
Status set_field(const Section& section, const Field& field, MachineConfig& config,
                 const FieldValue& value, const std::string& where);

/// What a field may hold, in words: "1 to 64", "one of burst, row".
std::string allowed(const Field& field);

/// A field's value as --set takes it: "true", "16", "0.5", "burst".
std::string text_of(const FieldValue& value);

/// The word nearest to `word` by edit distance, or empty where none is near.
std::string nearest_word(const std::string& word, const std::vector<std::string>& words);

}  // namespace fasttree::model
