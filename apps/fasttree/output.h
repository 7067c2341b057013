// SPDX-License-Identifier: Apache-2.0
// What the program says: text on standard output, JSON in a file or instead of the text.
#pragma once

#include <fmt/format.h>

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

namespace fasttree::app {

/// Text for a person. Nothing is written with --quiet or where the JSON goes to standard output.
/// Writing errors throw Failure.
class Output {
 public:
  void mute() { muted_ = true; }

  template <typename... Args>
  void line(fmt::format_string<Args...> format, Args&&... args) {
    if (!muted_) write(fmt::format(format, std::forward<Args>(args)...) + "\n");
  }

  /// Writes in any case: for what was asked for, such as --help.
  void write(const std::string& text);

  /// Writes to standard output for "-", else to a temporary name and then to `path`.
  void json(const nlohmann::ordered_json& content, const std::string& path);
  void file(const std::string& content, const std::string& path);

  /// Makes sure everything arrived.
  void finish();

 private:
  [[noreturn]] void failed();
  bool muted_ = false;
};

/// Columns of text, the first one to the left, the others to the right.
class Table {
 public:
  explicit Table(std::vector<std::string> header) { rows_.push_back(std::move(header)); }
  /// This column is words: to the left as well.
  void words(std::size_t column) { words_ = column; }
  void row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  void print(Output& output) const;
  std::string csv() const;
  /// The header, then the rows.
  const std::vector<std::vector<std::string>>& cells() const { return rows_; }

 private:
  std::vector<std::vector<std::string>> rows_;
  std::size_t words_ = 0;
};

/// "1,234,567"
std::string with_commas(unsigned long long value);
/// "12.3 MiB"
std::string bytes_text(unsigned long long bytes);

}  // namespace fasttree::app
