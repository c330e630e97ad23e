#include "net/message_session.h"

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/steady_timer.hpp>
#include <deque>
#include <optional>
#include <utility>

#include "base/log.h"
#include "net/conversation.h"
#include "net/redirect_error_to.h"
#include "protocol/hello.h"

namespace surfcast::net {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

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
    conversation_ = std::make_shared<Conversation>(peer_.context, peer_.id, transport_->executor(), shared_from_this(),
                                                   peer_.open.client());
    spawn([](auto self) -> asio::awaitable<void> { co_await self->read_all(); });
    spawn([](auto self) -> asio::awaitable<void> { co_await self->watch(); });
  }
  void drain() override { answer_sent(); }
  void abort() override { close(); }
  void models_changed() override { conversation_->models_changed(); }

  void send(Bytes answer) override;
  [[nodiscard]] size_t unread_bytes() const override { return outgoing_bytes_; }
  void answer_sent() override;

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
  [[nodiscard]] Clock::time_point deadline() const;

  std::shared_ptr<Transport> transport_;
  Peer peer_;
  std::shared_ptr<Conversation> conversation_;

  std::deque<Bytes> outgoing_;
  size_t outgoing_bytes_ = 0;
  bool closing_ = false;  ///< nothing more is said after what is in the queue

  asio::steady_timer watchdog_;
  asio::steady_timer room_;  ///< cancelled when the reader should look again whether it may go on
  bool greeted_ = false;
  Clock::time_point last_request_ = Clock::now();
  Clock::time_point last_write_ = Clock::now();
};

asio::awaitable<void> MessageSession::read_all() {
  bool going_on = co_await exchange_hellos();
  while (going_on) {
    // GCC 12 makes wrong code of a co_await inside a condition: it stands by itself here and below.
    going_on = co_await read_one();
  }
  if (!closing_) close();
}

asio::awaitable<bool> MessageSession::exchange_hellos() {
  const Result<Bytes> bytes = co_await transport_->read_hello();
  const Result<protocol::Hello> client = bytes ? protocol::decode_hello(*bytes) : fail(bytes.error());
  if (!client || closing_) co_return false;
  protocol::Hello answer = protocol::answer_hello(*client, "surfcastd");
  if (!peer_.refusal.empty() && answer.status == protocol::HelloStatus::kWelcome) {
    answer.status = protocol::HelloStatus::kBusy;
    answer.message = peer_.refusal;
  }
  const Bytes words = protocol::encode_hello(answer);
  greeted_ = co_await transport_->write_hello(words);
  last_request_ = last_write_ = Clock::now();
  if (closing_) co_return false;  // the server stops meanwhile, and leave() has the last word
  if (answer.status == protocol::HelloStatus::kWelcome) co_return greeted_;
  spdlog::info("connection {} refused: {}", peer_.id, answer.message);
  closing_ = true;
  co_await transport_->linger();
  close();
  co_return false;
}

/// Waits until the client has read enough of its answers, then handles one request of it. False at the end.
asio::awaitable<bool> MessageSession::read_one() {
  error_code code;
  while (outgoing_bytes_ > config().unread_bytes && transport_->is_open()) {
    co_await room_.async_wait(redirect_error_to(code));
  }
  const Result<std::optional<Bytes>> message = co_await transport_->read();
  if (message && !message->has_value()) co_return false;
  last_request_ = Clock::now();
  const Status handled = message ? conversation_->receive(**message) : fail(message.error());
  if (handled) co_return true;
  spdlog::info("connection {}: {}", peer_.id, handled.error().message);
  ++peer_.context->metrics.errors;
  conversation_->abandon();
  send_last(encode_error(0, handled.error()));
  co_return false;
}

void MessageSession::send(Bytes answer) {
  if (!transport_->is_open() || closing_) return;
  outgoing_bytes_ += answer.size();
  outgoing_.push_back(std::move(answer));
  if (outgoing_.size() > 1) return;  // the writer is at work
  last_write_ = Clock::now();
  spawn([](auto self) -> asio::awaitable<void> { co_await self->write_all(); });
}

/// Sends, then closes.
void MessageSession::send_last(Bytes answer) {
  send(std::move(answer));
  closing_ = true;
}

asio::awaitable<void> MessageSession::write_all() {
  bool written = true;
  while (written && !outgoing_.empty() && transport_->is_open()) {
    written = co_await transport_->write(outgoing_.front(), [this] { last_write_ = Clock::now(); });
    if (!written) break;
    outgoing_bytes_ -= outgoing_.front().size();
    outgoing_.pop_front();
    room_.cancel();
    conversation_->resume_sending();
  }
  if (!written) close();
  if (closing_ && transport_->is_open()) {
    co_await transport_->linger();
    close();
  }
  answer_sent();
}

/// When the session is to be closed if nothing happens until then.
Clock::time_point MessageSession::deadline() const {
  if (!outgoing_.empty()) return last_write_ + config().stall;
  if (closing_) return last_write_ + std::min(config().hello, config().stall);
  if (!greeted_) return last_request_ + config().hello;
  if (conversation_->outstanding() > 0) return Clock::now() + config().idle;
  return last_request_ + config().idle;
}

asio::awaitable<void> MessageSession::watch() {
  error_code code;
  while (transport_->is_open()) {
    // What counts can change while it waits; looking four times per limit finds out soon enough.
    watchdog_.expires_after(std::min({config().hello, config().idle, config().stall, config().ping}) / 4);
    co_await watchdog_.async_wait(redirect_error_to(code));
    const Clock::time_point now = Clock::now();
    if (now >= deadline() || !transport_->keep_alive(now)) close();
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
  if (!peer_.context->draining || waiting || closing_ || !transport_->is_open()) return;
  spawn([](auto self) -> asio::awaitable<void> { co_await self->leave(); });
}

}  // namespace

std::shared_ptr<Session> start_message_session(std::shared_ptr<Transport> transport, Peer peer) {
  const auto session = std::make_shared<MessageSession>(std::move(transport), std::move(peer));
  session->start();
  return session;
}

}  // namespace surfcast::net
