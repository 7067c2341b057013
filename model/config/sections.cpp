// SPDX-License-Identifier: Apache-2.0
#include "model/config/sections.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "model/config/memory_fields.h"

namespace fasttree::model {
namespace {

std::vector<Section> make_sections() {
  std::vector<Section> sections;
  Fields<MachineConfig> root;
  root.text("name", &MachineConfig::name, "What reports call this machine");
  root.choice("architecture", &MachineConfig::architecture, {"paper", "fasttree-2"},
              "The machine of the paper, or ours");
  root.real("clock_mhz", &MachineConfig::clock_mhz, 1, 10000, "Clock of the machine");
  sections.push_back({"", "", "", root.list(), [](MachineConfig& c) -> void* { return &c; }});

  sections.push_back({"memory", "Off-chip memory", "", memory_fields().list(),
                      [](MachineConfig& c) -> void* { return &c.memory; }});

  Fields<PaperConfig> paper;
  PaperConfig::declare(paper);
  sections.push_back({"paper", "The machine of the paper", "paper", paper.list(),
                      [](MachineConfig& c) -> void* { return &c.paper; }});

  Fields<FastTree2Config> fasttree2;
  FastTree2Config::declare(fasttree2);
  sections.push_back({"fasttree2", "The machine fasttree-2", "fasttree-2", fasttree2.list(),
                      [](MachineConfig& c) -> void* { return &c.fasttree2; }});
  return sections;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

/// Empty where the value may stand in the field.
std::string objection(const Field& field, const FieldValue& value) {
  switch (field.kind) {
    case Field::Kind::flag:
      return std::holds_alternative<bool>(value) ? "" : "is not true or false";
    case Field::Kind::count:
    case Field::Kind::power_of_two: {
      const std::uint64_t* n = std::get_if<std::uint64_t>(&value);
      if (n == nullptr) return "is not a whole number";
      const double d = static_cast<double>(*n);
      if (d < field.least || d > field.most) return "is out of range";
      if (field.kind == Field::Kind::power_of_two && !std::has_single_bit(*n)) {
        return "is not a power of two";
      }
      return "";
    }
    case Field::Kind::real: {
      const double* d = std::get_if<double>(&value);
      if (d == nullptr) return "is not a number";
      return *d >= field.least && *d <= field.most ? "" : "is out of range";  // NaN is neither
    }
    case Field::Kind::choice: {
      const std::string* s = std::get_if<std::string>(&value);
      if (s == nullptr) return "is not a text";
      return std::count(field.choices.begin(), field.choices.end(), *s) > 0 ? "" : "is not known";
    }
    case Field::Kind::text: {
      const std::string* s = std::get_if<std::string>(&value);
      if (s == nullptr) return "is not a text";
      const bool plain = std::all_of(s->begin(), s->end(), [](unsigned char c) {
        return c >= 0x20 && c != 0x7f && c != '"' && c != '\\';
      });
      return plain && s->size() <= 200 ? ""
                                       : "is not one line of at most 200 characters without quotes";
    }
  }
  return "";
}

}  // namespace

const std::vector<Section>& config_sections() {
  static const std::vector<Section> sections = make_sections();
  return sections;
}

std::string allowed(const Field& field) {
  switch (field.kind) {
    case Field::Kind::flag:
      return "true or false";
    case Field::Kind::count:
    case Field::Kind::real:
      return number(field.least) + " to " + number(field.most);
    case Field::Kind::power_of_two:
      return "a power of two, " + number(field.least) + " to " + number(field.most);
    case Field::Kind::choice: {
      std::string list = "one of ";
      for (const std::string& choice : field.choices) {
        list += (&choice == field.choices.data() ? "" : ", ") + choice;
      }
      return list;
    }
    case Field::Kind::text:
      return "a text";
  }
  return "";
}

Status set_field(const Section& section, const Field& field, MachineConfig& config,
                 const FieldValue& given, const std::string& where) {
  FieldValue value = given;
  // A whole number is a real one as well.
  if (field.kind == Field::Kind::real && std::holds_alternative<std::uint64_t>(value)) {
    value = static_cast<double>(std::get<std::uint64_t>(value));
  }
  const std::string wrong = objection(field, value);
  if (!wrong.empty()) {
    std::string near;
    if (field.kind == Field::Kind::choice && std::holds_alternative<std::string>(value)) {
      near = nearest_word(std::get<std::string>(value), field.choices);
    }
    return Status(StatusCode::bad_input, where + "the value of '" + field.key + "' " + wrong +
                                             "; allowed: " + allowed(field) +
                                             (near.empty() ? "" : "; did you mean " + near + "?"));
  }
  // A preset stands for all keys of the memory.
  if (section.name == "memory" && field.key == "preset") {
    Result<MemoryConfig> preset = memory_preset(std::get<std::string>(value));
    if (!preset.ok()) return preset.status();
    config.memory = std::move(preset).value();
    return {};
  }
  field.set(section.of(config), value);
  return {};
}

std::string text_of(const FieldValue& value) {
  if (const bool* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const auto* count = std::get_if<std::uint64_t>(&value)) return std::to_string(*count);
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  // The shortest that reads as the same number.
  char text[64];
  return {text, std::to_chars(text, text + sizeof text, std::get<double>(value)).ptr};
}

std::string nearest_word(const std::string& word, const std::vector<std::string>& words) {
  if (word.size() > 100) return "";
  std::string best;
  std::size_t least = 1 + std::max<std::size_t>(2, word.size() / 3);
  for (const std::string& other : words) {
    std::vector<std::size_t> row(other.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < word.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i + 1;
      for (std::size_t j = 0; j < other.size(); ++j) {
        const std::size_t change = diagonal + (word[i] == other[j] ? 0 : 1);
        diagonal = row[j + 1];
        row[j + 1] = std::min({change, row[j] + 1, row[j + 1] + 1});
      }
    }
    if (row.back() < least) {
      least = row.back();
      best = other;
    }
  }
  return best;
}

}  // namespace fasttree::model
