#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/steady_timer.hpp>
#include <deque>
#include <optional>
#include <utility>

#include "base/log.h"
#include "net/conversation.h"
#include "net/reading_rate.h"
#include "net/redirect_error_to.h"
#include "net/sessions.h"
#include "protocol/hello.h"

namespace surfcast::net {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

/// Of an answer that waits, with what the queue and the allocator take for it.
size_t memory_of(const Bytes& answer) {
  constexpr size_t kOverhead = 64;
  return answer.size() + kOverhead;
}

/// Most pictures are larger, all answers of the server itself are smaller. Not a setting: small_unread_bytes is.
bool is_small(const Bytes& answer) {
  constexpr size_t kSmall = size_t{64} << 10;
  return answer.size() <= kSmall;
}

/// A reader, one queue of answers with a writer, and a watchdog, all on the thread of the sockets. What is said is the
/// conversation's affair, how it travels the transport's.
class MessageSession : public Session, public AnswerWriter, public std::enable_shared_from_this<MessageSession> {
 public:
  MessageSession(std::shared_ptr<Transport> transport, Peer peer)
      : transport_(std::move(transport)),
        peer_(std::move(peer)),
        watchdog_(transport_->executor()),
        room_(transport_->executor(), Clock::time_point::max()) {}

  void start() {
    conversation_ = std::make_shared<Conversation>(peer_.context, peer_.client(), transport_->executor(),
                                                   shared_from_this(), peer_.open.client(), peer_.user);
    spawn([](auto self) -> asio::awaitable<void> { co_await self->read_all(); });
    spawn([](auto self) -> asio::awaitable<void> { co_await self->watch(); });
  }
  void drain() override {
    draining_ = true;
    conversation_->refuse_requests();
    answer_sent();
  }
  [[nodiscard]] bool lasts() const override { return conversation_->has_views() && !draining_; }
  void abort() override { close(); }
  [[nodiscard]] bool refused() const override { return !peer_.refusal.empty(); }
  [[nodiscard]] std::optional<Clock::time_point> idle_since() const override {
    const bool waits = greeted_ && outgoing_.empty() && !closing_ && !draining_ && !conversation_->has_views() &&
                       conversation_->outstanding() == 0 && transport_->is_open();
    return waits ? std::optional(last_request_) : std::nullopt;
  }
  [[nodiscard]] std::string client() const override { return peer_.open.client(); }
  void models_changed() override { conversation_->models_changed(); }
  void check_user() override { conversation_->check_user(); }

  void send(Bytes answer, std::shared_ptr<const void> memory) override;
  [[nodiscard]] size_t unread_bytes() const override { return outgoing_bytes_; }
  void answer_sent() override;
  void end(Bytes answer) override;

 private:
  /// Runs a coroutine that keeps the session alive.
  template <typename Coroutine>
  void spawn(Coroutine coroutine) {
    asio::co_spawn(transport_->executor(), coroutine(shared_from_this()), asio::detached);
  }

  asio::awaitable<void> read_all();
  asio::awaitable<bool> exchange_hellos();
  asio::awaitable<bool> read_one();
  asio::awaitable<void> write_all();
  asio::awaitable<void> leave();
  asio::awaitable<void> watch();

  void send_last(Bytes answer);
  void close();
  [[nodiscard]] const ServerConfig& config() const { return peer_.context->config; }
  void progress(size_t bytes);
  [[nodiscard]] Clock::time_point deadline();
  [[nodiscard]] bool is_late(Clock::time_point now) const;
  [[nodiscard]] bool has_room() const;

  std::shared_ptr<Transport> transport_;
  Peer peer_;
  std::shared_ptr<Conversation> conversation_;

  struct Outgoing {
    Bytes answer;
    std::shared_ptr<const void> memory;
  };
  std::deque<Outgoing> outgoing_;
  size_t outgoing_bytes_ = 0;
  size_t small_bytes_ = 0;  ///< of small answers among them
  bool closing_ = false;    ///< nothing more is said after what is in the queue
  bool ending_ = false;     ///< while the client may still be saying something
  bool draining_ = false;   ///< it ends as soon as everything is answered

  asio::steady_timer watchdog_;
  asio::steady_timer room_;  ///< cancelled when the reader should look again whether it may go on
  bool greeted_ = false;
  Clock::time_point greeted_at_;
  Clock::time_point last_request_ = Clock::now();
  Clock::time_point last_write_ = Clock::now();
  ReadingRate reading_{config().stall, config().least_rate, last_write_};  ///< while there are answers
};

asio::awaitable<void> MessageSession::read_all() {
  bool going_on = co_await exchange_hellos();
  while (going_on) {
    // GCC 12 makes wrong code of a co_await inside a condition: it stands by itself here and below.
    going_on = co_await read_one();
  }
  if (!closing_ || ending_) close();
}

asio::awaitable<bool> MessageSession::exchange_hellos() {
  const Result<Bytes> bytes = co_await transport_->read_hello();
  const Result<protocol::Hello> client = bytes ? protocol::decode_hello(*bytes) : fail(bytes);
  if (!client || closing_) co_return false;
  protocol::Hello answer = protocol::answer_hello(*client, "surfcastd");
  if (!peer_.refusal.empty() && answer.status == protocol::HelloStatus::kWelcome) {
    answer.status = protocol::HelloStatus::kBusy;
    answer.message = peer_.refusal;
  }
  const Bytes words = protocol::encode_hello(answer);
  greeted_ = co_await transport_->write_hello(words);
  last_request_ = last_write_ = greeted_at_ = Clock::now();
  if (closing_) co_return false;  // the server stops meanwhile, and leave() has the last word
  if (answer.status == protocol::HelloStatus::kWelcome) co_return greeted_;
  log_limited(peer_.context->refused_lines, spdlog::level::info,
              "connection " + std::to_string(peer_.id) + " refused: " + answer.message);
  closing_ = true;
  co_await transport_->linger();
  close();
  co_return false;
}

/// Whether the client has read enough of its answers to ask for more. Small answers come of requests that cost it next
/// to nothing, so that fewer bytes of them are kept.
bool MessageSession::has_room() const {
  return outgoing_bytes_ <= config().unread_bytes && small_bytes_ <= config().small_unread_bytes;
}

/// Waits until the client has read enough of its answers, then handles one request of it. False at the end.
asio::awaitable<bool> MessageSession::read_one() {
  error_code code;
  while (!has_room() && transport_->is_open()) {
    co_await room_.async_wait(redirect_error_to(code));
  }
  const Result<std::optional<Bytes>> message = co_await transport_->read();
  if (message && !message->has_value()) co_return false;
  last_request_ = Clock::now();
  const Status handled = message ? conversation_->receive(**message) : fail(message);
  if (handled) co_return true;
  log_limited(peer_.context->broken_lines, spdlog::level::info,
              "connection " + std::to_string(peer_.id) + ": " + handled.error().message);
  ++peer_.context->metrics.errors;
  conversation_->abandon();
  send_last(encode_error(0, handled.error()));
  co_return false;
}

void MessageSession::send(Bytes answer, std::shared_ptr<const void> memory) {
  if (!transport_->is_open() || closing_) return;
  outgoing_bytes_ += memory_of(answer);
  if (is_small(answer)) small_bytes_ += memory_of(answer);
  outgoing_.push_back({std::move(answer), std::move(memory)});
  if (outgoing_.size() > 1) return;  // the writer is at work
  last_write_ = Clock::now();
  reading_ = ReadingRate(config().stall, config().least_rate, last_write_);
  spawn([](auto self) -> asio::awaitable<void> { co_await self->write_all(); });
}

/// The client has taken some of its answers.
void MessageSession::progress(size_t bytes) {
  last_write_ = Clock::now();
  reading_.take(bytes);
}

/// Sends, then closes.
void MessageSession::send_last(Bytes answer) {
  send(std::move(answer), {});
  closing_ = true;
}

/// The reader goes on until the client has understood, or its time is over.
void MessageSession::end(Bytes answer) {
  ending_ = true;
  send_last(std::move(answer));
}

asio::awaitable<void> MessageSession::write_all() {
  bool written = true;
  while (written && !outgoing_.empty() && transport_->is_open()) {
    const Bytes& answer = outgoing_.front().answer;
    written = co_await transport_->write(answer, [this](size_t bytes) { progress(bytes); });
    if (!written) break;
    outgoing_bytes_ -= memory_of(answer);
    if (is_small(answer)) small_bytes_ -= memory_of(answer);
    outgoing_.pop_front();
    room_.cancel();
    conversation_->resume_sending();
  }
  if (!written) close();
  if (ending_ && transport_->is_open()) {
    co_await transport_->send_close();
  } else if (closing_ && transport_->is_open()) {
    co_await transport_->linger();
    close();
  }
  answer_sent();
}

/// When the session is to be closed if nothing happens until then.
Clock::time_point MessageSession::deadline() {
  if (!outgoing_.empty() && reading_.is_too_slow(Clock::now())) return Clock::time_point::min();
  if (!outgoing_.empty()) return last_write_ + config().stall;
  if (closing_) return last_write_ + std::min(config().hello, config().stall);
  if (!greeted_) return last_request_ + config().hello;
  if (!conversation_->admitted()) return greeted_at_ + config().hello;
  if (conversation_->outstanding() > 0) return Clock::now() + config().idle;
  return last_request_ + config().idle;
}

/// Whether a request that has begun to arrive is not whole in time. What the client does not read keeps its requests
/// waiting outside.
bool MessageSession::is_late(Clock::time_point now) const {
  const auto since = transport_->reading_since();
  return since && now >= *since + config().hello;
}

asio::awaitable<void> MessageSession::watch() {
  error_code code;
  while (transport_->is_open()) {
    // What counts can change while it waits; looking four times per limit finds out soon enough.
    watchdog_.expires_after(std::min({config().hello, config().idle, config().stall, config().ping}) / 4);
    co_await watchdog_.async_wait(redirect_error_to(code));
    const Clock::time_point now = Clock::now();
    if (now >= deadline() || is_late(now) || !transport_->keep_alive(now)) close();
  }
}

void MessageSession::close() {
  if (!transport_->is_open()) return;
  conversation_->abandon();
  transport_->close();
  watchdog_.cancel();
  room_.cancel();
}

/// The server stops, and the client has got all that it waited for.
asio::awaitable<void> MessageSession::leave() {
  closing_ = true;
  last_write_ = Clock::now();
  co_await transport_->send_close();
  close();
}

void MessageSession::answer_sent() {
  const bool waiting = conversation_->outstanding() > 0 || !outgoing_.empty();
  const bool draining = draining_ || peer_.context->draining;
  if (!draining || waiting || closing_ || !transport_->is_open()) return;
  spawn([](auto self) -> asio::awaitable<void> { co_await self->leave(); });
}

}  // namespace

std::shared_ptr<Session> start_message_session(std::shared_ptr<Transport> transport, Peer peer) {
  const auto session = std::make_shared<MessageSession>(std::move(transport), std::move(peer));
  session->start();
  return session;
}

}  // namespace surfcast::net
