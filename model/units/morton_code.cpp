// SPDX-License-Identifier: Apache-2.0
#include "model/units/morton_code.h"

#include <algorithm>

namespace fasttree::model {
namespace {

enum Stall : std::size_t { kPairWriter };
constexpr std::uint32_t kBounds = 6;

}  // namespace

MortonCodeUnit::MortonCodeUnit(std::string name, const PaperConfig::MortonCode& config)
    : Unit(std::move(name), "morton_code", {"pair_writer"}),
      input(config.input_queue),
      output(config.output_queue),
      config_(config) {}

void MortonCodeUnit::tick() {
  switch (state_) {
    case State::ready:
      if (!input.valid()) {
        idle();
        return;
      }
      take();
      break;
    case State::box:
      if (--wait_ == 0) {
        state_ = State::quantise;
        wait_ = config_.quantiser_latency;
      }
      break;
    case State::quantise:
      // A bound enters each quantiser every cycle; the last needs the latency to come out.
      if (quantised_ < kBounds) {
        for (std::uint32_t i = 0; i < config_.quantisers && quantised_ < kBounds; ++i) {
          quantise_one();
        }
      }
      if (quantised_ == kBounds && wait_-- <= 1) {
        cell_ = cells_.lo;
        state_ = State::iterate;
      }
      break;
    case State::iterate:
      if (!output.ready()) {
        stalled(kPairWriter);
        return;
      }
      emit();
      break;
  }
  busy();
}

// The first cycle of the box. Three units of three inputs, for the least and the greatest.
void MortonCodeUnit::take() {
  job_ = input.pop();
  for (std::size_t a = 0; a < 3; ++a) {
    const auto [least, greatest] =
        std::minmax({job_.coordinates[a], job_.coordinates[a + 3], job_.coordinates[a + 6]});
    bounds_[a] = least;
    bounds_[a + 3] = greatest;
  }
  quantised_ = 0;
  wait_ = config_.box_latency;
  state_ = State::box;
  if (wait_ > 1) {
    --wait_;
  } else {
    state_ = State::quantise;
    wait_ = config_.quantiser_latency;
  }
}

void MortonCodeUnit::quantise_one() {
  const std::size_t axis = quantised_ % 3;
  (quantised_ < 3 ? cells_.lo : cells_.hi)[axis] = grid_->quantise(axis, bounds_[quantised_]);
  ++quantised_;
}

// x fastest, then y, then z. The next triangle's box is begun while the last cell goes out.
void MortonCodeUnit::emit() {
  Pair pair{grid_->morton_code(cell_), job_.id, cell_ == cells_.hi};
  output.push(pair);
  if (pair.last) {
    state_ = State::ready;
    if (input.valid()) take();
    return;
  }
  for (std::size_t a = 0; a < 3; ++a) {
    if (cell_[a] < cells_.hi[a]) {
      ++cell_[a];
      return;
    }
    cell_[a] = cells_.lo[a];
  }
}

bool MortonCodeUnit::done() const {
  return state_ == State::ready && input.empty() && output.empty();
}

std::string MortonCodeUnit::waits_for() const {
  if (state_ == State::iterate)
    return "pair_writer to take pairs of triangle " + std::to_string(job_.id);
  return {};
}

}  // namespace fasttree::model
