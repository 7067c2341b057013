// SPDX-License-Identifier: Apache-2.0
// Rows and words of a text file, with line numbers. A row is a line that has a word.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace fasttree::scene {

/// Walks over text without copying it. Lines end in LF or CR LF; a text without any LF ends its
/// lines in CR, as on early Macintoshes.
class TextScanner {
 public:
  struct Options {
    bool backslash_joins_lines = false;  ///< a backslash at a line's end continues it on the next
    char comment = '\0';                 ///< from here to the line's end is no word; '\0': none
  };

  explicit TextScanner(std::string_view text) : TextScanner(text, Options()) {}
  TextScanner(std::string_view text, Options options, std::size_t first_line = 1);

  /// To the next row: past the rest of this one and past blank lines. False at the end of the text.
  bool next_row();

  /// The next word of the row; false where the row has no more.
  bool word(std::string_view& out);

  /// To the end of the row, its words unread.
  void skip_row();

  /// The line of the word last read, or of the row's start.
  std::size_t line() const { return line_; }
  std::size_t offset() const { return at_; }
  std::size_t size() const { return text_.size(); }

 private:
  bool is_space(char c) const {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
  }
  /// At a backslash: the length of backslash and line end, or 0 where it does not end the line.
  std::size_t joint() const;
  /// Past blanks and joints; true where a word begins here.
  bool find_word();

  std::string_view text_;
  Options options_;
  char newline_ = '\n';
  std::size_t at_ = 0;
  std::size_t line_ = 1;
  bool started_ = false;  // inside a row, or at its end
};

/// A coordinate. Decimal or scientific, nan and inf; a leading plus is allowed. A number too large
/// or too small for binary32 becomes infinite or zero. False where the word is no number.
bool parse_float(std::string_view word, float& out);

/// A decimal integer, sign allowed. False where the word is none, or does not fit.
bool parse_integer(std::string_view word, std::int64_t& out);

}  // namespace fasttree::scene
