// SPDX-License-Identifier: Apache-2.0
#include "device/link/messages.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "device/link/wire.h"

namespace fasttree::device {
namespace {

// Where things are in a body; docs/protocol.md has the same tables.
namespace description_at {
constexpr std::size_t kMostSceneBytes = 0, kBusy = 8, kEngine = 16, kConfig = 32, kProgram = 96;
constexpr std::size_t kEngineSize = 16, kConfigSize = 64, kProgramSize = 64;
static_assert(kProgram + kProgramSize == kDescriptionBytes);
}  // namespace description_at

namespace hello_at {
constexpr std::size_t kSceneBytes = 0, kMostResultBytes = 8, kPayload = 16, kWindow = 20,
                      kTimeout = 24, kProfile = 28, kAxes = 29, kDepth = 30, kImplementation = 31,
                      kSimd = 32, kExtraDepth = 36, kMaxGrowth = 40, kMemoryLimit = 48,
                      kTraversal = 56, kIntersection = 64, kTail = 72;
static_assert(kTail <= kHelloBytes);
}  // namespace hello_at

constexpr std::size_t kStageAt = 8;
constexpr std::size_t kMessageAt = 4;
constexpr double kWhole = 65536;

void clear(Body body) {
  std::memset(body.data(), 0, body.size());
}

bool is_payload(std::uint32_t payload) {
  return payload >= kLeastPayload && payload <= kLargestPayload && payload % kTriangleBytes == 0;
}

bool is_link(std::uint32_t payload, std::uint32_t window, std::uint32_t timeout_ms) {
  return is_payload(payload) && window >= kLeastWindow && window <= kMostWindow &&
         timeout_ms >= kLeastTimeoutMs && timeout_ms <= kMostTimeoutMs;
}

}  // namespace

void write_description(const Description& description, Body body) {
  using namespace description_at;
  clear(body);
  put(body, kMostSceneBytes, description.most_scene_bytes);
  put(body, kBusy, std::uint32_t{description.busy});
  put_text(body, kEngine, kEngineSize, description.engine);
  put_text(body, kConfig, kConfigSize, description.config);
  put_text(body, kProgram, kProgramSize, description.program);
}

std::optional<Description> read_description(ConstBody body) {
  using namespace description_at;
  if (body.size() != kDescriptionBytes) return std::nullopt;
  Description description;
  description.most_scene_bytes = get<std::uint64_t>(body, kMostSceneBytes);
  description.busy = get<std::uint32_t>(body, kBusy) != 0;
  description.engine = get_text(body, kEngine, kEngineSize);
  description.config = get_text(body, kConfig, kConfigSize);
  description.program = get_text(body, kProgram, kProgramSize);
  return description;
}

void write_hello(const Hello& hello, Body body) {
  using namespace hello_at;
  const Order& order = hello.order;
  clear(body);
  put(body, kSceneBytes, hello.scene_bytes);
  put(body, kMostResultBytes, hello.most_result_bytes);
  put(body, kPayload, hello.payload);
  put(body, kWindow, hello.window);
  put(body, kTimeout, hello.timeout_ms);
  put(body, kProfile, static_cast<std::uint8_t>(order.profile));
  put(body, kAxes, static_cast<std::uint8_t>(order.axes));
  put(body, kDepth, static_cast<std::int8_t>(std::clamp(order.depth, -128, 127)));
  put(body, kImplementation, static_cast<std::uint8_t>(order.implementation));
  put(body, kSimd, static_cast<std::uint8_t>(order.simd));
  put(body, kExtraDepth, std::int32_t{order.extra_depth});
  put(body, kMaxGrowth, order.max_growth);
  put(body, kMemoryLimit, order.memory_limit_bytes);
  put(body, kTraversal, order.sah_costs.traversal);
  put(body, kIntersection, order.sah_costs.intersection);
}

std::optional<Hello> read_hello(ConstBody body) {
  using namespace hello_at;
  if (body.size() != kHelloBytes) return std::nullopt;
  Hello hello;
  hello.scene_bytes = get<std::uint64_t>(body, kSceneBytes);
  hello.most_result_bytes = get<std::uint64_t>(body, kMostResultBytes);
  hello.payload = get<std::uint32_t>(body, kPayload);
  hello.window = get<std::uint32_t>(body, kWindow);
  hello.timeout_ms = get<std::uint32_t>(body, kTimeout);
  const auto profile = get<std::uint8_t>(body, kProfile);
  const auto axes = get<std::uint8_t>(body, kAxes);
  const auto implementation = get<std::uint8_t>(body, kImplementation);
  const auto simd = get<std::uint8_t>(body, kSimd);
  Order& order = hello.order;
  order.profile = static_cast<Profile>(profile);
  order.axes = static_cast<AxisSchedule>(axes);
  order.depth = get<std::int8_t>(body, kDepth);
  order.implementation = static_cast<Implementation>(implementation);
  order.simd = static_cast<Simd>(simd);
  order.extra_depth = get<std::int32_t>(body, kExtraDepth);
  order.max_growth = get<double>(body, kMaxGrowth);
  order.memory_limit_bytes = get<std::uint64_t>(body, kMemoryLimit);
  order.sah_costs.traversal = get<double>(body, kTraversal);
  order.sah_costs.intersection = get<double>(body, kIntersection);
  const bool sound = is_link(hello.payload, hello.window, hello.timeout_ms) &&
                     hello.scene_bytes % kTriangleBytes == 0 &&
                     profile <= static_cast<std::uint8_t>(kLastProfile) &&
                     axes <= static_cast<std::uint8_t>(AxisSchedule::longest) &&
                     implementation <= static_cast<std::uint8_t>(Implementation::reference) &&
                     simd <= static_cast<std::uint8_t>(Simd::widest) &&
                     std::isfinite(order.max_growth) && std::isfinite(order.sah_costs.traversal) &&
                     std::isfinite(order.sah_costs.intersection);
  if (!sound) return std::nullopt;
  return hello;
}

void write_accept(const Accept& accept, Body body) {
  clear(body);
  put(body, 0, accept.payload);
  put(body, 4, accept.window);
  put(body, 8, accept.timeout_ms);
}

std::optional<Accept> read_accept(ConstBody body) {
  if (body.size() != kAcceptBytes) return std::nullopt;
  Accept accept;
  accept.payload = get<std::uint32_t>(body, 0);
  accept.window = get<std::uint32_t>(body, 4);
  accept.timeout_ms = get<std::uint32_t>(body, 8);
  if (!is_link(accept.payload, accept.window, accept.timeout_ms)) return std::nullopt;
  return accept;
}

void write_refuse(const Refuse& refuse, Body body) {
  clear(body);
  put(body, 0, static_cast<std::uint32_t>(refuse.reason));
  put(body, 8, refuse.limit);
}

std::optional<Refuse> read_refuse(ConstBody body) {
  if (body.size() != kRefuseBytes) return std::nullopt;
  const auto reason = get<std::uint32_t>(body, 0);
  if (reason < 1 || reason > static_cast<std::uint32_t>(Refusal::not_possible)) return std::nullopt;
  return Refuse{static_cast<Refusal>(reason), get<std::uint64_t>(body, 8)};
}

void write_progress(const BuildProgress& progress, Body body) {
  clear(body);
  const double part = std::isfinite(progress.fraction) ? progress.fraction : 0;
  put(body, 0, static_cast<std::uint32_t>(std::clamp(part, 0.0, 1.0) * kWhole));
  put_text(body, kStageAt, kProgressBytes - kStageAt, progress.stage);
}

std::optional<BuildProgress> read_progress(ConstBody body) {
  if (body.size() != kProgressBytes) return std::nullopt;
  const double fraction = get<std::uint32_t>(body, 0) / kWhole;
  if (fraction > 1) return std::nullopt;
  return BuildProgress{get_text(body, kStageAt, kProgressBytes - kStageAt), fraction};
}

void write_offer(std::uint64_t result_bytes, Body body) {
  put(body, 0, result_bytes);
}

std::optional<std::uint64_t> read_offer(ConstBody body) {
  if (body.size() != kOfferBytes) return std::nullopt;
  return get<std::uint64_t>(body, 0);
}

std::size_t fault_bytes(const Status& status) {
  return kMessageAt + std::min(status.message().size(), kMostMessageBytes);
}

void write_fault(const Status& status, Body body) {
  put(body, 0, static_cast<std::uint32_t>(status.code()));
  put_text(body, kMessageAt, body.size() - kMessageAt, status.message());
}

std::optional<Status> read_fault(ConstBody body) {
  if (body.size() < kMessageAt || body.size() > kMessageAt + kMostMessageBytes) return std::nullopt;
  const auto code = get<std::uint32_t>(body, 0);
  if (code < 1 || code > static_cast<std::uint32_t>(StatusCode::io_error)) return std::nullopt;
  return Status(static_cast<StatusCode>(code),
                get_text(body, kMessageAt, body.size() - kMessageAt));
}

void write_close(Closing reason, Body body) {
  put(body, 0, static_cast<std::uint32_t>(reason));
}

std::optional<Closing> read_close(ConstBody body) {
  if (body.size() != kCloseBytes) return std::nullopt;
  const auto reason = get<std::uint32_t>(body, 0);
  if (reason > static_cast<std::uint32_t>(Closing::broken)) return std::nullopt;
  return static_cast<Closing>(reason);
}

}  // namespace fasttree::device
