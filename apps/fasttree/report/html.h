// SPDX-License-Identifier: Apache-2.0
// The parts of a page that needs nothing but itself: tables, figures, tiles, and the page round
// them. Arguments called `html` or `body` are HTML; all other text is escaped here.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace fasttree::report {

/// Stands in every line of the page whose figures were measured on the machine that wrote it: the
/// only lines that differ between two runs with the same inputs.
inline constexpr const char* kMeasured = "data-measured";

/// A table in a box of its own that scrolls where the page is too narrow. The first column names
/// the row.
class HtmlTable {
 public:
  HtmlTable(std::string caption, std::vector<std::string> header);
  /// The column is words: to the left, and broken into lines.
  HtmlTable& words(std::size_t column);
  void row(const std::vector<std::string>& cells, bool measured = false);
  std::string html() const;

 private:
  std::string tag(std::size_t column, bool head) const;

  std::string caption_;
  std::vector<std::string> header_;
  std::vector<bool> words_;
  std::string rows_;
};

/// Rows as a program's Table has them, the header first.
std::string html_table(const std::string& caption,
                       const std::vector<std::vector<std::string>>& cells,
                       const std::vector<std::size_t>& words = {},
                       const std::vector<bool>& measured = {});

/// Something to look at with what it shows under it.
std::string figure(const std::string& body, const std::string& caption);

/// A picture that scales down with the page. `source` is a data URI.
std::string picture(const std::string& source, const std::string& alt, std::size_t width,
                    std::size_t height);

/// Numbers in large type, each with what it is.
std::string tiles(const std::vector<std::pair<std::string, std::string>>& values);

std::string subheading(const std::string& text);
/// `html` behind a line that unfolds it.
std::string folded(const std::string& summary, const std::string& html);
std::string paragraph(const std::string& html);
std::string note(const std::string& html);  ///< in a softer colour

struct PageSection {
  std::string id;  ///< of letters, digits and hyphens
  std::string title;
  std::string body;
};

/// A whole document: a head, a table of contents that leads to each section, the sections.
/// Whoever opens it loads nothing else; the page itself forbids it.
std::string html_page(const std::string& title, const std::string& lead,
                      const std::vector<PageSection>& sections);

}  // namespace fasttree::report
