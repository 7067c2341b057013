// SPDX-License-Identifier: Apache-2.0
#include "report/html.h"

#include "model/report/html_style.h"
#include "model/report/text.h"
#include "report/page_style.h"

namespace fasttree::report {

using model::escaped_html;

HtmlTable::HtmlTable(std::string caption, std::vector<std::string> header)
    : caption_(std::move(caption)), header_(std::move(header)), words_(header_.size()) {}

HtmlTable& HtmlTable::words(std::size_t column) {
  words_[column] = true;
  return *this;
}

std::string HtmlTable::tag(std::size_t column, bool head) const {
  std::string text = head ? "<th scope=\"col\"" : column == 0 ? "<th scope=\"row\"" : "<td";
  if (column < words_.size() && words_[column]) text += " class=\"words\"";
  return text + ">";
}

void HtmlTable::row(const std::vector<std::string>& cells, bool measured) {
  rows_ += measured ? std::string("<tr ") + kMeasured + ">" : std::string("<tr>");
  for (std::size_t i = 0; i < cells.size(); ++i) {
    rows_ += tag(i, false) + escaped_html(cells[i]) + (i == 0 ? "</th>" : "</td>");
  }
  rows_ += "</tr>\n";
}

std::string HtmlTable::html() const {
  std::string head;
  for (std::size_t i = 0; i < header_.size(); ++i) {
    head += tag(i, true) + escaped_html(header_[i]) + "</th>";
  }
  // Reachable with the keyboard, which then scrolls it.
  return "<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"" +
         escaped_html(caption_) + "\"><table>\n<caption>" + escaped_html(caption_) +
         "</caption>\n<thead><tr>" + head + "</tr></thead>\n<tbody>\n" + rows_ +
         "</tbody></table></div>\n";
}

std::string html_table(const std::string& caption,
                       const std::vector<std::vector<std::string>>& cells,
                       const std::vector<std::size_t>& words, const std::vector<bool>& measured) {
  if (cells.empty()) return "";
  HtmlTable table(caption, cells.front());
  for (const std::size_t column : words) table.words(column);
  for (std::size_t r = 1; r < cells.size(); ++r) {
    table.row(cells[r], r - 1 < measured.size() && measured[r - 1]);
  }
  return table.html();
}

std::string figure(const std::string& body, const std::string& caption) {
  return "<figure>\n" + body + "<figcaption>" + escaped_html(caption) +
         "</figcaption>\n</figure>\n";
}

std::string picture(const std::string& source, const std::string& alt, std::size_t width,
                    std::size_t height) {
  return "<img src=\"" + escaped_html(source) + "\" alt=\"" + escaped_html(alt) + "\" width=\"" +
         std::to_string(width) + "\" height=\"" + std::to_string(height) + "\">\n";
}

std::string tiles(const std::vector<std::pair<std::string, std::string>>& values) {
  std::string text = "<div class=\"tiles\">\n";
  for (const auto& [value, what] : values) {
    text +=
        "<div><b>" + escaped_html(value) + "</b><span>" + escaped_html(what) + "</span></div>\n";
  }
  return text + "</div>\n";
}

std::string subheading(const std::string& text) {
  return "<h3>" + escaped_html(text) + "</h3>\n";
}

std::string folded(const std::string& summary, const std::string& html) {
  return "<details>\n<summary>" + escaped_html(summary) + "</summary>\n" + html + "</details>\n";
}

std::string paragraph(const std::string& html) {
  return "<p>" + html + "</p>\n";
}

std::string note(const std::string& html) {
  return "<p class=\"soft\">" + html + "</p>\n";
}

std::string html_page(const std::string& title, const std::string& lead,
                      const std::vector<PageSection>& sections) {
  std::string contents, body;
  for (const PageSection& section : sections) {
    const std::string id = escaped_html(section.id), name = escaped_html(section.title);
    contents += "<li><a href=\"#" + id + "\">" + name + "</a></li>\n";
    body += "<section id=\"" + id + "\">\n<h2>" + name + "</h2>\n" + section.body + "</section>\n";
  }
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src "
         "data:; style-src 'unsafe-inline'\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         escaped_html(title) + "</title>\n<style>" + model::kHtmlStyle + kPageStyle +
         "</style>\n</head>\n<body>\n<header>\n<h1>" + escaped_html(title) + "</h1>\n" + lead +
         "</header>\n<nav aria-label=\"Contents\">\n<ol>\n" + contents + "</ol>\n</nav>\n<main>\n" +
         body + "</main>\n</body>\n</html>\n";
}

}  // namespace fasttree::report
