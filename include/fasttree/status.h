// SPDX-License-Identifier: Apache-2.0
// How every fallible call of the library reports: a status with a code and a message that says
// what went wrong, where, and what to do. The library never prints, exits or aborts.
#pragma once

#include <cassert>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>

namespace fasttree {

/// What kind of thing went wrong. The numbers are part of the C ABI.
enum class StatusCode : std::uint32_t {
  ok = 0,
  invalid_argument =
      1,          ///< the caller asked for something that cannot be (a setting, a null pointer)
  bad_input = 2,  ///< the data is wrong (NaN coordinates, a truncated file, a bad index)
  resource_limit = 3,  ///< memory, disk or a limit of the format would be exceeded
  cancelled = 4,       ///< the progress callback asked to stop
  io_error = 5,        ///< a file cannot be opened, read or written
};

/// The outcome of a call: ok, or a code with a message for a person.
class [[nodiscard]] Status {
 public:
  Status() = default;
  Status(StatusCode code, std::string message) : code_(code), message_(std::move(message)) {}

  bool ok() const { return code_ == StatusCode::ok; }
  StatusCode code() const { return code_; }
  const std::string& message() const { return message_; }

 private:
  StatusCode code_ = StatusCode::ok;
  std::string message_;
};

/// A value, or the status that says why there is none.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::in_place_index<0>, std::move(value)) {}
  Result(Status status) : content_(std::in_place_index<1>, std::move(status)) {
    assert(!std::get<1>(content_).ok() && "an ok Result needs a value");
  }

  bool ok() const { return content_.index() == 0; }
  Status status() const { return ok() ? Status() : std::get<1>(content_); }

  /// The value. Only where ok().
  T& value() & { return std::get<0>(content_); }
  const T& value() const& { return std::get<0>(content_); }
  T&& value() && { return std::get<0>(std::move(content_)); }

 private:
  std::variant<T, Status> content_;
};

}  // namespace fasttree
