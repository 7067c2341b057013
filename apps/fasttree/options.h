// SPDX-License-Identifier: Apache-2.0
// Options of a subcommand. Every value is checked while it is read, and a wrong one is answered
// with what would be right.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fasttree/vec.h"

namespace CLI {
class App;
}

namespace fasttree::app {

/// Values of an option by name, in the order --help lists them.
template <typename T>
using Choices = std::vector<std::pair<std::string, T>>;

/// The entry nearest to a word by edit distance, or empty where none is near.
std::string nearest(const std::string& word, const std::vector<std::string>& entries);

/// "4096", "512K", "1.5G": bytes, powers of 1024. Throws Failure, naming the option.
std::uint64_t parse_size(const std::string& option, const std::string& text);

/// Declares options on a CLI11 subcommand, which stays out of the other files: it is slow to
/// compile, and its messages are not ours.
class Options {
 public:
  explicit Options(CLI::App& app) : app_(app) {}

  void positional(std::string& value, const char* name, const std::string& help,
                  bool required = true);
  void text(std::string& value, const char* name, const char* type, const std::string& help);
  /// May be given several times; each appends.
  void texts(std::vector<std::string>& values, const char* name, const char* type,
             const std::string& help);
  void flag(bool& value, const char* name, const std::string& help);
  /// Two flags that set the same value and exclude each other: --smooth, --flat.
  void flag_pair(bool& value, const char* on, const char* off, const std::string& help_on,
                 const std::string& help_off);

  /// Whole numbers from least to most.
  template <typename T>
  void count(T& value, const char* name, const std::string& help, std::uint64_t least,
             std::uint64_t most) {
    count_option(
        name, help, least, most, [&value](std::uint64_t n) { value = static_cast<T>(n); },
        std::to_string(value));
  }
  void number(double& value, const char* name, const std::string& help, double least, double most);
  void number(std::optional<double>& value, const char* name, const std::string& help, double least,
              double most);
  /// "X,Y,Z"
  void point(std::optional<Vec3>& value, const char* name, const std::string& help);
  /// "auto" (-1) or a whole number from 0 to most.
  void depth(int& value, const char* name, const std::string& help, int most);
  /// "WxH"
  void extent(std::uint32_t& width, std::uint32_t& height, const char* name,
              const std::string& help, std::uint32_t most);
  void size(std::uint64_t& value, const char* name, const std::string& help,
            const std::string& default_text);

  template <typename T>
  void choice(T& value, const char* name, const std::string& help, const Choices<T>& choices) {
    std::vector<std::string> names;
    std::string current;
    for (const auto& [text, v] : choices) {
      names.push_back(text);
      if (v == value && current.empty()) current = text;
    }
    choice_option(
        name, help, names, [&value, choices](std::size_t i) { value = choices[i].second; },
        current);
  }

 private:
  using Set = std::function<void(const std::string& text)>;

  void value_option(const char* name, const char* type, const std::string& help, Set set,
                    const std::string& default_text);
  void count_option(const char* name, const std::string& help, std::uint64_t least,
                    std::uint64_t most, std::function<void(std::uint64_t)> set,
                    const std::string& default_text);
  void choice_option(const char* name, const std::string& help, std::vector<std::string> names,
                     std::function<void(std::size_t)> set, const std::string& default_text);

  CLI::App& app_;
};

}  // namespace fasttree::app
