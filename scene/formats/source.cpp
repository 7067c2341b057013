// SPDX-License-Identifier: Apache-2.0
#include "scene/formats/source.h"

namespace fasttree::scene {

Status bad_input(const Source& source, const std::string& what) {
  return {StatusCode::bad_input, source.name + ": " + what};
}

Status bad_line(const Source& source, std::size_t line, const std::string& what) {
  return {StatusCode::bad_input, source.name + ", line " + std::to_string(line) + ": " + what};
}

Status bad_byte(const Source& source, std::uint64_t offset, const std::string& what) {
  return {StatusCode::bad_input, source.name + ", byte " + std::to_string(offset) + ": " + what};
}

std::string excerpt(std::string_view text) {
  constexpr std::size_t kMost = 32;
  std::string out = "'";
  for (const char c : text.substr(0, kMost)) out += c >= 0x20 && c < 0x7f ? c : '?';
  if (text.size() > kMost) out += "...";
  return out + "'";
}

std::string stem(std::string_view name) {
  name = name.substr(name.find_last_of('/') + 1);  // npos + 1 is 0: the whole name
  const std::size_t dot = name.find_last_of('.');
  return std::string(dot == 0 ? name : name.substr(0, dot));
}

Status LoadProgress::at(double fraction) const {
  if (!settings_.progress || settings_.progress(stage_, fraction)) return {};
  return {StatusCode::cancelled, source_.name + ": loading was cancelled."};
}

}  // namespace fasttree::scene
