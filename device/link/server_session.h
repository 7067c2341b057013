// SPDX-License-Identifier: Apache-2.0
// The board's side: one session at a time, and a short answer to everybody else. Like the client's
// it is told the time and what came. Whoever drives it runs the engine: takes the scene, says how
// far the build is, and brings the outcome. States and timers: docs/protocol.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "device/link/admission.h"
#include "device/link/messages.h"
#include "device/link/outbox.h"
#include "device/link/receiver.h"
#include "device/link/result.h"
#include "device/link/sender.h"
#include "device/link/stream_memory.h"
#include "fasttree/mesh.h"
#include "fasttree/status.h"

namespace fasttree::device {

struct ServerSettings {
  Description description;  ///< most_scene_bytes is the limit that is kept to
  std::uint32_t payload = kLargestPayload;
  std::uint32_t window = kMostWindow;
  /// Bytes that may be under way to this side: what the system keeps for a socket that is not read.
  std::uint64_t window_bytes = ~std::uint64_t{0};
  std::uint32_t timeout_ms = 5000;  ///< of silence; the client may ask for less
};

/// A whole scene and what to do with it.
struct SceneOrder {
  StreamMemory scene;
  Order order;
  MeshView view() const;
};

/// How a session ended.
struct SessionEnd {
  Peer peer;
  std::uint64_t scene_bytes = 0;
  std::uint64_t result_bytes = 0;  ///< 0 where there was none
  Status status;                   ///< ok: the client has the whole result
};

class ServerSession {
 public:
  explicit ServerSession(const ServerSettings& settings);

  void on_datagram(std::span<const std::byte> datagram, const Peer& from, Micros now);
  /// Writes the frames that are due. True where more are than the outbox had room for.
  bool poll(Micros now, Outbox& out);
  Micros next_event() const;

  // The engine. take_scene() starts it, so to say: from then on until engine_ended() no other
  // session begins, whatever happens to this one.
  std::optional<SceneOrder> take_scene();
  /// The session is over and its engine still runs.
  bool engine_unwanted() const { return engine_runs_ && state_ == State::idle; }
  void engine_progress(BuildProgress progress) { progress_ = std::move(progress); }
  void engine_ended(Result<Outcome> outcome, Micros now);

  /// Says goodbye to the client, once: this side wants to stop.
  void stop(Micros now);

  bool in_session() const { return state_ != State::idle; }
  bool busy() const { return in_session() || engine_runs_; }
  /// How sessions ended since the last call.
  std::vector<SessionEnd> take_ends();
  const LinkCounts& counts() const { return counts_; }
  std::uint64_t most_scene_bytes() const;

 private:
  enum class State { idle, receiving, building, offering, sending, faulting };

  struct Reply {
    FrameType type = FrameType::reset;
    std::uint64_t session = 0;
    Peer peer;
    Refuse refuse;
  };

  void on_hello(const Frame& frame, const Peer& from, Micros now);
  void begin(const Hello& hello, std::uint64_t session, const Peer& from, Micros now);
  void on_frame_of_session(const Frame& frame, Micros now);
  void on_ack(const Frame& frame, Micros now);
  void on_close(const Frame& frame);
  void scene_is_there(Micros now);
  void fault(Status status, Micros now);
  void end(Status status);
  void check_silence(Micros now);
  void reply(const Reply& reply);
  bool write_replies(Outbox& out);
  void write(FrameType type, std::uint32_t sequence, std::size_t bytes, Outbox& out,
             std::uint32_t timestamp = 0);
  bool was_here(std::uint64_t session) const;
  Micros silence() const;

  ServerSettings settings_;
  State state_ = State::idle;
  LinkCounts counts_;
  std::vector<Reply> replies_;
  std::vector<SessionEnd> ends_;
  std::array<std::uint64_t, 64> past_{};  ///< the last sessions, a ring
  std::uint64_t sessions_ = 0;

  // Of the engine.
  bool engine_runs_ = false;
  bool scene_waits_ = false;

  // Of the session.
  std::uint64_t session_ = 0;
  Peer peer_;
  Hello hello_;
  Accept accept_;
  Micros heard_ = 0;
  bool heard_more_ = false;  ///< than its hello
  bool owes_accept_ = false;
  std::uint32_t hello_timestamp_ = 0;
  StreamMemory scene_;
  std::optional<Receiver> receiver_;
  BuildProgress progress_;
  std::uint32_t progress_sequence_ = 0;
  Repeat repeat_;  ///< progress, offer, fault
  std::optional<ResultSource> result_;
  std::optional<Sender> sender_;
  Status fault_;
};

}  // namespace fasttree::device
