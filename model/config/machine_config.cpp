// SPDX-License-Identifier: Apache-2.0
// Reading a machine's configuration: TOML against the declared sections.
#include "model/config/machine_config.h"

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

// Errors come back as values; the library throws nothing.
#define TOML_EXCEPTIONS 0
#define TOML_HEADER_ONLY 1
// The parser of toml++ 3.3 tells the compiler that keys begin properly, and only then looks: a
// wrong one would be undefined behaviour instead of an error. It may assume nothing here.
#include <toml++/impl/preprocessor.h>
#undef TOML_ASSERT_ASSUME
#define TOML_ASSERT_ASSUME(expression) static_assert(true)
#include <toml++/toml.h>

#include "model/config/embedded_configs.h"
#include "model/config/sections.h"

namespace fasttree::model {
namespace {

/// A configuration is a page of text; what is longer is something else.
constexpr std::size_t kMaxBytes = std::size_t{1} << 20;

Status refuse(const std::string& message) {
  return Status(StatusCode::bad_input, message);
}

std::vector<std::string> keys_of(const Section& section) {
  std::vector<std::string> keys;
  for (const Field& field : section.fields) keys.push_back(field.key);
  return keys;
}

const Field* find_field(const Section& section, std::string_view key) {
  for (const Field& field : section.fields) {
    if (field.key == key) return &field;
  }
  return nullptr;
}

const Section* find_section(std::string_view name) {
  for (const Section& section : config_sections()) {
    if (section.name == name) return &section;
  }
  return nullptr;
}

std::string hint(const std::string& word, const std::vector<std::string>& words) {
  const std::string near = nearest_word(word, words);
  return near.empty() ? "" : "; did you mean '" + near + "'?";
}

std::string in_section(const Section& section) {
  return section.name.empty() ? "" : " of [" + section.name + "]";
}

/// What cannot be a value at all (a date, an array) becomes nothing.
std::optional<FieldValue> value_of(const toml::node& node) {
  if (const auto* b = node.as_boolean()) return FieldValue(b->get());
  if (const auto* i = node.as_integer()) {
    // A negative number is no count, but may be a real one out of range.
    if (i->get() < 0) return FieldValue(static_cast<double>(i->get()));
    return FieldValue(static_cast<std::uint64_t>(i->get()));
  }
  if (const auto* d = node.as_floating_point()) return FieldValue(d->get());
  if (const auto* s = node.as_string()) return FieldValue(s->get());
  return std::nullopt;
}

/// Plain ASCII alone: on some other characters toml++ 3.3 runs into undefined behaviour.
Status check_characters(std::string_view text, const std::string& origin) {
  std::size_t line = 1;
  for (const char c : text) {
    if (c == '\n') ++line;
    if ((c >= 0x20 && c < 0x7f) || c == '\n' || c == '\r' || c == '\t') continue;
    return refuse(origin + ", line " + std::to_string(line) + ": is not plain ASCII text");
  }
  return {};
}

struct Reader {
  const std::string& origin;
  MachineConfig& config;

  std::string place(const toml::source_region& source) const {
    return origin + ", line " + std::to_string(source.begin.line) + ": ";
  }

  Status read_key(const Section& section, const toml::key& key, const toml::node& node) const {
    const std::string name(key.str());
    const Field* field = find_field(section, name);
    if (field == nullptr) {
      return refuse(origin + ": unknown key '" + name + "'" + in_section(section) + " in line " +
                    std::to_string(key.source().begin.line) + hint(name, keys_of(section)));
    }
    const std::optional<FieldValue> value = value_of(node);
    if (!value.has_value()) {
      return refuse(place(node.source()) + "the value of '" + name +
                    "' is not a single value; allowed: " + allowed(*field));
    }
    return set_field(section, *field, config, *value, place(node.source()));
  }

  /// The preset first: it sets what the other keys change, wherever it stands.
  Status read_section(const Section& section, const toml::table& table) const {
    for (const bool presets : {true, false}) {
      for (auto&& [key, node] : table) {
        if (section.name.empty() && node.is_table()) continue;
        if ((key.str() == "preset") != presets) continue;
        if (Status status = read_key(section, key, node); !status.ok()) return status;
      }
    }
    return {};
  }

  Status read(const toml::table& table) const {
    // The keys outside sections first: they say which sections belong here.
    if (Status status = read_section(*find_section(""), table); !status.ok()) return status;
    for (auto&& [key, node] : table) {
      if (!node.is_table()) continue;
      const std::string name(key.str());
      const Section* section = name.empty() ? nullptr : find_section(name);
      const std::string line = std::to_string(key.source().begin.line);
      if (section == nullptr) {
        std::vector<std::string> names;
        for (const Section& known : config_sections()) names.push_back(known.name);
        return refuse(origin + ": unknown section [" + name + "] in line " + line +
                      hint(name, names));
      }
      if (!section->architecture.empty() && section->architecture != config.architecture) {
        return refuse(origin + ": section [" + name + "] in line " + line +
                      " is of architecture '" + section->architecture + "', but this one is '" +
                      config.architecture + "'");
      }
      if (Status status = read_section(*section, *node.as_table()); !status.ok()) return status;
    }
    return {};
  }
};

/// The value that a text on the command line means for this field, or nothing.
std::optional<FieldValue> value_of(const Field& field, std::string text) {
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
    return FieldValue(text.substr(1, text.size() - 2));
  }
  switch (field.kind) {
    case Field::Kind::flag:
      if (text == "true") return FieldValue(true);
      if (text == "false") return FieldValue(false);
      return std::nullopt;
    case Field::Kind::count:
    case Field::Kind::power_of_two: {
      std::uint64_t value = 0;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
      if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
      return FieldValue(value);
    }
    case Field::Kind::real: {
      double value = 0;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
      if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
      return FieldValue(value);
    }
    case Field::Kind::choice:
    case Field::Kind::text:
      return FieldValue(std::move(text));
  }
  return std::nullopt;
}

std::string toml_of(const FieldValue& value) {
  const std::string text = text_of(value);
  if (std::holds_alternative<std::string>(value)) return '"' + text + '"';
  // A point, so that a real number is no whole one.
  const bool whole = text.find_first_of(".en") == std::string::npos;
  return std::holds_alternative<double>(value) && whole ? text + ".0" : text;
}

}  // namespace

std::vector<std::string> config_names() {
  std::vector<std::string> names;
  for (const EmbeddedConfig& config : embedded_configs()) names.emplace_back(config.name);
  return names;
}

Result<MachineConfig> parse_config(std::string_view text, const std::string& origin) {
  if (text.size() > kMaxBytes) return refuse(origin + ": is longer than a configuration can be");
  if (Status status = check_characters(text, origin); !status.ok()) return status;
  const toml::parse_result parsed = toml::parse(text, origin);
  if (!parsed) {
    const toml::parse_error& error = parsed.error();
    return refuse(origin + ", line " + std::to_string(error.source().begin.line) + ": " +
                  std::string(error.description()));
  }
  MachineConfig config;
  if (Status status = Reader{origin, config}.read(parsed.table()); !status.ok()) return status;
  if (config.name.empty()) config.name = origin;
  if (Status status = validate(config.memory); !status.ok()) {
    return refuse(origin + ": " + status.message());
  }
  return config;
}

Result<MachineConfig> load_config(const std::string& name_or_path) {
  for (const EmbeddedConfig& config : embedded_configs()) {
    if (config.name == name_or_path) return parse_config(config.text, name_or_path);
  }
  std::error_code error;
  if (!std::filesystem::is_regular_file(name_or_path, error)) {
    std::string known;
    for (const std::string& name : config_names()) known += (known.empty() ? "" : ", ") + name;
    return Status(StatusCode::io_error, "there is no configuration or file '" + name_or_path + "'" +
                                            hint(name_or_path, config_names()) +
                                            " (configurations: " + known + ")");
  }
  std::ifstream file(name_or_path, std::ios::binary);
  // One byte more than allowed is enough to know.
  std::string text(kMaxBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad() || (file.fail() && !file.eof())) {
    return Status(StatusCode::io_error, name_or_path + ": cannot be read");
  }
  text.resize(static_cast<std::size_t>(file.gcount()));
  return parse_config(text, name_or_path);
}

Status apply_override(MachineConfig& config, const std::string& assignment) {
  const auto wrong = [&](const std::string& what) {
    return Status(StatusCode::invalid_argument, "'" + assignment + "': " + what);
  };
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) return wrong("is not section.key=value");
  const std::string path = assignment.substr(0, equals);
  const std::size_t dot = path.find('.');
  const std::string section_name = dot == std::string::npos ? "" : path.substr(0, dot);
  const std::string key = dot == std::string::npos ? path : path.substr(dot + 1);
  const Section* section = find_section(section_name);
  if (section == nullptr) {
    std::vector<std::string> names;
    for (const Section& known : config_sections()) names.push_back(known.name);
    return wrong("unknown section '" + section_name + "'" + hint(section_name, names));
  }
  if (!section->architecture.empty() && section->architecture != config.architecture) {
    return wrong("section '" + section_name + "' is of architecture '" + section->architecture +
                 "', but '" + config.name + "' is '" + config.architecture + "'");
  }
  const Field* field = find_field(*section, key);
  if (field == nullptr) {
    return wrong("unknown key '" + key + "'" + in_section(*section) + hint(key, keys_of(*section)));
  }
  const std::optional<FieldValue> value = value_of(*field, assignment.substr(equals + 1));
  if (!value.has_value()) return wrong("allowed: " + allowed(*field));
  MachineConfig changed = config;
  if (Status status = set_field(*section, *field, changed, *value, ""); !status.ok()) {
    return wrong(status.message());
  }
  if (Status status = validate(changed.memory); !status.ok()) return wrong(status.message());
  config = std::move(changed);
  return {};
}

std::string to_toml(const MachineConfig& config) {
  MachineConfig copy = config;
  std::string text = "# SPDX-License-Identifier: Apache-2.0\n";
  for (const Section& section : config_sections()) {
    if (!section.architecture.empty() && section.architecture != config.architecture) continue;
    if (!section.name.empty()) text += "\n# " + section.comment + "\n[" + section.name + "]\n";
    for (const Field& field : section.fields) {
      text += "# " + field.comment + " (" + allowed(field) + ")\n";
      text += field.key + " = " + toml_of(field.get(section.of(copy))) + "\n";
    }
  }
  return text;
}

}  // namespace fasttree::model
