// SPDX-License-Identifier: Apache-2.0
#include "model/units/radix_sort.h"

#include <algorithm>

#include "model/units/pair_writer.h"

namespace fasttree::model {
namespace {

enum Stall : std::size_t { kBusRead, kBusWrite, kPrefixSum };
constexpr std::uint16_t kNoDigit = 0xffff;

}  // namespace

RadixSortUnit::RadixSortUnit(const PaperConfig& config, BusPort& port,
                             std::vector<PrefixSumUnit*> psus)
    : Unit("rsu", "radix_sort", {"bus (reading)", "bus (writing)", "prefix_sum"}),
      config_(config),
      radix_(1u << config.radix_sort.radix_bits),
      pair_size_(pair_bytes(config)),
      capacity_(config.prefix_sum.units * config.prefix_sum.section),
      port_(port),
      reader_(port, config.bus.burst_bytes),
      psus_(std::move(psus)),
      begin_(radix_),
      writers_(radix_),
      id_writers_(radix_) {
  for (Buffer& buffer : buffers_) {
    buffer.raw.resize(std::size_t{capacity_} * pair_size_);
    buffer.code.resize(capacity_);
    buffer.id.resize(capacity_);
    buffer.place.resize(capacity_);
    buffer.digit.resize(capacity_);
  }
}

void RadixSortUnit::start(const SortRound& round, const std::vector<std::uint32_t>& counts) {
  round_ = round;
  counts_ = counts;
  const bool own_pass = config_.radix_sort.digit_count == DigitCount::own_pass;
  if (own_pass) counts_.assign(radix_, 0);
  next_counts_.assign(radix_, 0);
  reader_.start(round_.from, round_.pairs * pair_size_, Purpose::pairs);
  partial_bytes_ = 0;
  offset_section_ = 0;
  offset_asked_ = false;
  offset_ = 0;
  for (Buffer& buffer : buffers_) buffer.want = buffer.bytes = buffer.count = 0;
  loading_ = working_ = 0;
  work_ = Work::none;
  fetched_pairs_ = 0;
  next_flush_ = 0;
  state_ = own_pass ? State::count : State::offsets;
}

void RadixSortUnit::tick() {
  bool worked = false;
  switch (state_) {
    case State::count:
      reader_.tick();
      worked = count_pass();
      break;
    case State::offsets:
      // The stream may run ahead while the digits' begins are summed.
      reader_.tick();
      worked = offsets();
      break;
    case State::move:
      reader_.tick();
      worked = work_ == Work::scan ? scan() : work_ == Work::scatter && scatter();
      worked |= fetch();
      break;
    case State::flush:
      worked = flush();
      break;
    case State::done:
      idle();
      return;
  }
  if (worked) {
    busy();
  } else {
    stalled(waits_);
  }
}

bool RadixSortUnit::count_pass() {
  if (reader_.left() == 0) {
    reader_.start(round_.from, round_.pairs * pair_size_, Purpose::pairs);
    state_ = State::offsets;
    return true;
  }
  const std::size_t bytes = std::min<std::uint64_t>(config_.bus.bytes, reader_.left());
  if (reader_.available() < bytes) {
    waits_ = kBusRead;
    return false;
  }
  reader_.take(partial_.data() + partial_bytes_, bytes);
  partial_bytes_ += static_cast<std::uint32_t>(bytes);
  std::uint32_t at = 0;
  for (; at + pair_size_ <= partial_bytes_; at += pair_size_) {
    std::uint32_t code = 0;
    std::uint32_t id = 0;
    unpack_pair(config_, partial_.data() + at, code, id);
    ++counts_[digit(code, round_.number)];
  }
  std::copy(partial_.begin() + at, partial_.begin() + partial_bytes_, partial_.begin());
  partial_bytes_ -= at;
  return true;
}

// The digits' counts, a section at a time, through the first prefix sum unit.
bool RadixSortUnit::offsets() {
  const std::uint32_t length = config_.prefix_sum.section;
  const std::uint32_t first = offset_section_ * length;
  const std::uint32_t count = std::min(length, radix_ - first);
  PrefixSumUnit& psu = *psus_.front();
  if (!offset_asked_) {
    if (!psu.input.ready()) {
      waits_ = kPrefixSum;
      return false;
    }
    Section section(length);
    std::fill_n(section.values, length, 0);
    std::copy_n(counts_.begin() + first, count, section.values);
    psu.input.push(section);
    offset_asked_ = true;
    return true;
  }
  if (!psu.output.valid()) {
    waits_ = kPrefixSum;
    return false;
  }
  const Section sums = psu.output.pop();
  for (std::uint32_t d = 0; d < count; ++d) begin_[first + d] = offset_ + sums.values[d];
  offset_ += sums.total;
  offset_asked_ = false;
  if (++offset_section_ * length < radix_) return true;
  for (std::uint32_t d = 0; d < radix_; ++d) {
    const std::uint64_t size = round_.last ? 4 : pair_size_;
    writers_[d].start(port_, config_.radix_sort.combine_bytes,
                      Address(round_.to.value + begin_[d] * size),
                      round_.last ? Purpose::sorted_codes : Purpose::pairs);
    if (round_.last) {
      id_writers_[d].start(port_, config_.radix_sort.combine_bytes,
                           Address(round_.to_ids.value + begin_[d] * size), Purpose::sorted_ids);
    }
  }
  state_ = State::move;
  return true;
}

// A bus width of pairs into the section that is being loaded. With one buffer that waits until the
// section before has been moved.
bool RadixSortUnit::fetch() {
  Buffer& buffer = buffers_[loading_];
  if (buffer.count > 0) {
    // Loaded: waits for its turn.
    if (work_ != Work::none) return false;
    working_ = loading_;
    if (config_.radix_sort.double_buffer) loading_ ^= 1;
    work_ = Work::scan;
    asked_digits_ = summed_digits_ = 0;
    return true;
  }
  if (work_ != Work::none && working_ == loading_) return false;
  if (buffer.want == 0) {
    if (fetched_pairs_ == round_.pairs) {
      if (work_ == Work::none) state_ = State::flush;
      return false;
    }
    begin_fetch(buffer);
  }
  const std::size_t bytes = std::min(config_.bus.bytes, buffer.want - buffer.bytes);
  if (reader_.available() < bytes) {
    if (work_ == Work::none) waits_ = kBusRead;
    return false;
  }
  reader_.take(buffer.raw.data() + buffer.bytes, bytes);
  buffer.bytes += static_cast<std::uint32_t>(bytes);
  if (buffer.bytes == buffer.want) {
    unpack(buffer);
    // The scan may begin in the next cycle.
    if (work_ == Work::none) {
      working_ = loading_;
      if (config_.radix_sort.double_buffer) loading_ ^= 1;
      work_ = Work::scan;
      asked_digits_ = summed_digits_ = 0;
    }
  }
  return true;
}

void RadixSortUnit::begin_fetch(Buffer& buffer) {
  const auto pairs =
      static_cast<std::uint32_t>(std::min<std::uint64_t>(capacity_, round_.pairs - fetched_pairs_));
  fetched_pairs_ += pairs;
  buffer.want = pairs * pair_size_;
  buffer.bytes = 0;
}

void RadixSortUnit::unpack(Buffer& buffer) {
  buffer.count = buffer.want / pair_size_;
  buffer.want = 0;
  for (std::uint32_t i = 0; i < buffer.count; ++i) {
    unpack_pair(config_, buffer.raw.data() + std::size_t{i} * pair_size_, buffer.code[i],
                buffer.id[i]);
    buffer.digit[i] = static_cast<std::uint16_t>(digit(buffer.code[i], round_.number));
  }
  std::fill(buffer.digit.begin() + buffer.count, buffer.digit.end(), kNoDigit);
}

// For each digit every unit sums the flags of the pairs with that digit: their ranks.
bool RadixSortUnit::scan() {
  bool worked = false;
  if (asked_digits_ < radix_ &&
      std::all_of(psus_.begin(), psus_.end(), [](auto* psu) { return psu->input.ready(); })) {
    send_flags();
    worked = true;
  }
  if (std::all_of(psus_.begin(), psus_.end(), [](auto* psu) { return psu->output.valid(); })) {
    collect_sums();
    worked = true;
  }
  if (!worked) waits_ = kPrefixSum;
  return worked;
}

void RadixSortUnit::send_flags() {
  const Buffer& buffer = buffers_[working_];
  const std::uint32_t length = config_.prefix_sum.section;
  for (std::uint32_t p = 0; p < psus_.size(); ++p) {
    Section section(length);
    const std::uint16_t* digits = buffer.digit.data() + p * length;
    const auto asked = static_cast<std::uint16_t>(asked_digits_);
    for (std::uint32_t i = 0; i < length; ++i) section.values[i] = digits[i] == asked;
    section.tag = asked_digits_;
    psus_[p]->input.push(section);
  }
  ++asked_digits_;
}

// The units' totals give each the offset that is added to its sums.
void RadixSortUnit::collect_sums() {
  Buffer& buffer = buffers_[working_];
  const std::uint32_t length = config_.prefix_sum.section;
  std::uint32_t offset = begin_[summed_digits_];
  for (std::uint32_t p = 0; p < psus_.size(); ++p) {
    const Section& sums = psus_[p]->output.front();
    const std::uint16_t* digits = buffer.digit.data() + p * length;
    std::uint32_t* places = buffer.place.data() + p * length;
    const auto summed = static_cast<std::uint16_t>(sums.tag);
    for (std::uint32_t i = 0; i < length; ++i) {
      places[i] = digits[i] == summed ? offset + sums.values[i] : places[i];
    }
    offset += sums.total;
    psus_[p]->output.drop();
  }
  begin_[summed_digits_] = offset;
  if (++summed_digits_ == radix_) {
    work_ = Work::scatter;
    next_pair_ = 0;
  }
}

bool RadixSortUnit::scatter() {
  Buffer& buffer = buffers_[working_];
  std::uint32_t moved = 0;
  while (moved < config_.radix_sort.pairs_per_cycle && next_pair_ < buffer.count) {
    if (!place(buffer, next_pair_)) {
      waits_ = kBusWrite;
      break;
    }
    ++next_counts_[digit(buffer.code[next_pair_], round_.number + 1)];
    ++next_pair_;
    ++moved;
  }
  if (next_pair_ == buffer.count) {
    buffer.count = 0;
    work_ = Work::none;
  }
  return moved > 0;
}

// To its place, through the block that gathers its digit's pairs.
bool RadixSortUnit::place(const Buffer& buffer, std::uint32_t i) {
  const std::uint32_t d = buffer.digit[i];
  const std::uint64_t at = buffer.place[i];
  if (!round_.last) {
    std::uint8_t bytes[8];
    pack_pair(config_, buffer.code[i], buffer.id[i], bytes);
    return put(writers_[d], Address(round_.to.value + at * pair_size_), Purpose::pairs, bytes,
               pair_size_);
  }
  // Both or none.
  const Address code_at(round_.to.value + at * 4);
  const Address id_at(round_.to_ids.value + at * 4);
  const std::size_t requests = writers_[d].requests_for(4) + id_writers_[d].requests_for(4) +
                               (writers_[d].next() != code_at && writers_[d].holds()) +
                               (id_writers_[d].next() != id_at && id_writers_[d].holds());
  if (!port_.requests.ready(requests)) return false;
  put(writers_[d], code_at, Purpose::sorted_codes, &buffer.code[i], 4);
  put(id_writers_[d], id_at, Purpose::sorted_ids, &buffer.id[i], 4);
  return true;
}

bool RadixSortUnit::put(BlockWriter& writer, Address at, Purpose purpose, const void* bytes,
                        std::uint32_t size) {
  const bool elsewhere = writer.next() != at;
  if (!port_.requests.ready(writer.requests_for(size) + (elsewhere && writer.holds())))
    return false;
  if (elsewhere) {
    writer.flush();
    writer.start(port_, config_.radix_sort.combine_bytes, at, purpose);
  }
  writer.put(bytes, size);
  return true;
}

// What the digits' blocks still hold, one a cycle.
bool RadixSortUnit::flush() {
  while (next_flush_ < 2 * radix_) {
    const bool ids = next_flush_ >= radix_;
    if (ids && !round_.last) break;
    BlockWriter& writer = ids ? id_writers_[next_flush_ - radix_] : writers_[next_flush_];
    if (writer.holds()) {
      if (!port_.requests.ready()) {
        waits_ = kBusWrite;
        return false;
      }
      writer.flush();
      ++next_flush_;
      return true;
    }
    ++next_flush_;
  }
  state_ = State::done;
  return true;
}

std::string RadixSortUnit::waits_for() const {
  if (state_ == State::done) return {};
  const std::string where = ", round " + std::to_string(round_.number + 1);
  if (waits_ == kPrefixSum) return "prefix_sum to give a section's sums" + where;
  if (waits_ == kBusWrite) return "the bus to take a block" + where;
  return std::to_string(reader_.left()) + " bytes of pairs from the bus" + where;
}

}  // namespace fasttree::model
