// SPDX-License-Identifier: Apache-2.0
#include "model/units/leaf_node.h"

#include <algorithm>

namespace fasttree::model {
namespace {

enum Stall : std::size_t { kBusRead, kBusWrite };

}  // namespace

LeafNodeUnit::LeafNodeUnit(const PaperConfig& config, BusPort& reads, BusPort& codes, BusPort& rows)
    : Unit("lngu", "leaf_node", {"bus (reading)", "bus (writing)"}),
      config_(config),
      code_port_(codes),
      row_port_(rows),
      reader_(reads, config.bus.burst_bytes),
      codes_(config.leaf_node.width),
      pool_(std::max(config.leaf_node.pool, 2u)) {}

void LeafNodeUnit::start(Address sorted_codes, std::uint64_t references, Address leaf_codes,
                         Address leaf_rows) {
  reader_.start(sorted_codes, references * 4, Purpose::sorted_codes);
  code_writer_.start(code_port_, kMaxRequestBytes, leaf_codes, Purpose::leaf_codes);
  row_writer_.start(row_port_, kMaxRequestBytes, leaf_rows, Purpose::leaf_rows);
  references_ = references;
  loaded_bytes_ = 0;
  base_ = 0;
  found_.clear();
  pool_first_ = pool_count_ = 0;
  leaves_ = 0;
  finished_ = false;
  if (references == 0) {
    const std::uint32_t empty_row[2] = {0, 0};
    row_writer_.put(empty_row, sizeof empty_row);
  }
}

void LeafNodeUnit::tick() {
  if (finished_) {
    idle();
    return;
  }
  reader_.tick();
  waits_ = kBusRead;
  bool worked = write_rows();
  worked |= move();
  worked |= compare();
  worked |= take_codes();
  if (!worked) worked = finish();
  if (worked) {
    busy();
  } else {
    stalled(waits_);
  }
}

bool LeafNodeUnit::take_codes() {
  const std::size_t bytes = std::min<std::uint64_t>(
      {config_.bus.bytes, reader_.left(), codes_.size() * 4 - loaded_bytes_});
  if (bytes == 0 || reader_.available() < bytes) return false;
  reader_.take(reinterpret_cast<std::uint8_t*>(codes_.data()) + loaded_bytes_, bytes);
  loaded_bytes_ += static_cast<std::uint32_t>(bytes);
  return true;
}

// All loaded codes with their neighbours below, when the leaves found before are in the pool.
bool LeafNodeUnit::compare() {
  const std::uint32_t count = loaded_bytes_ / 4;
  if (count == 0 || (count < codes_.size() && reader_.left() > 0)) return false;
  if (!found_.empty()) return false;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t before = i == 0 ? previous_ : codes_[i - 1];
    if (base_ + i != 0 && before == codes_[i]) continue;
    found_.push_back({codes_[i], static_cast<std::uint32_t>(base_ + i)});
  }
  previous_ = codes_[count - 1];
  base_ += count;
  loaded_bytes_ = 0;
  return true;
}

// A priority encoder finds the next flag, so leaves go to the pool at the rate of the rows.
bool LeafNodeUnit::move() {
  std::uint32_t moved = 0;
  while (moved < config_.leaf_node.rows_per_cycle && !found_.empty() &&
         pool_count_ < pool_.size()) {
    pool_[(pool_first_ + pool_count_++) % pool_.size()] = found_.front();
    found_.pop_front();
    ++moved;
  }
  return moved > 0;
}

// A leaf's size is the next one's base less its own; the last one waits for the end.
bool LeafNodeUnit::write_rows() {
  std::uint32_t written = 0;
  while (written < config_.leaf_node.rows_per_cycle && pool_count_ > 0) {
    const bool at_end = base_ == references_ && found_.empty();
    if (pool_count_ == 1 && !at_end) break;
    if (!code_writer_.ready(4) || !row_writer_.ready(8)) {
      waits_ = kBusWrite;
      break;
    }
    const Leaf leaf = pool(0);
    const auto end = pool_count_ > 1 ? pool(1).first : static_cast<std::uint32_t>(references_);
    const std::uint32_t row[2] = {leaf.first, end - leaf.first};
    code_writer_.put(&leaf.code, sizeof leaf.code);
    row_writer_.put(row, sizeof row);
    pool_first_ = (pool_first_ + 1) % pool_.size();
    --pool_count_;
    ++leaves_;
    ++written;
  }
  return written > 0;
}

bool LeafNodeUnit::finish() {
  if (base_ != references_ || !found_.empty() || pool_count_ > 0) return false;
  if (!code_port_.requests.ready() || !row_port_.requests.ready()) {
    waits_ = kBusWrite;
    return false;
  }
  code_writer_.flush();
  row_writer_.flush();
  finished_ = true;
  return true;
}

std::string LeafNodeUnit::waits_for() const {
  if (finished_) return {};
  if (waits_ == kBusWrite) return "the bus to take rows of the leaf table";
  return std::to_string(reader_.left()) + " bytes of codes from the bus";
}

}  // namespace fasttree::model
