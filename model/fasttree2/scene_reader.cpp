// SPDX-License-Identifier: Apache-2.0
#include "model/fasttree2/scene_reader.h"

#include <algorithm>
#include <cstring>

namespace fasttree::model::ft2 {

namespace {
enum Reason : std::size_t { kMemory, kConsumer };
}  // namespace

SceneReader::SceneReader(Registers& registers, Dma& dma, Queue<SceneTriangle>& to_bounds,
                         Queue<SceneTriangle>& to_codes)
    : Unit("scene_reader", "scene_bound", {"memory", "consumer"}),
      r_(registers),
      port_(dma.add_read("scene", registers.config.scene_prefetch_bytes)),
      bounds_queue_(to_bounds),
      codes_queue_(to_codes) {}

void SceneReader::begin(bool to_bounds, bool to_codes) {
  to_bounds_ = to_bounds;
  to_codes_ = to_codes;
  bytes_ = std::uint64_t{r_.triangles} * kTriangleBytes;
  requested_ = 0;
  sent_ = 0;
  held_ = 0;
}

void SceneReader::tick() {
  if (done()) return idle();
  // One request a cycle keeps ahead of any memory it was sized for.
  if (requested_ < bytes_ && port_.ready()) {
    const auto bytes = static_cast<std::uint32_t>(
        std::min<std::uint64_t>(port_.beat_bytes(), bytes_ - requested_));
    if (beats_requested_++ != r_.faults.lost_beat) {
      port_.request(r_.layout.scene + Address(requested_), bytes);
    }
    requested_ += bytes;
  }
  // Two beats a cycle fit the gearbox, so a triangle a cycle is not held up by the beats' edges.
  bool moved = false;
  for (int i = 0; i < 2 && port_.valid(); ++i) {
    const Beat& beat = port_.front();
    if (held_ + beat.bytes > gathered_.size()) break;
    std::copy_n(beat.data.begin(), beat.bytes, gathered_.begin() + held_);
    held_ += beat.bytes;
    port_.pop();
    moved = true;
  }
  if (held_ < kTriangleBytes) return moved ? busy() : stalled(kMemory);
  if ((to_bounds_ && !bounds_queue_.ready()) || (to_codes_ && !codes_queue_.ready())) {
    return stalled(kConsumer);
  }
  SceneTriangle triangle;
  triangle.id = sent_++;
  std::memcpy(triangle.v.data(), gathered_.data(), kTriangleBytes);
  held_ -= kTriangleBytes;
  std::memmove(gathered_.data(), gathered_.data() + kTriangleBytes, held_);
  if (to_bounds_) bounds_queue_.push(triangle);
  if (to_codes_) codes_queue_.push(triangle);
  busy();
}

std::string SceneReader::waits_for() const {
  if (done()) return "";
  const std::string triangle = "triangle " + std::to_string(sent_);
  if (held_ >= kTriangleBytes) return "room for " + triangle + " in its consumer";
  return "memory for the bytes of " + triangle;
}

}  // namespace fasttree::model::ft2
