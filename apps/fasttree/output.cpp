// SPDX-License-Identifier: Apache-2.0
#include "output.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>

#include "command.h"
#include "model/report/text.h"
#include "tree/atomic_file.h"

namespace fasttree::app {

void Output::failed() {
  const int error = errno;
  const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG;
  throw Failure{full ? kResourceLimit : kBadInput,
                fmt::format("cannot write to standard output: {}", std::strerror(error))};
}

void Output::write(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) failed();
}

void Output::file(const std::string& content, const std::string& path) {
  AtomicFile file = take(AtomicFile::create(path));
  check(file.write(std::as_bytes(std::span(content.data(), content.size()))));
  check(file.commit());
}

void Output::json(const nlohmann::ordered_json& content, const std::string& path) {
  if (path.empty()) return;
  // File names need not be UTF-8; JSON has to be.
  const std::string text =
      content.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  if (path == "-") {
    write(text);
  } else {
    file(text, path);
  }
}

void Output::finish() {
  if (std::fflush(stdout) != 0) failed();
}

void Table::print(Output& output) const {
  std::vector<std::size_t> width;
  for (const auto& row : rows_) {
    width.resize(std::max(width.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], row[i].size());
  }
  for (const auto& row : rows_) {
    std::string text;
    for (std::size_t i = 0; i < row.size(); ++i) {
      text += i == 0        ? fmt::format("{:<{}}", row[i], width[i])
              : i == words_ ? fmt::format("  {:<{}}", row[i], width[i])
                            : fmt::format("  {:>{}}", row[i], width[i]);
    }
    text.resize(text.find_last_not_of(' ') + 1);
    output.line("{}", text);
  }
}

std::string Table::csv() const {
  std::string text;
  for (const auto& row : rows_) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      text += (i == 0 ? "" : ",") + model::csv_cell(row[i]);
    }
    text += "\n";
  }
  return text;
}

std::string with_commas(unsigned long long value) {
  return model::grouped(value);
}

std::string bytes_text(unsigned long long bytes) {
  return model::byte_count(bytes);
}

}  // namespace fasttree::app
