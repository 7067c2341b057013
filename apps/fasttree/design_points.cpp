// SPDX-License-Identifier: Apache-2.0
#include "design_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "command.h"
#include "model/config/sections.h"

#define TOML_EXCEPTIONS 0
#define TOML_HEADER_ONLY 1
#include <toml++/toml.h>

namespace fasttree::app {
namespace {

using model::Field;
using model::FieldValue;
using model::MachineConfig;
using model::Section;
using model::text_of;

std::string key_of(const std::string& change) {
  return change.substr(0, change.find('='));
}

/// Without the section: that is long, and the keys tell themselves apart.
std::string short_of(const std::string& change) {
  const std::size_t dot = key_of(change).find('.');
  return dot == std::string::npos ? change : change.substr(dot + 1);
}

DesignPoint point_of(const MachineConfig& base, std::vector<std::string> changes,
                     const std::string& name, int exit_code, const std::string& where) {
  DesignPoint point{name, std::move(changes), base};
  // A preset stands for all keys of the memory: it comes before those that change one.
  std::stable_partition(point.changes.begin(), point.changes.end(), [](const std::string& change) {
    return key_of(change) == "memory.preset";
  });
  for (const std::string& change : point.changes) {
    const Status status = model::apply_override(point.config, change);
    if (!status.ok()) throw Failure{exit_code, where + status.message()};
    if (name.empty()) point.label += (point.label.empty() ? "" : " ") + short_of(change);
  }
  if (point.label.empty()) point.label = "base";
  return point;
}

/// Half and twice a number as far as allowed, what a flag is not, the other choices.
std::vector<std::string> other_values(const Field& field, const FieldValue& value) {
  std::vector<std::string> values;
  const auto number = [&](double v) {
    v = std::clamp(v, field.least, field.most);
    if (field.kind == Field::Kind::real) return fmt::format("{}", v);
    return std::to_string(static_cast<std::uint64_t>(v));
  };
  switch (field.kind) {
    case Field::Kind::flag:
      values = {std::get<bool>(value) ? "false" : "true"};
      break;
    case Field::Kind::count:
    case Field::Kind::power_of_two: {
      const double n = static_cast<double>(std::get<std::uint64_t>(value));
      values = {number(std::floor(n / 2)), number(std::max(1.0, 2 * n))};
      break;
    }
    case Field::Kind::real: {
      const double x = std::get<double>(value);
      values = {number(x / 2), number(2 * x)};
      break;
    }
    case Field::Kind::choice:
      values = field.choices;
      break;
    case Field::Kind::text:
      break;
  }
  std::erase(values, text_of(value));
  return values;
}

bool is_assumption(const Section& section, const Field& field) {
  if (section.name == "paper") return field.comment.rfind("Assumed", 0) == 0;
  if (section.name == "memory") {
    const auto names = {"preset", "interleave", "address_order", "bank_hash", "refresh"};
    return std::find(names.begin(), names.end(), field.key) != names.end();
  }
  return section.name == "fasttree2" && field.key != "stuck_cycles" && field.key != "axes" &&
         field.key != "depth";
}

std::string read_text(const std::string& path) {
  constexpr std::size_t kMost = std::size_t{16} << 20;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Failure{kBadInput, path + ": cannot be opened"};
  std::string text(kMost + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) throw Failure{kBadInput, path + ": cannot be read"};
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kMost) throw Failure{kBadInput, path + ": is longer than a list of points"};
  return text;
}

std::vector<DesignPoint> from_csv(const MachineConfig& base, const std::string& path) {
  const auto rows = parse_csv(read_text(path), false);
  if (rows.size() < 2) {
    throw Failure{kBadInput, path + ": needs a line with keys and a line for each point"};
  }
  std::vector<DesignPoint> points;
  for (std::size_t r = 1; r < rows.size(); ++r) {
    const std::string where = fmt::format("{}, row {}: ", path, r + 1);
    if (rows[r].size() != rows[0].size()) {
      throw Failure{kBadInput, fmt::format("{}has {} values for {} keys", where, rows[r].size(),
                                           rows[0].size())};
    }
    std::string name;
    std::vector<std::string> changes;
    for (std::size_t i = 0; i < rows[r].size(); ++i) {
      if (rows[0][i] == "name") {
        name = rows[r][i];
      } else if (!rows[r][i].empty()) {  // empty: as in the base
        changes.push_back(rows[0][i] + "=" + rows[r][i]);
      }
    }
    points.push_back(point_of(base, std::move(changes), name, kBadInput, where));
  }
  return points;
}

void add_changes(const toml::table& table, const std::string& prefix, const std::string& where,
                 std::string& name, std::vector<std::string>& changes) {
  for (auto&& [key, node] : table) {
    const std::string path = prefix + std::string(key.str());
    if (const toml::table* inner = node.as_table()) {
      add_changes(*inner, path + ".", where, name, changes);
    } else if (path == "name" && node.is_string()) {
      name = node.as_string()->get();
    } else if (const auto* s = node.as_string()) {
      changes.push_back(path + "=" + s->get());
    } else if (const auto* i = node.as_integer()) {
      changes.push_back(fmt::format("{}={}", path, i->get()));
    } else if (const auto* d = node.as_floating_point()) {
      changes.push_back(fmt::format("{}={}", path, d->get()));
    } else if (const auto* b = node.as_boolean()) {
      changes.push_back(fmt::format("{}={}", path, b->get()));
    } else {
      throw Failure{kBadInput,
                    fmt::format("{}the value of '{}' is not a single value", where, path)};
    }
  }
}

std::vector<DesignPoint> from_toml(const MachineConfig& base, const std::string& path) {
  const toml::parse_result parsed = toml::parse(read_text(path), path);
  if (!parsed) {
    throw Failure{kBadInput,
                  fmt::format("{}, line {}: {}", path, parsed.error().source().begin.line,
                              parsed.error().description())};
  }
  const toml::array* list = parsed.table()["point"].as_array();
  if (list == nullptr || list->empty() || parsed.table().size() != 1) {
    throw Failure{kBadInput, path + ": has to be a list of tables [[point]] and nothing else"};
  }
  std::vector<DesignPoint> points;
  for (const toml::node& node : *list) {
    const std::string where = fmt::format("{}, line {}: ", path, node.source().begin.line);
    const toml::table* table = node.as_table();
    if (table == nullptr) throw Failure{kBadInput, where + "is not a table [[point]]"};
    std::string name;
    std::vector<std::string> changes;
    add_changes(*table, "", where, name, changes);
    points.push_back(point_of(base, std::move(changes), name, kBadInput, where));
  }
  return points;
}

}  // namespace

std::vector<std::vector<std::string>> parse_csv(const std::string& text, bool whole_lines) {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> row;
  std::string cell;
  bool quoted = false, any = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c != '"') {
        cell += c;
      } else if (i + 1 < text.size() && text[i + 1] == '"') {
        cell += text[++i];
      } else {
        quoted = false;
      }
    } else if (c == '"') {
      quoted = any = true;
    } else if (c == ',') {
      row.push_back(std::move(cell));
      cell.clear();
      any = true;
    } else if (c == '\n') {
      if (any || !cell.empty()) {
        row.push_back(std::move(cell));
        rows.push_back(std::move(row));
      }
      row.clear();
      cell.clear();
      any = false;
    } else if (c != '\r') {
      cell += c;
    }
  }
  if (!whole_lines && (any || !cell.empty())) {
    row.push_back(std::move(cell));
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<Variation> parse_variations(const std::vector<std::string>& texts) {
  std::vector<Variation> variations;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      throw Failure{kUsage,
                    fmt::format("--vary cannot be '{}'; give section.key=VALUE,VALUE,...", text)};
    }
    Variation variation{text.substr(0, equals), {}};
    for (const Variation& other : variations) {
      if (other.key == variation.key) {
        throw Failure{kUsage, fmt::format("--vary {} is given twice; give all values at once",
                                          variation.key)};
      }
    }
    std::istringstream values(text.substr(equals + 1));
    for (std::string value; std::getline(values, value, ',');) variation.values.push_back(value);
    variations.push_back(std::move(variation));
  }
  return variations;
}

std::vector<DesignPoint> grid_points(const MachineConfig& base,
                                     const std::vector<Variation>& variations) {
  std::size_t count = 1;
  for (const Variation& v : variations) {
    count *= v.values.size();
    if (count > kMaxDesignPoints) {
      throw Failure{kUsage, fmt::format("--vary makes more than {} points; give fewer values",
                                        kMaxDesignPoints)};
    }
  }
  std::vector<DesignPoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<std::string> changes(variations.size());
    std::size_t rest = i;
    for (std::size_t v = variations.size(); v-- > 0;) {
      const Variation& variation = variations[v];
      changes[v] = variation.key + "=" + variation.values[rest % variation.values.size()];
      rest /= variation.values.size();
    }
    points.push_back(point_of(base, std::move(changes), "", kUsage, "--vary "));
  }
  return points;
}

std::vector<DesignPoint> single_points(const MachineConfig& base,
                                       const std::vector<Variation>& variations) {
  std::vector<DesignPoint> points{point_of(base, {}, "", kUsage, "")};
  const std::string same = model::to_toml(base);
  for (const Variation& variation : variations) {
    for (const std::string& value : variation.values) {
      DesignPoint point = point_of(base, {variation.key + "=" + value}, "", kUsage, "--vary ");
      if (model::to_toml(point.config) != same) points.push_back(std::move(point));
    }
  }
  return points;
}

std::vector<Variation> assumptions(const MachineConfig& base) {
  MachineConfig copy = base;
  std::vector<Variation> variations;
  for (const Section& section : model::config_sections()) {
    if (!section.architecture.empty() && section.architecture != base.architecture) continue;
    for (const Field& field : section.fields) {
      if (!is_assumption(section, field)) continue;
      Variation variation{section.name + "." + field.key, {}};
      // What does not fit beside the other keys is no alternative.
      for (std::string& value : other_values(field, field.get(section.of(copy)))) {
        MachineConfig changed = base;
        if (model::apply_override(changed, variation.key + "=" + value).ok()) {
          variation.values.push_back(std::move(value));
        }
      }
      if (!variation.values.empty()) variations.push_back(std::move(variation));
    }
  }
  return variations;
}

KeyInfo key_info(const MachineConfig& config, const std::string& key) {
  MachineConfig copy = config;
  for (const Section& section : model::config_sections()) {
    for (const Field& field : section.fields) {
      if ((section.name.empty() ? "" : section.name + ".") + field.key != key) continue;
      return {field.comment, text_of(field.get(section.of(copy)))};
    }
  }
  return {};
}

std::vector<DesignPoint> listed_points(const MachineConfig& base, const std::string& path) {
  std::vector<DesignPoint> points =
      path.ends_with(".toml") ? from_toml(base, path) : from_csv(base, path);
  if (points.size() > kMaxDesignPoints) {
    throw Failure{kBadInput, fmt::format("{}: more than {} points", path, kMaxDesignPoints)};
  }
  return points;
}

}  // namespace fasttree::app
