// SPDX-License-Identifier: Apache-2.0
// Any bytes as a datagram, and as the body of every message, and as a result: read or refused, and
// what is read comes back from its own bytes unchanged.
//
// Run: frame_fuzz -max_len=4096 NEW_FINDS fuzz/corpus/frame
//
// Almost every mutation would end at the checksum. So each input is tried twice: as it is, and with
// length and checksum made right.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

#include "device/link/frame.h"
#include "device/link/messages.h"
#include "device/link/result.h"
#include "device/link/stream_memory.h"

namespace {

using namespace fasttree::device;
using Bytes = std::vector<std::byte>;

void expect(bool fact) {
  if (!fact) std::abort();
}

// What was read is written, read and written again: the same bytes.
template <typename Read, typename Write>
void try_body(std::span<const std::byte> body, Read read, Write write) {
  const auto message = read(body);
  if (!message) return;
  Bytes once(body.size()), again(body.size());
  write(*message, Body(once));
  const auto same = read(ConstBody(once));
  expect(same.has_value());
  write(*same, Body(again));
  expect(once == again);
}

void try_bodies(std::span<const std::byte> body) {
  try_body(body, read_description, write_description);
  try_body(body, read_hello, write_hello);
  try_body(body, read_accept, write_accept);
  try_body(body, read_refuse, write_refuse);
  try_body(body, read_progress, write_progress);
  try_body(body, read_offer, write_offer);
  try_body(body, read_fault, write_fault);
  try_body(body, read_close, write_close);
}

void try_result(std::span<const std::byte> bytes) {
  const StreamMemory memory = StreamMemory::allocate(bytes.size());
  std::copy(bytes.begin(), bytes.end(), memory.bytes().begin());
  const auto outcome = parse_result(memory.bytes(), memory.owner());
  if (!outcome.ok()) {
    expect(!outcome.status().message().empty());
    return;
  }
  // Every node and id of it is inside.
  std::uint64_t sum = 0;
  for (const fasttree::Node& node : outcome.value().tree.nodes()) sum += node.word0;
  for (const std::uint32_t id : outcome.value().tree.ids()) sum += id;
  const ResultSource source(outcome.value());
  expect(source.size() == bytes.size() || sum == 0);
}

void try_datagram(std::span<const std::byte> datagram) {
  Frame frame;
  if (parse_frame(datagram, frame) != FrameFault::none) return;
  expect(frame.body.size() + kFrameOverhead == datagram.size());
  Bytes again(datagram.begin(), datagram.end());
  again[6] = again[7] = std::byte{0};  // reserved: ignored by readers, zero from writers
  Bytes written = again;
  finish_frame(frame.header, written);
  expect(std::equal(written.begin(), written.end() - kChecksumBytes, again.begin()));
  try_bodies(frame.body);
}

Bytes made_right(std::span<const std::byte> content) {
  Bytes bytes(content.begin(), content.end());
  bytes.resize(std::clamp<std::size_t>(bytes.size(), kFrameOverhead, kMostDatagramBytes));
  FrameHeader header;
  header.type = static_cast<FrameType>(bytes[3]);
  std::memcpy(&header.session, bytes.data() + 8, 8);
  std::memcpy(&header.sequence, bytes.data() + 16, 4);
  std::memcpy(&header.timestamp, bytes.data() + 20, 4);
  finish_frame(header, bytes);
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span content(reinterpret_cast<const std::byte*>(data), size);
  try_datagram(content);
  try_datagram(made_right(content));
  try_bodies(content);
  try_result(content);
  return 0;
}
