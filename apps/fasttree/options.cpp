// SPDX-License-Identifier: Apache-2.0
#include "options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>

#include "command.h"

namespace fasttree::app {
namespace {

[[noreturn]] void wrong_value(const std::string& option, const std::string& text,
                              const std::string& expected) {
  throw Failure{kUsage, fmt::format("{} cannot be '{}'; give {}", option, text, expected)};
}

/// The whole text as a number, or nothing.
template <typename T>
std::optional<T> parse(std::string_view text) {
  T value{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

std::string interval(double least, double most) {
  const double huge = std::numeric_limits<float>::max();
  if (least <= -huge && most >= huge) return "a number";
  if (most >= huge) return fmt::format("a number of at least {}", least);
  return fmt::format("a number from {} to {}", least, most);
}

double parse_number(const char* name, const std::string& text, double least, double most) {
  const auto value = parse<double>(text);
  if (!value || !std::isfinite(*value) || *value < least || *value > most) {
    wrong_value(name, text, interval(least, most));
  }
  return *value;
}

}  // namespace

std::string nearest(const std::string& word, const std::vector<std::string>& entries) {
  std::string best;
  // Further than a third of the word is another word.
  std::size_t least = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& entry : entries) {
    std::size_t distance = edit_distance(word, entry);
    if (word.size() >= 3 && entry.starts_with(word)) distance = std::min<std::size_t>(distance, 1);
    if (distance < least) {
      least = distance;
      best = entry;
    }
  }
  return best;
}

std::uint64_t parse_size(const std::string& option, const std::string& text) {
  const char* expected = "bytes, or a number with K, M, G or T, such as 512M (0: no limit)";
  std::string_view digits = text;
  double unit = 1;
  if (!digits.empty() && (digits.back() == 'B' || digits.back() == 'b')) digits.remove_suffix(1);
  if (!digits.empty() && digits.back() == 'i') digits.remove_suffix(1);
  if (!digits.empty()) {
    const std::size_t power = std::string_view("KMGT").find(
        static_cast<char>(std::toupper(static_cast<unsigned char>(digits.back()))));
    if (power != std::string_view::npos) {
      unit = std::ldexp(1.0, 10 * (static_cast<int>(power) + 1));
      digits.remove_suffix(1);
    }
  }
  const auto value = parse<double>(digits);
  if (!value || !std::isfinite(*value) || *value < 0 || *value * unit >= 0x1p63) {
    wrong_value(option, text, expected);
  }
  return static_cast<std::uint64_t>(*value * unit);
}

void Options::value_option(const char* name, const char* type, const std::string& help, Set set,
                           const std::string& default_text) {
  // CLI11 would put the default in the column of the names, which it makes ragged.
  const std::string text = default_text.empty() ? help : fmt::format("{} [{}]", help, default_text);
  app_.add_option_function<std::string>(name, std::move(set), text)->type_name(type)->take_last();
}

void Options::positional(std::string& value, const char* name, const std::string& help,
                         bool required) {
  app_.add_option(name, value, help)->type_name("")->required(required);
}

void Options::text(std::string& value, const char* name, const char* type,
                   const std::string& help) {
  value_option(
      name, type, help,
      [&value, name](const std::string& text) {
        if (text.empty()) wrong_value(name, text, "a name");
        value = text;
      },
      value);
}

void Options::texts(std::vector<std::string>& values, const char* name, const char* type,
                    const std::string& help) {
  app_.add_option(name, values, help)->type_name(type)->expected(1)->take_all();
}

void Options::flag(bool& value, const char* name, const std::string& help) {
  app_.add_flag(name, value, help);
}

void Options::flag_pair(bool& value, const char* on, const char* off, const std::string& help_on,
                        const std::string& help_off) {
  CLI::Option* first = app_.add_flag_callback(
      on, [&value] { value = true; }, help_on);
  CLI::Option* second = app_.add_flag_callback(
      off, [&value] { value = false; }, help_off);
  first->excludes(second);
}

void Options::count_option(const char* name, const std::string& help, std::uint64_t least,
                           std::uint64_t most, std::function<void(std::uint64_t)> set,
                           const std::string& default_text) {
  value_option(
      name, "N", help,
      [=, set = std::move(set)](const std::string& text) {
        const auto value = parse<std::uint64_t>(text);
        if (!value || *value < least || *value > most) {
          wrong_value(name, text, fmt::format("a whole number from {} to {}", least, most));
        }
        set(*value);
      },
      default_text);
}

void Options::number(double& value, const char* name, const std::string& help, double least,
                     double most) {
  value_option(
      name, "X", help,
      [=, &value](const std::string& text) { value = parse_number(name, text, least, most); },
      fmt::format("{}", value));
}

void Options::number(std::optional<double>& value, const char* name, const std::string& help,
                     double least, double most) {
  value_option(
      name, "X", help,
      [=, &value](const std::string& text) { value = parse_number(name, text, least, most); }, "");
}

void Options::point(std::optional<Vec3>& value, const char* name, const std::string& help) {
  value_option(
      name, "X,Y,Z", help,
      [name, &value](const std::string& text) {
        const char* expected = "three numbers with commas between them, such as 0,1.5,-2";
        Vec3 point;
        std::string_view rest = text;
        for (std::size_t a = 0; a < 3; ++a) {
          const std::size_t comma = a < 2 ? rest.find(',') : rest.size();
          if (comma == std::string_view::npos) wrong_value(name, text, expected);
          const auto x = parse<float>(rest.substr(0, comma));
          if (!x || !std::isfinite(*x)) wrong_value(name, text, expected);
          point[a] = *x;
          rest.remove_prefix(std::min(rest.size(), comma + 1));
        }
        value = point;
      },
      "");
}

void Options::depth(int& value, const char* name, const std::string& help, int most) {
  value_option(
      name, "N|auto", help,
      [=, &value](const std::string& text) {
        if (text == "auto") {
          value = -1;
          return;
        }
        const auto n = parse<int>(text);
        if (!n || *n < 0 || *n > most) {
          wrong_value(name, text, fmt::format("auto, or a whole number from 0 to {}", most));
        }
        value = *n;
      },
      value < 0 ? "auto" : std::to_string(value));
}

void Options::extent(std::uint32_t& width, std::uint32_t& height, const char* name,
                     const std::string& help, std::uint32_t most) {
  value_option(
      name, "WxH", help,
      [=, &width, &height](const std::string& text) {
        const std::size_t x = text.find('x');
        const std::string_view view = text;
        const auto w = parse<std::uint32_t>(view.substr(0, x));
        const auto h = x == std::string::npos ? w : parse<std::uint32_t>(view.substr(x + 1));
        if (!w || !h || *w == 0 || *h == 0 || *w > most || *h > most) {
          wrong_value(name, text,
                      fmt::format("pixels as WIDTHxHEIGHT, such as 800x600, each 1 to {}", most));
        }
        width = *w;
        height = *h;
      },
      fmt::format("{}x{}", width, height));
}

void Options::size(std::uint64_t& value, const char* name, const std::string& help,
                   const std::string& default_text) {
  value_option(
      name, "SIZE", help,
      [name, &value](const std::string& text) { value = parse_size(name, text); }, default_text);
}

void Options::choice_option(const char* name, const std::string& help,
                            std::vector<std::string> names, std::function<void(std::size_t)> set,
                            const std::string& default_text) {
  value_option(
      name, "NAME", fmt::format("{}: {}", help, fmt::join(names, ", ")),
      [=, set = std::move(set)](const std::string& text) {
        const auto found = std::find(names.begin(), names.end(), text);
        if (found == names.end()) {
          const std::string near = nearest(text, names);
          const std::string hint = near.empty() ? "" : fmt::format("; did you mean {}?", near);
          throw Failure{kUsage, fmt::format("{} cannot be '{}'; give one of {}{}", name, text,
                                            fmt::join(names, ", "), hint)};
        }
        set(static_cast<std::size_t>(found - names.begin()));
      },
      default_text);
}

}  // namespace fasttree::app
