// SPDX-License-Identifier: Apache-2.0
// Checked reading of JSON properties: each of the type and range it has to be, or an exception that
// names its path in the document ("accessors[3].count").
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

namespace fasttree::scene {

/// What a reader below throws; caught in the document's reader. Exceptions here because every
/// property read can fail, and the path to it is only known on the way.
struct MalformedJson {
  std::string what;
};

[[noreturn]] inline void fail(const std::string& path, const std::string& what) {
  throw MalformedJson{path + " " + what};
}

/// A JSON object with its path in the document, for messages.
class JsonObject {
 public:
  JsonObject(const nlohmann::json& value, std::string path)
      : value_(value), path_(std::move(path)) {
    if (!value_.is_object()) fail(path_.empty() ? "the document" : path_, "has to be an object.");
  }

  const std::string& path() const { return path_; }
  std::string path(const char* key) const {
    return path_.empty() ? std::string(key) : path_ + "." + key;
  }
  bool has(const char* key) const { return value_.contains(key); }

  const nlohmann::json& at(const char* key) const {
    const auto found = value_.find(key);
    if (found == value_.end()) fail(path(key), "is missing.");
    return *found;
  }
  JsonObject object(const char* key) const { return JsonObject(at(key), path(key)); }

  const nlohmann::json& array(const char* key) const {
    const nlohmann::json& value = at(key);
    if (!value.is_array()) fail(path(key), "has to be an array.");
    return value;
  }

  std::string string(const char* key) const {
    const nlohmann::json& value = at(key);
    if (!value.is_string()) fail(path(key), "has to be a string.");
    return value.get<std::string>();
  }

  bool boolean(const char* key, bool absent) const {
    if (!has(key)) return absent;
    const nlohmann::json& value = at(key);
    if (!value.is_boolean()) fail(path(key), "has to be true or false.");
    return value.get<bool>();
  }

  std::uint64_t number(const char* key) const { return whole(at(key), path(key)); }
  std::uint64_t number(const char* key, std::uint64_t absent) const {
    return has(key) ? number(key) : absent;
  }

  /// An index into an array of `size` elements.
  std::size_t index(const char* key, std::size_t size, const char* array) const {
    return checked_index(at(key), path(key), size, array);
  }
  std::optional<std::size_t> optional_index(const char* key, std::size_t size,
                                            const char* array) const {
    if (!has(key)) return std::nullopt;
    return index(key, size, array);
  }

  static std::size_t checked_index(const nlohmann::json& value, const std::string& path,
                                   std::size_t size, const char* array) {
    const std::uint64_t index = whole(value, path);
    if (index >= size) {
      fail(path, "is " + std::to_string(index) + ", but there are only " + std::to_string(size) +
                     " " + array + ".");
    }
    return static_cast<std::size_t>(index);
  }

 private:
  // JSON knows one kind of number: 3.0 is an integer, too. Up to 2^53, where every double is one
  // number; so sums and products of two such with small factors cannot overflow 64 bits.
  static std::uint64_t whole(const nlohmann::json& value, const std::string& path) {
    constexpr double kMost = 9007199254740992.0;
    if (value.is_number()) {
      const double number = value.get<double>();
      if (number >= 0 && number <= kMost && number == std::floor(number)) {
        return value.is_number_float() ? static_cast<std::uint64_t>(number)
                                       : value.get<std::uint64_t>();
      }
    }
    fail(path, "has to be a whole number from 0 up.");
  }

  const nlohmann::json& value_;
  std::string path_;
};

}  // namespace fasttree::scene
