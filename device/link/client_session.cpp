// SPDX-License-Identifier: Apache-2.0
#include "device/link/client_session.h"

#include <algorithm>
#include <utility>

#include "device/link/result.h"

namespace fasttree::device {
namespace {

constexpr Micros kHelloWait = 50'000, kMostHelloWait = 500'000;
constexpr Micros kBusyWait = 20'000;
constexpr Micros kCloseWait = 20'000, kMostCloseWait = 200'000;
constexpr std::uint32_t kCloses = 6;        // then it is over without an answer
constexpr std::uint32_t kUnreachables = 3;  // then nobody is taken to be there

Status network_failure(std::string what) {
  return {StatusCode::io_error, std::move(what)};
}

std::string seconds(std::uint32_t ms) {
  std::string text = std::to_string(ms / 1000);
  if (ms % 1000 != 0) text += "." + std::to_string(ms % 1000 / 100);
  return text + " s";
}

}  // namespace

ClientSession::ClientSession(const ClientSettings& settings, std::uint64_t session,
                             const Order& order, const ByteSource& scene, const Peer& server,
                             Micros now)
    : settings_(settings),
      session_(session),
      order_(order),
      scene_(scene),
      server_(server),
      timeout_ms_(std::clamp(settings.timeout_ms, kLeastTimeoutMs, kMostTimeoutMs)),
      heard_(now),
      patient_until_(now + Micros{settings.patience_ms} * 1000) {
  settings_.payload = std::clamp(settings.payload, kLeastPayload, kLargestPayload) /
                      kTriangleBytes * kTriangleBytes;
  settings_.window = std::clamp(settings.window, kLeastWindow, kMostWindow);
  repeat_.start(now, kHelloWait, kMostHelloWait);
}

void ClientSession::on_datagram(std::span<const std::byte> datagram, const Peer& from, Micros now) {
  Frame frame;
  if (!admit(datagram, frame, counts_)) return;
  if (frame.header.session != session_ || from != server_) {
    ++counts_.wrong_session;
    return;
  }
  if (state_ == State::ended) return;
  heard_ = now;
  heard_any_ = true;
  switch (frame.header.type) {
    case FrameType::accept:
      return on_accept(frame, now);
    case FrameType::refuse:
      return on_refuse(frame, now);
    case FrameType::ack:
      if (state_ != State::sending) return;
      if (!sender_->on_ack(frame, now)) ++counts_.bad_content;
      if (sender_->complete()) scene_is_there();
      return;
    case FrameType::progress:
      return on_progress(frame, now);
    case FrameType::offer:
      return on_offer(frame, now);
    case FrameType::data:
      return on_data(frame, now);
    case FrameType::fault: {
      const auto fault = read_fault(frame.body);
      if (!fault) {
        ++counts_.bad_content;
      } else if (state_ == State::closing) {
        repeat_.hurry(now);
      } else {
        close(Closing::done, *fault, now);
      }
      return;
    }
    case FrameType::reset:
      return on_reset();
    default:
      ++counts_.bad_type;
  }
}

void ClientSession::on_accept(const Frame& frame, Micros now) {
  if (state_ != State::greeting) return;
  const auto accept = read_accept(frame.body);
  if (!accept || accept->payload > settings_.payload) {
    ++counts_.bad_content;
    return;
  }
  accept_ = *accept;
  timeout_ms_ = std::min(timeout_ms_, accept_.timeout_ms);
  repeat_.stop();
  state_ = State::sending;
  sender_.emplace(scene_, accept_.payload, accept_.window, silence());
  sender_->know_round_trip(static_cast<std::uint32_t>(now) - frame.header.timestamp);
  if (sender_->complete()) scene_is_there();
}

void ClientSession::on_refuse(const Frame& frame, Micros now) {
  if (state_ != State::greeting) return;
  const auto refuse = read_refuse(frame.body);
  if (!refuse) {
    ++counts_.bad_content;
    return;
  }
  switch (refuse->reason) {
    case Refusal::busy:
      if (now < patient_until_) {
        repeat_.start(now + kBusyWait, kHelloWait, kMostHelloWait);
        return;
      }
      return end(network_failure(
          "the device is busy with another session; try again later, or wait (--device-wait)"));
    case Refusal::scene_too_large:
      return end({StatusCode::resource_limit,
                  "the scene has " + std::to_string(scene_.size()) +
                      " bytes, and the device takes " + std::to_string(refuse->limit) +
                      "; take a smaller scene, or a device with more memory (fasttree serve "
                      "--memory-limit)"});
    case Refusal::not_possible:
      return end(network_failure(
          "the device does not know what was asked for; is its version another one?"));
  }
}

void ClientSession::scene_is_there() {
  sender_.reset();
  state_ = State::building;
}

void ClientSession::on_progress(const Frame& frame, Micros) {
  if (state_ != State::sending && state_ != State::building) return;
  auto progress = read_progress(frame.body);
  if (!progress) {
    ++counts_.bad_content;
    return;
  }
  // It builds, so it has the scene, whatever became of its last ack.
  if (state_ == State::sending) scene_is_there();
  owes_alive_ = true;
  if (frame.header.sequence < progress_sequence_) return;
  progress_sequence_ = frame.header.sequence;
  progress_ = std::move(*progress);
}

void ClientSession::on_offer(const Frame& frame, Micros now) {
  const auto bytes = read_offer(frame.body);
  if (!bytes) {
    ++counts_.bad_content;
    return;
  }
  if (state_ == State::receiving) receiver_->owe_ack();
  if (state_ == State::closing) repeat_.hurry(now);
  if (state_ != State::sending && state_ != State::building) return;
  scene_is_there();
  if (*bytes < kResultHeaderBytes || frame_count(*bytes, accept_.payload) > kMostFrames) {
    return close(
        Closing::broken,
        network_failure("the device offers a result of " + std::to_string(*bytes) + " bytes"), now);
  }
  StreamMemory memory;
  if (*bytes <= settings_.most_result_bytes) memory = StreamMemory::allocate(*bytes);
  if (!memory) {
    return close(
        Closing::result_too_large,
        {StatusCode::resource_limit, "the device's result has " + std::to_string(*bytes) +
                                         " bytes, more than there is room for; give a "
                                         "larger --memory-limit or fewer levels (--depth)"},
        now);
  }
  result_ = std::move(memory);
  receiver_.emplace(result_.bytes(), accept_.payload, settings_.window);
  receiver_->owe_ack(frame.header.timestamp);
  state_ = State::receiving;
}

void ClientSession::on_data(const Frame& frame, Micros now) {
  if (state_ == State::closing) {
    // It does not know yet that all has come.
    repeat_.hurry(now);
    return;
  }
  if (state_ != State::receiving) {
    ++counts_.out_of_window;
    return;
  }
  receiver_->on_data(frame, counts_);
  if (receiver_->complete()) close(Closing::done, Status(), now);
}

void ClientSession::on_reset() {
  switch (state_) {
    case State::closing:
      return end(status_);
    case State::ended:
      return;
    default:
      return end(network_failure(
          "the device has ended the session: it was started anew, or did not hear from here for "
          "too long; try again"));
  }
}

void ClientSession::on_unreachable() {
  if (state_ != State::greeting || heard_any_) return;
  if (++unreachable_ < kUnreachables) return;
  end(network_failure("nothing listens there; is fasttree serve running, and at this port?"));
}

void ClientSession::cancel(Micros now) {
  if (state_ == State::closing || state_ == State::ended) return;
  close(Closing::cancelled, {StatusCode::cancelled, "cancelled"}, now);
}

void ClientSession::close(Closing reason, Status status, Micros now) {
  closing_ = reason;
  status_ = std::move(status);
  state_ = State::closing;
  sender_.reset();
  repeat_.start(now, kCloseWait, kMostCloseWait);
}

void ClientSession::end(Status status) {
  status_ = std::move(status);
  state_ = State::ended;
  repeat_.stop();
  sender_.reset();
  if (!status_.ok()) result_ = StreamMemory();
}

void ClientSession::check_silence(Micros now) {
  if (state_ == State::closing || state_ == State::ended) return;
  if (sender_ && sender_->failed()) {
    return end(network_failure("a frame was sent " + std::to_string(kMostTries) +
                               " times without an answer; do frames of " +
                               std::to_string(accept_.payload + kFrameOverhead) +
                               " bytes get through this network?"));
  }
  if (now - heard_ < silence()) return;
  if (!heard_any_) {
    return end(network_failure("no answer in " + seconds(timeout_ms_) +
                               "; is fasttree serve running there, and does UDP get through?"));
  }
  end(network_failure("nothing was heard from the device for " + seconds(timeout_ms_) +
                      "; is it still running, and the network up?"));
}

void ClientSession::write(FrameType type, std::uint32_t sequence, std::size_t bytes, Outbox& out,
                          Micros now) {
  FrameHeader header;
  header.type = type;
  header.session = session_;
  header.sequence = sequence;
  header.timestamp = static_cast<std::uint32_t>(now);
  out.commit(header, bytes, server_);
}

bool ClientSession::poll(Micros now, Outbox& out) {
  const std::size_t before = out.entries().size();
  check_silence(now);
  if (!out.has_room(std::max(kHelloBytes, kMostAckBytes))) return state_ != State::ended;
  bool more = false;
  if (state_ == State::greeting && repeat_.due(now)) {
    Hello hello;
    hello.scene_bytes = scene_.size();
    hello.most_result_bytes = settings_.most_result_bytes;
    hello.payload = settings_.payload;
    hello.window = settings_.window;
    hello.timeout_ms = timeout_ms_;
    hello.order = order_;
    write_hello(hello, out.body(kHelloBytes));
    write(FrameType::hello, 0, kHelloBytes, out, now);
    repeat_.done(now);
  }
  if (state_ == State::sending) more = sender_->poll(session_, server_, now, out, counts_);
  if (owes_alive_ && state_ == State::building) {
    write(FrameType::alive, progress_sequence_, 0, out);
    owes_alive_ = false;
  }
  if (state_ == State::receiving && receiver_->owes_ack()) {
    receiver_->write_ack(session_, server_, out);
  }
  if (state_ == State::closing && repeat_.due(now)) {
    if (repeat_.times() >= kCloses) {
      end(status_);
    } else {
      write_close(closing_, out.body(kCloseBytes));
      write(FrameType::close, 0, kCloseBytes, out);
      repeat_.done(now);
    }
  }
  counts_.frames_sent += out.entries().size() - before;
  return more;
}

Micros ClientSession::next_event() const {
  if (state_ == State::ended) return 0;
  Micros next = std::min(heard_ + silence(), repeat_.next());
  if (state_ == State::sending) next = std::min(next, sender_->next_event());
  if (owes_alive_ || (state_ == State::receiving && receiver_->owes_ack())) return 0;
  return state_ == State::closing ? repeat_.next() : next;
}

BuildProgress ClientSession::progress() const {
  switch (state_) {
    case State::greeting:
      return {"greeting the device", 0};
    case State::sending:
      return {"sending the scene", sender_ ? sender_->fraction() : 1.0};
    case State::building:
      return progress_;
    case State::receiving: {
      const auto all = static_cast<double>(result_.bytes().size());
      return {"receiving the tree", static_cast<double>(receiver_->bytes_received()) / all};
    }
    case State::closing:
    case State::ended:
      return {"done", 1};
  }
  return {};
}

}  // namespace fasttree::device
