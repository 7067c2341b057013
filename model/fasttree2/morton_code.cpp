// SPDX-License-Identifier: Apache-2.0
#include "model/fasttree2/morton_code.h"

#include <algorithm>

namespace fasttree::model::ft2 {

namespace {
enum Reason : std::size_t { kScene, kCombiner };
constexpr std::uint32_t kQuantisations = 6;
}  // namespace

MortonCode::MortonCode(Registers& registers, Queue<SceneTriangle>& in, Queue<BucketRecord>& out)
    : Unit("morton_code", "morton_code", {"scene_reader", "write_combiner"}),
      r_(registers),
      in_(in),
      out_(out),
      boxes_(registers.config.quantiser_latency) {}

void MortonCode::begin() {
  active_ = true;
  credit_ = 0;
  taken_ = 0;
  references_ = 0;
  records_ = 0;
}

void MortonCode::abandon() {
  active_ = false;
  walk_ = BoxWalk();
  while (!boxes_.empty()) boxes_.pop();
}

bool MortonCode::quantise() {
  // `quantisers` results a cycle; what is left of a cycle goes to the next triangle.
  credit_ = std::min(credit_ + r_.config.quantisers,
                     std::max(2 * kQuantisations - 1, r_.config.quantisers));
  if (!in_.valid() || credit_ < kQuantisations || !boxes_.ready()) return false;
  credit_ -= kQuantisations;
  const SceneTriangle triangle = in_.pop();
  // Quantising is monotone, so the box comes first and six results are enough.
  TriangleBox out;
  out.id = triangle.id;
  for (std::size_t a = 0; a < 3; ++a) {
    const float lo = std::min({triangle.v[a], triangle.v[a + 3], triangle.v[a + 6]});
    const float hi = std::max({triangle.v[a], triangle.v[a + 3], triangle.v[a + 6]});
    out.box.lo[a] = r_.levels.grid().quantise(a, lo);
    out.box.hi[a] = r_.levels.grid().quantise(a, hi);
  }
  boxes_.push(out, r_.cycle);
  ++taken_;
  return true;
}

bool MortonCode::emit() {
  const auto& inside_bits = r_.levels.bits_below(r_.bucket_bits);
  if (!walk_.active()) {
    if (!boxes_.valid(r_.cycle)) return false;
    walk_ = BoxWalk(boxes_.front().box, inside_bits);
    id_ = boxes_.front().id;
    references_ += boxes_.front().box.count();
    boxes_.pop();
  }
  if (!out_.ready()) return false;
  const Cell& at = walk_.at();
  const Cell corner{at[0] << inside_bits[0], at[1] << inside_bits[1], at[2] << inside_bits[2]};
  const std::uint32_t bucket =
      r_.levels.grid().morton_code(corner) >> (r_.levels.depth() - r_.bucket_bits);
  if (records_++ != r_.faults.drop_record) out_.push({bucket, {id_, walk_.inside()}});
  walk_.advance();
  return true;
}

void MortonCode::tick() {
  if (!active_) {
    if (in_.valid()) in_.pop();
    return idle();
  }
  const bool emitted = emit();
  const bool quantised = quantise();
  if (emitted || quantised) return busy();
  if (walk_.active()) return stalled(kCombiner);
  if (taken_ < r_.triangles) return stalled(kScene);
  if (!boxes_.empty()) return busy();
  active_ = false;
  idle();
}

bool MortonCode::done() const {
  return !active_ || (taken_ == r_.triangles && boxes_.empty() && !walk_.active());
}

std::string MortonCode::waits_for() const {
  if (done()) return "";
  if (walk_.active()) return "write_combiner to take a record of triangle " + std::to_string(id_);
  return "scene_reader for triangle " + std::to_string(taken_);
}

}  // namespace fasttree::model::ft2
