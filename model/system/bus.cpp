// SPDX-License-Identifier: Apache-2.0
#include "model/system/bus.h"

#include <algorithm>

namespace fasttree::model {
namespace {

constexpr std::uint32_t kWriteTag = 1u << 31;
constexpr std::uint32_t kTagPortShift = 16;
enum Stall : std::size_t { kMemory };

}  // namespace

const char* to_string(Purpose purpose) {
  constexpr const char* kNames[kPurposes] = {
      "scene",     "pairs", "sorted codes", "sorted ids", "leaf codes",
      "leaf rows", "clear", "marks",        "nodes",      "links"};
  return kNames[static_cast<std::size_t>(purpose)];
}

BusPort::BusPort(std::string name, const PaperConfig::Bus& config)
    : requests(std::max<std::size_t>(config.request_queue, 4)),
      data(std::max(config.read_ahead_bytes, kMaxRequestBytes)),
      name_(std::move(name)),
      reads_(config.reads_in_flight) {}

bool BusPort::quiet() const {
  return requests.empty() && data.empty() && read_count_ == 0 && writes_in_flight_ == 0;
}

Bus::Bus(const PaperConfig::Bus& config, double clock_mhz, Memory& memory, ByteStore& store)
    : Unit("bus", "bus", {"memory"}),
      config_(config),
      period_ps_(1e6 / clock_mhz),
      memory_(memory),
      store_(store),
      access_bytes_(memory.traits().access_bytes) {}

BusPort& Bus::add_port(const std::string& name) {
  ports_.push_back(std::make_unique<BusPort>(name, config_));
  ports_.back()->index_ = static_cast<std::uint32_t>(ports_.size() - 1);
  active_.push_back(ports_.back().get());
  return *ports_.back();
}

void Bus::clock() {
  for (BusPort* port : active_) port->clock();
}

bool Bus::inside(const BusRequest& request) {
  const bool in = request.address.value <= store_.size() &&
                  request.bytes <= store_.size() - request.address.value;
  if (!in) strayed_ = true;
  return in;
}

void Bus::tick() {
  now_ = Picoseconds(static_cast<std::uint64_t>(static_cast<double>(++cycle_) * period_ps_));
  memory_.advance(now_);
  MemoryCompletion completion;
  while (memory_.take(completion)) complete(completion);

  hand_on();
  bool moved = false;
  if (config_.duplex) {
    moved = move_data(reading_, true, false);
    moved |= move_data(writing_, false, true);
  } else {
    moved = move_data(shared_, true, true);
  }
  issue_reads();
  if (moved) {
    busy();
  } else if (bursts_in_flight_ > 0 || to_memory_.port || shared_.port || writing_.port) {
    stalled(kMemory);
  } else {
    idle();
  }
}

void Bus::complete(const MemoryCompletion& completion) {
  ++progress_;
  --bursts_in_flight_;
  BusPort& port = *ports_[(completion.tag & ~kWriteTag) >> kTagPortShift];
  if (completion.write) {
    --port.writes_in_flight_;
  } else {
    --port.reads_[completion.tag & 0xffff].waiting;
  }
}

std::uint32_t Bus::part_size(const BusRequest& request, std::uint32_t from) const {
  const std::uint64_t at = request.address.value + from;
  return std::min(request.bytes - from,
                  access_bytes_ - static_cast<std::uint32_t>(at % access_bytes_));
}

std::uint32_t Bus::beat_size(std::uint64_t address, std::uint32_t left) const {
  return std::min(left,
                  config_.bytes - (static_cast<std::uint32_t>(address) & (config_.bytes - 1)));
}

void Bus::account(const BusRequest& request) {
  auto& bytes = request.write ? write_bytes_ : read_bytes_;
  bytes[static_cast<std::size_t>(request.purpose)] += request.bytes;
}

// Data that has come back and data that is to be written take turns; ports go round.
bool Bus::choose(Transfer& transfer, bool reads, bool writes) {
  BusPort* read = nullptr;
  BusPort* write = nullptr;
  std::size_t read_at = 0;
  std::size_t write_at = 0;
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const std::size_t at = wrap(next_data_port_ + i);
    BusPort& port = *active_[at];
    if (reads && !read && port.read_count_ > 0) {
      const BusPort::Read& oldest = port.reads_[port.first_read_];
      if (oldest.issued && oldest.waiting == 0) read = &port, read_at = at;
    }
    if (writes && !write && to_memory_.port == nullptr && port.requests.valid() &&
        port.requests.front().write) {
      write = &port, write_at = at;
    }
  }
  if (!read && !write) return false;
  const bool take_read = read && (!write || !last_was_read_);
  last_was_read_ = take_read;
  transfer = {take_read ? read : write, !take_read, 0};
  next_data_port_ = wrap((take_read ? read_at : write_at) + 1);
  return true;
}

bool Bus::move_data(Transfer& transfer, bool reads, bool writes) {
  if (!transfer.port && !choose(transfer, reads, writes)) return false;
  return transfer.write ? move_write(transfer) : move_read(transfer);
}

bool Bus::move_read(Transfer& transfer) {
  BusPort& port = *transfer.port;
  BusPort::Read& read = port.reads_[port.first_read_];
  const std::uint32_t size =
      beat_size(read.address_low + transfer.offset, read.bytes - transfer.offset);
  if (!port.data.ready(size)) return false;
  if (!lost_beat()) port.data.push(read.data.data() + transfer.offset, size);
  transfer.offset += size;
  moved_bytes_ += size;
  ++progress_;
  if (transfer.offset == read.bytes) {
    if (++port.first_read_ == port.reads_.size()) port.first_read_ = 0;
    --port.read_count_;
    transfer.port = nullptr;
  }
  return true;
}

bool Bus::move_write(Transfer& transfer) {
  BusPort& port = *transfer.port;
  const BusRequest& request = port.requests.front();
  bool moved = false;
  if (transfer.offset < request.bytes) {
    const std::uint32_t size =
        beat_size(request.address.value + transfer.offset, request.bytes - transfer.offset);
    if (!lost_beat() && inside(request)) {
      store_.write(Address(request.address.value + transfer.offset),
                   request.data.data() + transfer.offset, size);
    }
    transfer.offset += size;
    moved_bytes_ += size;
    ++progress_;
    moved = true;
  }
  if (transfer.offset < request.bytes) return moved;
  // All of it has crossed: to memory's side, which takes it as fast as it can.
  account(request);
  to_memory_ = {&port, request.address, request.bytes, 0};
  port.requests.pop();
  transfer.port = nullptr;
  hand_on();
  return moved;
}

void Bus::hand_on() {
  while (to_memory_.port != nullptr && to_memory_.issued < to_memory_.bytes) {
    const Address at(to_memory_.address.value + to_memory_.issued);
    if (!memory_.ready(at, true)) return;
    const auto left = to_memory_.bytes - to_memory_.issued;
    const std::uint32_t size =
        std::min(left, access_bytes_ - static_cast<std::uint32_t>(at.value % access_bytes_));
    const std::uint32_t tag = kWriteTag | to_memory_.port->index_ << kTagPortShift;
    memory_.accept({at, size, true, tag}, now_);
    ++to_memory_.port->writes_in_flight_;
    ++bursts_in_flight_;
    ++progress_;
    to_memory_.issued += size;
  }
  to_memory_ = {};
}

void Bus::issue_reads() {
  const std::size_t start = next_read_port_;
  std::uint32_t commands = config_.commands_per_cycle;
  for (std::size_t i = 0; i < active_.size() && commands > 0; ++i) {
    const std::size_t at = wrap(start + i);
    BusPort& port = *active_[at];
    if (!port.requests.valid() || port.requests.front().write) continue;
    if (to_memory_.port == &port) continue;  // a read does not overtake its port's write
    const BusRequest& request = port.requests.front();
    if (port.part_bytes_ == 0 && port.read_count_ == port.reads_.size()) continue;
    // A new read takes a place in the ring with its first burst.
    while (commands > 0 && port.part_bytes_ < request.bytes) {
      const Address address(request.address.value + port.part_bytes_);
      if (!memory_.ready(address, false)) break;
      if (port.part_bytes_ == 0) {
        const std::size_t place = (port.first_read_ + port.read_count_) % port.reads_.size();
        BusPort::Read& read = port.reads_[place];
        read.bytes = request.bytes;
        read.address_low = static_cast<std::uint32_t>(request.address.value % kMaxRequestBytes);
        read.waiting = 0;
        read.issued = false;
        ++port.read_count_;
      }
      const std::size_t place = (port.first_read_ + port.read_count_ - 1) % port.reads_.size();
      BusPort::Read& read = port.reads_[place];
      const std::uint32_t size = part_size(request, port.part_bytes_);
      if (inside(request)) store_.read(address, read.data.data() + port.part_bytes_, size);
      memory_.accept(
          {address, size, false, static_cast<std::uint32_t>(port.index_ << kTagPortShift | place)},
          now_);
      ++read.waiting;
      ++bursts_in_flight_;
      ++progress_;
      --commands;
      port.part_bytes_ += size;
      next_read_port_ = wrap(at + 1);
    }
    if (port.part_bytes_ == request.bytes) {
      port.reads_[(port.first_read_ + port.read_count_ - 1) % port.reads_.size()].issued = true;
      account(request);
      port.part_bytes_ = 0;
      port.requests.pop();
    }
  }
}

bool Bus::done() const {
  return bursts_in_flight_ == 0 && to_memory_.port == nullptr &&
         std::all_of(active_.begin(), active_.end(),
                     [](const auto* port) { return port->quiet(); });
}

std::string Bus::waits_for() const {
  if (bursts_in_flight_ == 0 && !to_memory_.port && !shared_.port && !writing_.port) return {};
  return "memory, which " +
         (memory_.idle() ? std::string("has nothing to do") : "waits for " + memory_.waits_for());
}

std::vector<Traffic> Bus::take_traffic() {
  std::vector<Traffic> traffic;
  for (std::size_t i = 0; i < kPurposes; ++i) {
    if (read_bytes_[i] == 0 && write_bytes_[i] == 0) continue;
    traffic.push_back({to_string(static_cast<Purpose>(i)), read_bytes_[i], write_bytes_[i]});
  }
  read_bytes_ = write_bytes_ = {};
  return traffic;
}

}  // namespace fasttree::model
