// SPDX-License-Identifier: Apache-2.0
// What every mesh reader is given, and how it says where a file is wrong.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "fasttree/status.h"
#include "scene/scene.h"

namespace fasttree::scene {

/// One mesh file in memory. Views only: the bytes stay the caller's.
struct Source {
  std::string name;                  ///< the file's name in messages
  std::span<const std::byte> bytes;  ///< the whole file

  /// Where the bytes lie in a mapping, what keeps it mapped: a reader may then view positions in
  /// place, and puts this into Mesh::mapping. Null: positions are always copied.
  std::shared_ptr<const void> mapping;

  /// The folder that external buffers of a glTF are read from, and from nowhere else. Empty: none.
  std::string folder;

  std::string_view text() const {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
};

/// bad_input, "NAME: what". `what` ends in what to do.
Status bad_input(const Source& source, const std::string& what);
/// bad_input, "NAME, line 12: what".
Status bad_line(const Source& source, std::size_t line, const std::string& what);
/// bad_input, "NAME, byte 340: what".
Status bad_byte(const Source& source, std::uint64_t offset, const std::string& what);

/// A piece of the file for a message: in quotes, at most 32 characters, nothing unprintable.
std::string excerpt(std::string_view text);

/// The file's name without folders and extension.
std::string stem(std::string_view name);

/// Calls LoadSettings::progress every now and then.
class LoadProgress {
 public:
  LoadProgress(const Source& source, const LoadSettings& settings, const char* stage)
      : source_(source), settings_(settings), stage_(stage) {}

  /// Steps between two calls of `at`: often enough to cancel soon, rare enough to cost nothing.
  static constexpr std::uint64_t kStep = 1u << 16;

  /// cancelled where the callback asks for it.
  Status at(double fraction) const;

 private:
  const Source& source_;
  const LoadSettings& settings_;
  const char* stage_;
};

}  // namespace fasttree::scene
