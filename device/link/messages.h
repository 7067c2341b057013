// SPDX-License-Identifier: Apache-2.0
// What the bodies of frames say, other than data and ack. Layout by byte: docs/protocol.md. Writers
// fill the whole body; readers refuse a body of the wrong size or with a value that cannot be.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "device/order.h"
#include "fasttree/status.h"

namespace fasttree::device {

inline constexpr std::uint32_t kTriangleBytes = 36;  ///< nine binary32: three corners

// Bodies of data frames: a multiple of a triangle, so that a frame holds whole ones.
inline constexpr std::uint32_t kLeastPayload = kTriangleBytes;
inline constexpr std::uint32_t kEthernetPayload = 40 * kTriangleBytes;   ///< 1,468 bytes with frame
inline constexpr std::uint32_t kJumboPayload = 248 * kTriangleBytes;     ///< 8,956
inline constexpr std::uint32_t kLargestPayload = 1818 * kTriangleBytes;  ///< 65,476

inline constexpr std::uint32_t kLeastWindow = 8;  ///< frames that may be under way
inline constexpr std::uint32_t kMostWindow = 1024;

inline constexpr std::uint32_t kLeastTimeoutMs = 100;
inline constexpr std::uint32_t kMostTimeoutMs = 60'000;

using Body = std::span<std::byte>;
using ConstBody = std::span<const std::byte>;

/// describe carries as many bytes, so that a stranger's address gets no more than was sent.
inline constexpr std::size_t kDescriptionBytes = 160;
void write_description(const Description& description, Body body);
std::optional<Description> read_description(ConstBody body);

struct Hello {
  std::uint64_t scene_bytes = 0;
  std::uint64_t most_result_bytes = 0;  ///< what the client can hold
  std::uint32_t payload = kEthernetPayload;
  std::uint32_t window = kMostWindow;  ///< of the stream to the client
  std::uint32_t timeout_ms = 5000;
  Order order;
};
inline constexpr std::size_t kHelloBytes = 96;
void write_hello(const Hello& hello, Body body);
std::optional<Hello> read_hello(ConstBody body);

struct Accept {
  std::uint32_t payload = kEthernetPayload;
  std::uint32_t window = kMostWindow;  ///< of the stream to the server
  std::uint32_t timeout_ms = 5000;
};
inline constexpr std::size_t kAcceptBytes = 16;
void write_accept(const Accept& accept, Body body);
std::optional<Accept> read_accept(ConstBody body);

enum class Refusal : std::uint32_t { busy = 1, scene_too_large = 2, not_possible = 3 };
struct Refuse {
  Refusal reason = Refusal::busy;
  std::uint64_t limit = 0;  ///< scene_too_large: bytes it can hold
};
inline constexpr std::size_t kRefuseBytes = 16;
void write_refuse(const Refuse& refuse, Body body);
std::optional<Refuse> read_refuse(ConstBody body);

struct BuildProgress {
  std::string stage;
  double fraction = 0;
};
inline constexpr std::size_t kProgressBytes = 40;
void write_progress(const BuildProgress& progress, Body body);
std::optional<BuildProgress> read_progress(ConstBody body);

inline constexpr std::size_t kOfferBytes = 8;
void write_offer(std::uint64_t result_bytes, Body body);
std::optional<std::uint64_t> read_offer(ConstBody body);

/// A status that is not ok. The message is cut to what fits a frame of Ethernet.
inline constexpr std::size_t kMostMessageBytes = 1024;
std::size_t fault_bytes(const Status& status);
void write_fault(const Status& status, Body body);
std::optional<Status> read_fault(ConstBody body);

enum class Closing : std::uint32_t { done = 0, cancelled = 1, result_too_large = 2, broken = 3 };
inline constexpr std::size_t kCloseBytes = 4;
void write_close(Closing reason, Body body);
std::optional<Closing> read_close(ConstBody body);

}  // namespace fasttree::device
