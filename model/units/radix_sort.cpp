// SPDX-License-Identifier: Apache-2.0
#include "model/units/radix_sort.h"

#include <algorithm>

#include "model/units/pair_writer.h"

namespace fasttree::model {
namespace {

enum Stall : std::size_t { kBusRead, kBusWrite, kPrefixSum };
constexpr std::uint16_t kNoDigit = 0xffff;

}  // namespace

RadixSortUnit::RadixSortUnit(const PaperConfig& config, BusPort& reads, BusPort& port,
                             std::vector<PrefixSumUnit*> psus)
    : Unit("rsu", "radix_sort", {"bus (reading)", "bus (writing)", "prefix_sum"}),
      config_(config),
      radix_(1u << config.radix_sort.radix_bits),
      pair_size_(pair_bytes(config)),
      capacity_(config.prefix_sum.units * config.prefix_sum.section),
      port_(port),
      reader_(reads, config.bus.burst_bytes),
      psus_(std::move(psus)),
      begin_(radix_),
      writers_(radix_),
      id_writers_(radix_),
      blocks_(std::size_t{4} * config.radix_sort.pairs_per_cycle),
      waiting_(radix_) {
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
  offset_digits_ = 0;
  offset_asked_ = false;
  offset_ = 0;
  for (Buffer& buffer : buffers_) buffer.want = buffer.bytes = buffer.count = 0;
  loading_ = working_ = 0;
  work_ = Work::none;
  flags_made_ = false;
  fetched_pairs_ = 0;
  next_flush_ = 0;
  state_ = own_pass ? State::count : State::offsets;
}

// What lies in registers as the cycle begins decides; so the pairs on their way move before the
// section's work adds to them.
void RadixSortUnit::tick() {
  if (state_ == State::done) {
    idle();
    return;
  }
  reader_.tick();
  reading_ = ranked_.count > 0;
  empty_ = !reading_ && placed_.count == 0 && blocks_.empty() && !out_full_;
  advance();
  hand_on();
  const bool worked = step();
  blocks_.clock();
  if (worked) {
    busy();
  } else {
    stalled(waits_);
  }
}

bool RadixSortUnit::step() {
  switch (state_) {
    case State::count:
      return count_pass();
    case State::offsets:
      // The stream may run ahead while the digits' begins are summed.
      return offsets();
    case State::move: {
      bool worked = fetch();
      worked |= work_ == Work::scan ? scan() : work_ == Work::scatter && scatter();
      choose_work();
      return worked;
    }
    case State::drain:
      waits_ = kBusWrite;
      if (empty_) state_ = State::flush;
      return empty_;
    case State::flush:
      waits_ = kBusWrite;
      if (!room_for_blocks()) return false;
      flush(next_flush_);
      if (++next_flush_ == radix_) state_ = State::finish;
      return true;
    default:
      waits_ = kBusWrite;
      if (empty_) state_ = State::done;
      return empty_;
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

// The digits' counts, a section at a time, through the first prefix sum unit; their begins one a
// cycle out of its result.
bool RadixSortUnit::offsets() {
  const std::uint32_t length = config_.prefix_sum.section;
  const std::uint32_t first = offset_digits_ / length * length;
  const std::uint32_t count = std::min(length, radix_ - first);
  PrefixSumUnit& psu = *psus_.front();
  waits_ = kPrefixSum;
  if (!offset_asked_) {
    if (!psu.ready()) return false;
    Section section(length);
    std::fill_n(section.values, length, 0);
    std::copy_n(counts_.begin() + first, count, section.values);
    psu.push(section);
    offset_asked_ = true;
    return true;
  }
  if (!psu.valid()) return false;
  begin_[offset_digits_] = offset_ + psu.front().values[offset_digits_ - first];
  if (++offset_digits_ < first + count) return true;
  offset_ += psu.front().total;
  psu.drop();
  offset_asked_ = false;
  if (offset_digits_ == radix_) {
    start_writers();
    state_ = round_.pairs > 0 ? State::move : State::drain;
  }
  return true;
}

void RadixSortUnit::start_writers() {
  const std::uint64_t size = round_.last ? 4 : pair_size_;
  for (std::uint32_t d = 0; d < radix_; ++d) {
    writers_[d].start(blocks_, config_.radix_sort.combine_bytes,
                      Address(round_.to.value + begin_[d] * size),
                      round_.last ? Purpose::sorted_codes : Purpose::pairs);
    if (round_.last) {
      id_writers_[d].start(blocks_, config_.radix_sort.combine_bytes,
                           Address(round_.to_ids.value + begin_[d] * size), Purpose::sorted_ids);
    }
  }
}

// A bus width of pairs into the section that is being loaded. With one buffer that waits until the
// section before has been moved.
bool RadixSortUnit::fetch() {
  Buffer& buffer = buffers_[loading_];
  if (buffer.count > 0) return false;
  if (buffer.want == 0) {
    if (fetched_pairs_ == round_.pairs) return false;
    begin_fetch(buffer);
  }
  const std::size_t bytes = std::min(config_.bus.bytes, buffer.want - buffer.bytes);
  if (reader_.available() < bytes) {
    if (work_ == Work::none) waits_ = kBusRead;
    return false;
  }
  reader_.take(buffer.raw.data() + buffer.bytes, bytes);
  buffer.bytes += static_cast<std::uint32_t>(bytes);
  if (buffer.bytes == buffer.want) unpack(buffer);
  return true;
}

// What the next cycle works at.
void RadixSortUnit::choose_work() {
  if (work_ != Work::none) return;
  if (buffers_[loading_].count > 0) {
    working_ = loading_;
    if (config_.radix_sort.double_buffer) loading_ ^= 1;
    work_ = Work::scan;
    asked_digits_ = summed_digits_ = 0;
  } else if (fetched_pairs_ == round_.pairs && buffers_[loading_].want == 0) {
    state_ = State::drain;
  }
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

// For each digit every unit sums the flags of the pairs with that digit: their ranks. The flags go
// through a register. Not while a place is still to be made from the begins, which change now.
bool RadixSortUnit::scan() {
  bool worked = false;
  if (std::all_of(psus_.begin(), psus_.end(), [](auto* psu) { return psu->valid(); })) {
    collect_sums();
    worked = true;
  }
  if (flags_made_ &&
      std::all_of(psus_.begin(), psus_.end(), [](auto* psu) { return psu->ready(); })) {
    send_flags();
    worked = true;
  }
  if (asked_digits_ < radix_ && !reading_ && !flags_made_) {
    flags_made_ = true;
    worked = true;
  }
  waits_ = reading_ ? kBusWrite : kPrefixSum;
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
    psus_[p]->push(section);
  }
  ++asked_digits_;
  flags_made_ = false;
}

// The units' totals give each the offset that is added to its sums.
void RadixSortUnit::collect_sums() {
  Buffer& buffer = buffers_[working_];
  const std::uint32_t length = config_.prefix_sum.section;
  std::uint32_t offset = begin_[summed_digits_];
  for (std::uint32_t p = 0; p < psus_.size(); ++p) {
    const Section& sums = psus_[p]->front();
    const std::uint16_t* digits = buffer.digit.data() + p * length;
    std::uint32_t* places = buffer.place.data() + p * length;
    const auto summed = static_cast<std::uint16_t>(sums.tag);
    for (std::uint32_t i = 0; i < length; ++i) {
      places[i] = digits[i] == summed ? offset + sums.values[i] : places[i];
    }
    offset += sums.total;
    psus_[p]->drop();
  }
  begin_[summed_digits_] = offset;
  if (++summed_digits_ == radix_) {
    work_ = Work::scatter;
    next_pair_ = 0;
  }
}

// The next pairs of the section, where those on their way have moved on.
bool RadixSortUnit::scatter() {
  Buffer& buffer = buffers_[working_];
  waits_ = kBusWrite;
  if (!advanced_) return false;
  ranked_.count = std::min(config_.radix_sort.pairs_per_cycle, buffer.count - next_pair_);
  for (std::uint32_t i = 0; i < ranked_.count; ++i, ++next_pair_) {
    ranked_.items[i] = {buffer.code[next_pair_], buffer.id[next_pair_], buffer.place[next_pair_],
                        buffer.digit[next_pair_]};
  }
  if (next_pair_ == buffer.count) {
    buffer.count = 0;
    work_ = Work::none;
  }
  return true;
}

// The registers move all or none.
void RadixSortUnit::advance() {
  advanced_ = placed_.count == 0 || blocks_take(placed_);
  if (!advanced_) return;
  for (std::uint32_t i = 0; i < placed_.count; ++i) place(placed_.items[i]);
  placed_ = ranked_;
  ranked_.count = 0;
}

// For as many as may be full in one cycle, after as many that wait.
bool RadixSortUnit::room_for_blocks() const {
  const std::size_t n = config_.radix_sort.pairs_per_cycle;
  return blocks_.ready(round_.last ? 2 * n : 3 * n);
}

// A digit has two blocks: one may be filled while the other waits. Where a cycle's pairs fill more
// than that by themselves, none may wait.
bool RadixSortUnit::blocks_take(const Group& group) const {
  if (!room_for_blocks()) return false;
  const std::uint32_t size = round_.last ? 4 : pair_size_;
  const std::uint32_t block = config_.radix_sort.combine_bytes;
  for (std::uint32_t i = 0; i < group.count; ++i) {
    const std::uint32_t d = group.items[i].digit;
    std::uint64_t at = writers_[d].next().value & (block - 1);
    for (std::uint32_t j = 0; j < i; ++j) at += group.items[j].digit == d ? size : 0;
    if (waiting_[d] > 0 && waiting_[d] + at / block >= 2) return false;
  }
  return true;
}

// To its place, through the block that gathers its digit's pairs.
void RadixSortUnit::place(const Item& item) {
  ++next_counts_[digit(item.code, round_.number + 1)];
  if (!round_.last) {
    std::uint8_t bytes[8];
    pack_pair(config_, item.code, item.id, bytes);
    put(item.digit, writers_[item.digit], bytes, pair_size_);
  } else {
    put(item.digit, writers_[item.digit], &item.code, 4);
    put(item.digit, id_writers_[item.digit], &item.id, 4);
  }
}

void RadixSortUnit::put(std::uint32_t digit, BlockWriter& writer, const void* bytes,
                        std::uint32_t size) {
  if (writer.requests_for(size) > 0) {
    block_digits_.push_back(digit);
    waiting_[digit] += !round_.last || &writer == &id_writers_[digit];
  }
  writer.put(bytes, size);
}

// A block a cycle, through a register.
void RadixSortUnit::hand_on() {
  if (out_full_ && port_.requests.ready()) {
    port_.requests.push(out_);
    out_full_ = false;
  }
  if (out_full_ || !blocks_.valid()) return;
  out_ = blocks_.pop();
  out_full_ = true;
  waiting_[block_digits_.front()] -= out_.purpose != Purpose::sorted_codes;
  block_digits_.pop_front();
}

// What a digit's blocks still hold.
void RadixSortUnit::flush(std::uint32_t digit) {
  if (writers_[digit].holds()) {
    writers_[digit].flush();
    block_digits_.push_back(digit);
    waiting_[digit] += !round_.last;
  }
  if (round_.last && id_writers_[digit].holds()) {
    id_writers_[digit].flush();
    block_digits_.push_back(digit);
    ++waiting_[digit];
  }
}

std::string RadixSortUnit::waits_for() const {
  if (state_ == State::done) return {};
  const std::string where = ", round " + std::to_string(round_.number + 1);
  if (waits_ == kPrefixSum) return "prefix_sum to give a section's sums" + where;
  if (waits_ == kBusWrite) return "the bus to take a block" + where;
  return std::to_string(reader_.left()) + " bytes of pairs from the bus" + where;
}

}  // namespace fasttree::model
