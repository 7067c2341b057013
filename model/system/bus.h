// SPDX-License-Identifier: Apache-2.0
// The bus between the units' ports and off-chip memory: it arbitrates, cuts requests into the
// memory's bursts, and moves so many bytes a cycle.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "model/config/paper_config.h"
#include "model/kernel/queue.h"
#include "model/kernel/unit.h"
#include "model/memory/byte_store.h"
#include "model/memory/memory.h"
#include "model/report/simulation.h"
#include "model/system/byte_fifo.h"

namespace fasttree::model {

/// What bytes cross the bus for.
enum class Purpose : std::uint8_t {
  scene,         ///< triangles
  pairs,         ///< code and id, before and between the rounds of the sort
  sorted_codes,  ///< codes of the last round
  sorted_ids,    ///< ids of the last round: part of the tree
  leaf_codes,
  leaf_rows,
  clear,  ///< zeros over the marks
  marks,
  nodes,
  links,  ///< children written into nodes
};
inline constexpr std::size_t kPurposes = 10;
const char* to_string(Purpose purpose);

inline constexpr std::uint32_t kMaxRequestBytes = 64;

/// Read or write of at most kMaxRequestBytes, anywhere. A read's bytes come out of the port's data.
struct BusRequest {
  Address address;
  std::uint32_t bytes = 0;
  bool write = false;
  Purpose purpose = Purpose::scene;
  std::array<std::uint8_t, kMaxRequestBytes> data;  ///< of a write; not set for a read
};

/// Where one unit is connected. Its requests are carried out in order.
class BusPort {
 public:
  BusPort(std::string name, const PaperConfig::Bus& config);

  Queue<BusRequest> requests;
  ByteFifo data;

  const std::string& name() const { return name_; }
  void clock() {
    requests.clock();
    data.clock();
  }
  /// Nothing asked for is still to be done, and no byte waits to be taken.
  bool quiet() const;

 private:
  friend class Bus;
  struct Read {
    std::uint32_t bytes = 0;  ///< asked for by the unit
    std::uint32_t address_low = 0;
    std::uint32_t waiting = 0;  ///< bursts of memory still to come
    bool issued = false;        ///< all bursts have been asked for
    std::array<std::uint8_t, kMaxRequestBytes> data{};
  };

  std::string name_;
  std::uint32_t index_ = 0;  ///< of the bus's ports
  std::vector<Read> reads_;  ///< a ring
  std::uint32_t first_read_ = 0;
  std::uint32_t read_count_ = 0;
  std::uint32_t part_bytes_ = 0;  ///< of the read in front, asked for so far
  std::uint64_t writes_in_flight_ = 0;
};

class Bus : public Unit {
 public:
  Bus(const PaperConfig::Bus& config, double clock_mhz, Memory& memory, ByteStore& store);

  /// A new port, the bus's own.
  BusPort& add_port(const std::string& name);
  /// The ports that the step uses; the others stay as they are.
  void use_ports(const std::vector<BusPort*>& ports) {
    active_ = ports;
    next_data_port_ = next_read_port_ = 0;
  }

  void tick() override;
  bool done() const override;
  std::string waits_for() const override;
  void clock();

  /// Grows with every byte moved and every burst asked for or finished.
  std::uint64_t progress() const { return progress_; }
  std::uint64_t moved_bytes() const { return moved_bytes_; }

  /// Time in which nothing crosses the bus.
  void pass(std::uint64_t cycles) { cycle_ += cycles; }

  /// A unit went outside the memory; what it asked for there was not done.
  bool strayed() const { return strayed_; }

  /// Bytes by purpose since the last call.
  std::vector<Traffic> take_traffic();

  /// For tests: the n-th beat from now (1 is the next) is lost. A write's bytes do not arrive; a
  /// read's never come back.
  void drop_beat(std::uint64_t n) { drop_beat_ = n; }

 private:
  struct Transfer {
    BusPort* port = nullptr;
    bool write = false;
    std::uint32_t offset = 0;
  };

  void complete(const MemoryCompletion& completion);
  void hand_on();
  bool move_data(Transfer& transfer, bool reads, bool writes);
  bool choose(Transfer& transfer, bool reads, bool writes);
  bool move_read(Transfer& transfer);
  bool move_write(Transfer& transfer);
  void issue_reads();
  std::uint32_t part_size(const BusRequest& request, std::uint32_t from) const;
  std::uint32_t beat_size(std::uint64_t address, std::uint32_t left) const;
  std::size_t wrap(std::size_t port) const {
    return port < active_.size() ? port : port - active_.size();
  }
  void account(const BusRequest& request);
  bool inside(const BusRequest& request);
  bool lost_beat() { return drop_beat_ != 0 && --drop_beat_ == 0; }

  PaperConfig::Bus config_;
  double period_ps_;
  Memory& memory_;
  ByteStore& store_;
  std::uint32_t access_bytes_;
  std::vector<std::unique_ptr<BusPort>> ports_;
  std::vector<BusPort*> active_;
  bool strayed_ = false;
  std::uint64_t cycle_ = 0;
  Picoseconds now_;
  Transfer shared_, reading_, writing_;
  /// The write that has crossed and that memory has not taken whole: one, meanwhile no other begins
  /// to cross, but reads do.
  struct {
    BusPort* port = nullptr;
    Address address;
    std::uint32_t bytes = 0;
    std::uint32_t issued = 0;
  } to_memory_;
  bool last_was_read_ = false;
  std::size_t next_data_port_ = 0;
  std::size_t next_read_port_ = 0;
  std::uint64_t bursts_in_flight_ = 0;
  std::uint64_t progress_ = 0;
  std::uint64_t moved_bytes_ = 0;
  std::uint64_t drop_beat_ = 0;
  std::array<std::uint64_t, kPurposes> read_bytes_{};
  std::array<std::uint64_t, kPurposes> write_bytes_{};
};

}  // namespace fasttree::model
