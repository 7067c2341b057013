// SPDX-License-Identifier: Apache-2.0
#include "scene/formats/text_scanner.h"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <charconv>
#include <system_error>

namespace fasttree::scene {

TextScanner::TextScanner(std::string_view text, Options options, std::size_t first_line)
    : text_(text), options_(options), line_(first_line) {
  if (text_.find('\n') == std::string_view::npos) newline_ = '\r';
  if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;  // the byte order mark some editors write
}

std::size_t TextScanner::joint() const {
  if (!options_.backslash_joins_lines) return 0;
  std::size_t end = at_ + 1;
  if (newline_ == '\n' && end < text_.size() && text_[end] == '\r') ++end;
  return end < text_.size() && text_[end] == newline_ ? end + 1 - at_ : 0;
}

bool TextScanner::find_word() {
  while (at_ < text_.size()) {
    const char c = text_[at_];
    if (c == newline_) return false;
    if (is_space(c)) {
      ++at_;
    } else if (c == '\\' && joint() > 0) {
      at_ += joint();
      ++line_;
    } else if (c == options_.comment && c != '\0') {
      at_ = std::min(text_.find(newline_, at_), text_.size());
      return false;
    } else {
      return true;
    }
  }
  return false;
}

bool TextScanner::word(std::string_view& out) {
  if (!find_word()) return false;
  const std::size_t begin = at_;
  while (at_ < text_.size()) {
    const char c = text_[at_];
    if (c == newline_ || is_space(c)) break;
    if (c == '\\' && joint() > 0) break;
    if (c == options_.comment && c != '\0') break;
    ++at_;
  }
  out = text_.substr(begin, at_ - begin);
  return true;
}

void TextScanner::skip_row() {
  for (;;) {
    const std::size_t begin = at_;
    at_ = std::min(text_.find(newline_, at_), text_.size());
    if (at_ == text_.size() || !options_.backslash_joins_lines) return;
    // Only a backslash outside a comment joins the lines, as in find_word.
    std::size_t last = at_;
    if (last > begin && newline_ == '\n' && text_[last - 1] == '\r') --last;
    if (last == begin || text_[last - 1] != '\\') return;
    const std::string_view rest = text_.substr(begin, last - begin);
    if (options_.comment != '\0' && rest.find(options_.comment) != std::string_view::npos) return;
    ++at_;
    ++line_;
  }
}

bool TextScanner::next_row() {
  // From the middle of a row, or from its end; before the first row nothing has to be skipped.
  if (started_) skip_row();
  started_ = true;
  for (;;) {
    if (find_word()) return true;
    if (at_ >= text_.size()) return false;
    ++at_;  // the line end
    ++line_;
  }
}

bool parse_float(std::string_view word, float& out) {
  if (word.starts_with('+')) {
    word.remove_prefix(1);
    if (word.starts_with('-')) return false;
  }
  const char* const end = word.data() + word.size();
  const auto [rest, error] = fast_float::from_chars(word.data(), end, out);
  return (error == std::errc() || error == std::errc::result_out_of_range) && rest == end;
}

bool parse_integer(std::string_view word, std::int64_t& out) {
  if (word.starts_with('+')) {
    word.remove_prefix(1);
    if (word.starts_with('-')) return false;
  }
  const char* const end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, out);
  return error == std::errc() && rest == end;
}

}  // namespace fasttree::scene
