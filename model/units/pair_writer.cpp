// SPDX-License-Identifier: Apache-2.0
#include "model/units/pair_writer.h"

#include <cstring>

namespace fasttree::model {
namespace {

enum Stall : std::size_t { kBus };

}  // namespace

void pack_pair(const PaperConfig& config, std::uint32_t code, std::uint32_t id, std::uint8_t* to) {
  std::memcpy(to, &code, config.radix_sort.key_bytes);
  std::memcpy(to + config.radix_sort.key_bytes, &id, sizeof id);
}

void unpack_pair(const PaperConfig& config, const std::uint8_t* from, std::uint32_t& code,
                 std::uint32_t& id) {
  code = 0;
  std::memcpy(&code, from, config.radix_sort.key_bytes);
  std::memcpy(&id, from + config.radix_sort.key_bytes, sizeof id);
}

PairWriter::PairWriter(const PaperConfig& config, BusPort& port)
    : Unit("pair_writer", "morton_code", {"bus"}), config_(config), port_(port) {}

void PairWriter::start(Address pairs, std::uint32_t triangles, std::vector<Queue<Pair>*> units) {
  writer_.start(port_, config_.morton_code.combine_bytes, pairs, Purpose::pairs);
  units_ = std::move(units);
  unit_ = 0;
  triangles_left_ = triangles;
  written_ = 0;
  counts_.assign(std::size_t{1} << config_.radix_sort.radix_bits, 0);
}

void PairWriter::tick() {
  const std::uint32_t size = pair_bytes(config_);
  const std::uint32_t mask = (1u << config_.radix_sort.radix_bits) - 1;
  std::uint32_t taken = 0;
  std::size_t requests = 0;
  const bool counting = counting_;
  blocked_ = false;
  while (taken < config_.morton_code.pairs_per_cycle && triangles_left_ > 0) {
    Queue<Pair>& unit = *units_[unit_];
    if (!unit.valid()) break;
    // A request a cycle, of the pair that completes a block.
    requests += writer_.requests_for(size);
    if (requests > 1) break;
    if (!writer_.ready(size)) {
      blocked_ = true;
      break;
    }
    const Pair pair = unit.pop();
    std::uint8_t bytes[8];
    pack_pair(config_, pair.code, pair.id, bytes);
    writer_.put(bytes, size);
    ++counts_[pair.code & mask];
    ++written_;
    ++taken;
    if (pair.last) {
      --triangles_left_;
      if (++unit_ == units_.size()) unit_ = 0;
    }
  }
  counting_ = taken > 0;  // the digits of what was taken, in the next cycle
  if (taken == 0 && triangles_left_ == 0 && writer_.holds()) {
    if (port_.requests.ready()) {
      writer_.flush();
      busy();
    } else if (counting) {
      busy();
    } else {
      stalled(kBus);
    }
    return;
  }
  if (taken > 0 || counting) {
    busy();
  } else if (blocked_) {
    stalled(kBus);
  } else {
    idle();
  }
}

bool PairWriter::done() const {
  return triangles_left_ == 0 && !writer_.holds() && !counting_;
}

std::string PairWriter::waits_for() const {
  if (blocked_) return "the bus to take a block of pairs";
  if (triangles_left_ > 0) return "pairs of mcgu" + std::to_string(unit_);
  return {};
}

}  // namespace fasttree::model
