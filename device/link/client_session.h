// SPDX-License-Identifier: Apache-2.0
// The PC's side of a session: asks for it, sends the scene, waits, takes the result, says goodbye.
// It is told what time it is and which datagrams came, and says which go out; it knows no sockets,
// clocks or threads. States and timers: docs/protocol.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "device/link/admission.h"
#include "device/link/byte_source.h"
#include "device/link/messages.h"
#include "device/link/outbox.h"
#include "device/link/receiver.h"
#include "device/link/sender.h"
#include "device/link/stream_memory.h"
#include "fasttree/status.h"

namespace fasttree::device {

struct ClientSettings {
  std::uint32_t payload = kEthernetPayload;  ///< most bytes of a data frame's body
  std::uint32_t window = kMostWindow;        ///< frames that may be under way to this side
  std::uint32_t timeout_ms = 5000;           ///< of silence
  std::uint32_t patience_ms = 0;             ///< how long to ask again where the device is busy
  std::uint64_t most_result_bytes = ~std::uint64_t{0};
};

class ClientSession {
 public:
  /// `session` is a random number, another one every time. `scene` has to outlive the session.
  ClientSession(const ClientSettings& settings, std::uint64_t session, const Order& order,
                const ByteSource& scene, const Peer& server, Micros now);

  void on_datagram(std::span<const std::byte> datagram, const Peer& from, Micros now);
  /// The system says that nothing listens there. Anybody could have told it so: it ends a session
  /// only that has heard nothing yet, and not the first time.
  void on_unreachable();

  /// Writes the frames that are due. True where more are than the outbox had room for.
  bool poll(Micros now, Outbox& out);
  /// When to poll at the latest.
  Micros next_event() const;

  void cancel(Micros now);

  bool ended() const { return state_ == State::ended; }
  /// Of an ended session. Messages do not say who the device is.
  const Status& status() const { return status_; }
  /// The result stream, after status() is ok.
  const StreamMemory& result() const { return result_; }
  BuildProgress progress() const;
  const LinkCounts& counts() const { return counts_; }

 private:
  enum class State { greeting, sending, building, receiving, closing, ended };

  void on_accept(const Frame& frame, Micros now);
  void on_refuse(const Frame& frame, Micros now);
  void on_progress(const Frame& frame, Micros now);
  void on_offer(const Frame& frame, Micros now);
  void on_data(const Frame& frame, Micros now);
  void on_reset();
  void scene_is_there();
  void close(Closing reason, Status status, Micros now);
  void end(Status status);
  void check_silence(Micros now);
  Micros silence() const { return Micros{timeout_ms_} * 1000; }
  void write(FrameType type, std::uint32_t sequence, std::size_t bytes, Outbox& out,
             Micros now = 0);

  ClientSettings settings_;
  std::uint64_t session_;
  Order order_;
  const ByteSource& scene_;
  Peer server_;
  State state_ = State::greeting;
  Status status_;
  LinkCounts counts_;
  std::uint32_t timeout_ms_;
  Micros heard_;  ///< when the device was heard last
  Micros patient_until_;
  bool heard_any_ = false;
  std::uint32_t unreachable_ = 0;
  Accept accept_;
  Repeat repeat_;  ///< hello, or close
  std::optional<Sender> sender_;
  std::optional<Receiver> receiver_;
  StreamMemory result_;
  BuildProgress progress_;
  std::uint32_t progress_sequence_ = 0;
  bool owes_alive_ = false;
  Closing closing_ = Closing::done;
};

}  // namespace fasttree::device
