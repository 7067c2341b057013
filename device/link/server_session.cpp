// SPDX-License-Identifier: Apache-2.0
#include "device/link/server_session.h"

#include <algorithm>
#include <utility>

namespace fasttree::device {
namespace {

// A session that has said nothing but hello ends after this: the hello may be an old one.
constexpr Micros kHalfOpen = 1'000'000;
constexpr Micros kMostProgressWait = 250'000;
constexpr Micros kAnswerWait = 20'000, kMostAnswerWait = 250'000;  // offer, fault
constexpr std::size_t kMostReplies = 64;                           // that wait to go out to others

}  // namespace

MeshView SceneOrder::view() const {
  const auto triangles = static_cast<std::uint32_t>(scene.bytes().size() / kTriangleBytes);
  MeshView mesh;
  mesh.positions = scene.bytes().data();
  mesh.vertex_count = 3 * triangles;
  mesh.triangle_count = triangles;
  return mesh;
}

ServerSession::ServerSession(const ServerSettings& settings) : settings_(settings) {
  settings_.payload = std::clamp(settings.payload, kLeastPayload, kLargestPayload) /
                      kTriangleBytes * kTriangleBytes;
  settings_.window = std::clamp(settings.window, kLeastWindow, kMostWindow);
  settings_.timeout_ms = std::clamp(settings.timeout_ms, kLeastTimeoutMs, kMostTimeoutMs);
}

Micros ServerSession::silence() const {
  return Micros{accept_.timeout_ms} * 1000;
}

bool ServerSession::was_here(std::uint64_t session) const {
  const auto known = std::min<std::uint64_t>(sessions_, past_.size());
  return std::find(past_.begin(), past_.begin() + static_cast<std::ptrdiff_t>(known), session) !=
         past_.begin() + static_cast<std::ptrdiff_t>(known);
}

void ServerSession::reply(const Reply& reply) {
  if (replies_.size() < kMostReplies) replies_.push_back(reply);
}

void ServerSession::on_datagram(std::span<const std::byte> datagram, const Peer& from, Micros now) {
  Frame frame;
  if (!admit(datagram, frame, counts_)) return;
  const std::uint64_t session = frame.header.session;
  switch (frame.header.type) {
    case FrameType::describe:
      // Never more bytes to a stranger than came from there.
      if (frame.body.size() != kDescriptionBytes) {
        ++counts_.bad_length;
        return;
      }
      return reply({FrameType::description, session, from, {}});
    case FrameType::hello:
      return on_hello(frame, from, now);
    case FrameType::data:
    case FrameType::ack:
    case FrameType::alive:
    case FrameType::close:
      if (state_ != State::idle && session == session_ && from == peer_) {
        return on_frame_of_session(frame, now);
      }
      // Saying goodbye twice is in order: the answer may have been lost.
      if (frame.header.type != FrameType::close || !was_here(session)) ++counts_.wrong_session;
      // Whoever holds the current session's number from another address gets no answer.
      if (state_ == State::idle || session != session_) {
        reply({FrameType::reset, session, from, {}});
      }
      return;
    default:
      ++counts_.bad_type;
  }
}

void ServerSession::on_hello(const Frame& frame, const Peer& from, Micros now) {
  const std::uint64_t session = frame.header.session;
  if (state_ != State::idle && session == session_) {
    if (from != peer_) {
      ++counts_.wrong_session;
    } else if (state_ == State::receiving || !heard_more_) {
      // The accept got lost. (A scene without triangles is complete before it is accepted.)
      owes_accept_ = true;
      hello_timestamp_ = frame.header.timestamp;
      heard_ = now;
    }
    return;
  }
  if (was_here(session)) {
    ++counts_.wrong_session;
    return reply({FrameType::reset, session, from, {}});
  }
  const auto hello = read_hello(frame.body);
  if (!hello) {
    ++counts_.bad_content;
    // A sound frame of the right size: a client of another kind, which should be told.
    if (frame.body.size() >= kRefuseBytes) {
      reply({FrameType::refuse, session, from, {Refusal::not_possible, 0}});
    }
    return;
  }
  if (busy()) return reply({FrameType::refuse, session, from, {Refusal::busy, 0}});
  if (hello->scene_bytes > most_scene_bytes()) {
    return reply(
        {FrameType::refuse, session, from, {Refusal::scene_too_large, most_scene_bytes()}});
  }
  hello_timestamp_ = frame.header.timestamp;
  begin(*hello, session, from, now);
}

std::uint64_t ServerSession::most_scene_bytes() const {
  return std::min(settings_.description.most_scene_bytes,
                  std::uint64_t{kTriangleBytes} * kMaxTriangles);
}

void ServerSession::begin(const Hello& hello, std::uint64_t session, const Peer& from, Micros now) {
  StreamMemory scene = StreamMemory::allocate(hello.scene_bytes);
  if (!scene) return reply({FrameType::refuse, session, from, {Refusal::scene_too_large, 0}});
  session_ = session;
  peer_ = from;
  hello_ = hello;
  accept_.payload = std::min(hello.payload, settings_.payload);
  const std::uint64_t fit = settings_.window_bytes / accept_.payload;
  accept_.window =
      static_cast<std::uint32_t>(std::clamp<std::uint64_t>(fit, kLeastWindow, settings_.window));
  accept_.timeout_ms = std::min(hello.timeout_ms, settings_.timeout_ms);
  heard_ = now;
  heard_more_ = false;
  owes_accept_ = true;
  scene_ = std::move(scene);
  receiver_.emplace(scene_.bytes(), accept_.payload, accept_.window);
  progress_ = {"starting", 0};
  progress_sequence_ = 0;
  state_ = State::receiving;
  if (receiver_->complete()) scene_is_there(now);
}

void ServerSession::scene_is_there(Micros now) {
  state_ = State::building;
  scene_waits_ = true;
  repeat_.start(now, std::min(silence() / 16, kMostProgressWait),
                std::min(silence() / 16, kMostProgressWait));
}

std::optional<SceneOrder> ServerSession::take_scene() {
  if (!scene_waits_) return std::nullopt;
  scene_waits_ = false;
  engine_runs_ = true;
  return SceneOrder{std::move(scene_), hello_.order};
}

void ServerSession::on_frame_of_session(const Frame& frame, Micros now) {
  heard_ = now;
  heard_more_ = true;
  switch (frame.header.type) {
    case FrameType::data:
      if (state_ == State::receiving) {
        receiver_->on_data(frame, counts_);
        if (receiver_->complete()) scene_is_there(now);
      } else {
        ++counts_.duplicates;
        if (receiver_) receiver_->owe_ack();
      }
      return;
    case FrameType::ack:
      return on_ack(frame, now);
    case FrameType::close:
      return on_close(frame);
    default:
      return;  // alive: it was heard, which is all it says
  }
}

void ServerSession::on_ack(const Frame& frame, Micros now) {
  if (state_ != State::offering && state_ != State::sending) return;
  if (!sender_->on_ack(frame, now)) {
    ++counts_.bad_content;
    return;
  }
  if (state_ == State::offering) {
    sender_->know_round_trip(static_cast<std::uint32_t>(now) - frame.header.timestamp);
  }
  state_ = State::sending;
  repeat_.stop();
  if (sender_->complete()) end(Status());
}

void ServerSession::on_close(const Frame& frame) {
  const auto reason = read_close(frame.body);
  if (!reason) {
    ++counts_.bad_content;
    return;
  }
  reply({FrameType::reset, session_, peer_, {}});
  if (state_ == State::faulting) return end(fault_);
  switch (*reason) {
    case Closing::done:
      // It has what it wanted, which this side may not know yet.
      return end(state_ == State::sending
                     ? Status()
                     : Status(StatusCode::io_error, "the client went before it had the result"));
    case Closing::cancelled:
      return end({StatusCode::cancelled, "the client cancelled"});
    case Closing::result_too_large:
      return end({StatusCode::resource_limit, "the client has no room for the result"});
    case Closing::broken:
      return end({StatusCode::io_error, "the client did not understand"});
  }
}

void ServerSession::engine_ended(Result<Outcome> outcome, Micros now) {
  engine_runs_ = false;
  if (state_ != State::building) return;
  receiver_.reset();
  if (!outcome.ok()) return fault(outcome.status(), now);
  result_.emplace(std::move(outcome).value());
  const std::uint64_t bytes = result_->size();
  if (bytes > hello_.most_result_bytes || frame_count(bytes, accept_.payload) > kMostFrames) {
    return fault({StatusCode::resource_limit,
                  "the tree has " + std::to_string(bytes) +
                      " bytes, more than the client takes; give a larger --memory-limit or fewer "
                      "levels (--depth)"},
                 now);
  }
  sender_.emplace(*result_, accept_.payload, 0, silence());
  state_ = State::offering;
  repeat_.start(now, kAnswerWait, std::min(kMostAnswerWait, silence() / 4));
}

void ServerSession::fault(Status status, Micros now) {
  sender_.reset();
  result_.reset();
  fault_ = std::move(status);
  state_ = State::faulting;
  repeat_.start(now, kAnswerWait, std::min(kMostAnswerWait, silence() / 4));
}

void ServerSession::stop(Micros now) {
  if (state_ == State::idle || state_ == State::faulting) return;
  fault({StatusCode::io_error, "the device was stopped"}, now);
}

void ServerSession::end(Status status) {
  past_[sessions_++ % past_.size()] = session_;
  ends_.push_back({peer_, hello_.scene_bytes,
                   status.ok() && result_ ? result_->size() : std::uint64_t{0}, std::move(status)});
  state_ = State::idle;
  scene_waits_ = false;
  scene_ = StreamMemory();
  receiver_.reset();
  sender_.reset();
  result_.reset();
  fault_ = Status();
  owes_accept_ = false;
  repeat_.stop();
}

std::vector<SessionEnd> ServerSession::take_ends() {
  return std::exchange(ends_, {});
}

void ServerSession::check_silence(Micros now) {
  if (state_ == State::idle) return;
  if (sender_ && sender_->failed()) {
    return end({StatusCode::io_error, "a frame of the result was sent " +
                                          std::to_string(kMostTries) + " times without an answer"});
  }
  const Micros limit = heard_more_ ? silence() : std::min(silence(), kHalfOpen);
  if (now - heard_ < limit) return;
  if (state_ == State::faulting) return end(fault_);
  end({StatusCode::io_error,
       "nothing was heard from the client for " + std::to_string(limit / 1000) + " ms"});
}

void ServerSession::write(FrameType type, std::uint32_t sequence, std::size_t bytes, Outbox& out,
                          std::uint32_t timestamp) {
  FrameHeader header;
  header.type = type;
  header.session = session_;
  header.sequence = sequence;
  header.timestamp = timestamp;
  out.commit(header, bytes, peer_);
}

bool ServerSession::write_replies(Outbox& out) {
  std::size_t written = 0;
  for (const Reply& reply : replies_) {
    if (!out.has_room(kDescriptionBytes)) break;
    std::size_t bytes = 0;
    if (reply.type == FrameType::description) {
      bytes = kDescriptionBytes;
      Description description = settings_.description;
      description.busy = busy();
      write_description(description, out.body(bytes));
    } else if (reply.type == FrameType::refuse) {
      bytes = kRefuseBytes;
      write_refuse(reply.refuse, out.body(bytes));
    }
    FrameHeader header;
    header.type = reply.type;
    header.session = reply.session;
    out.commit(header, bytes, reply.peer);
    ++written;
  }
  replies_.erase(replies_.begin(), replies_.begin() + static_cast<std::ptrdiff_t>(written));
  return !replies_.empty();
}

bool ServerSession::poll(Micros now, Outbox& out) {
  const std::size_t before = out.entries().size();
  check_silence(now);
  bool more = write_replies(out);
  if (!out.has_room(kMostAckBytes + kMostMessageBytes)) return true;
  if (state_ != State::idle && owes_accept_) {
    write_accept(accept_, out.body(kAcceptBytes));
    write(FrameType::accept, 0, kAcceptBytes, out, hello_timestamp_);
    owes_accept_ = false;
  }
  if (receiver_ && receiver_->owes_ack()) receiver_->write_ack(session_, peer_, out);
  if (repeat_.due(now)) {
    if (state_ == State::building) {
      write_progress(progress_, out.body(kProgressBytes));
      write(FrameType::progress, ++progress_sequence_, kProgressBytes, out);
    } else if (state_ == State::offering) {
      write_offer(result_->size(), out.body(kOfferBytes));
      write(FrameType::offer, 0, kOfferBytes, out, static_cast<std::uint32_t>(now));
    } else if (state_ == State::faulting) {
      const std::size_t bytes = fault_bytes(fault_);
      write_fault(fault_, out.body(bytes));
      write(FrameType::fault, 0, bytes, out);
    }
    repeat_.done(now);
  }
  if (state_ == State::sending) {
    more = sender_->poll(session_, peer_, now, out, counts_) || more;
  }
  counts_.frames_sent += out.entries().size() - before;
  return more;
}

Micros ServerSession::next_event() const {
  if (!replies_.empty()) return 0;
  if (state_ == State::idle) return kNever;
  if (owes_accept_ || (receiver_ && receiver_->owes_ack())) return 0;
  const Micros limit = heard_more_ ? silence() : std::min(silence(), kHalfOpen);
  Micros next = std::min(heard_ + limit, repeat_.next());
  if (state_ == State::sending) next = std::min(next, sender_->next_event());
  return next;
}

}  // namespace fasttree::device
