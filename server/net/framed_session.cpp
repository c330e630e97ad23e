#include "net/framed_session.h"

#include <algorithm>
#include <array>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/log.h"
#include "net/conversation.h"
#include "protocol/framing.h"
#include "protocol/hello.h"

namespace surfcast {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

auto into(error_code& code) {
  return asio::redirect_error(asio::use_awaitable, code);
}

/// Messages that wait to be sent; a hello is not framed.
struct Outgoing {
  Bytes header;
  Bytes content;
  [[nodiscard]] size_t size() const { return header.size() + content.size(); }
};

Outgoing framed(Bytes answer) {
  const auto header = frame_header(answer.size());
  return {{header.begin(), header.end()}, std::move(answer)};
}

/// A reader, one queue of answers with a writer, and a watchdog, all on the thread of the sockets. What is said is the
/// conversation's affair.
class FramedSession : public Session, public AnswerWriter, public std::enable_shared_from_this<FramedSession> {
 public:
  explicit FramedSession(Connection connection)
      : socket_(std::move(connection.socket)),
        context_(std::move(connection.context)),
        open_(std::move(connection.open)),
        id_(connection.id),
        busy_(connection.busy),
        splitter_(kMaxRequestBytes),
        watchdog_(socket_.get_executor()),
        room_(socket_.get_executor(), Clock::time_point::max()) {}

  void start() {
    conversation_ = std::make_shared<Conversation>(context_, id_, socket_.get_executor(), shared_from_this());
    spawn([](auto self) -> asio::awaitable<void> { co_await self->read_all(); });
    spawn([](auto self) -> asio::awaitable<void> { co_await self->watch(); });
  }
  void drain() override { settled(); }
  void abort() override { close(); }

  void send(Bytes answer) override { queue(framed(std::move(answer))); }
  [[nodiscard]] size_t unread_bytes() const override { return outgoing_bytes_; }
  void settled() override;

 private:
  /// Runs a coroutine that keeps the session alive.
  template <typename Coroutine>
  void spawn(Coroutine coroutine) {
    asio::co_spawn(socket_.get_executor(), coroutine(shared_from_this()), asio::detached);
  }

  asio::awaitable<void> read_all();
  asio::awaitable<bool> exchange_hellos();
  asio::awaitable<Result<Hello>> read_hello();
  asio::awaitable<bool> read_some();
  asio::awaitable<void> write_all();
  asio::awaitable<void> write_one(const Outgoing& message, error_code& code);
  asio::awaitable<void> linger();
  asio::awaitable<void> watch();

  bool handle_frames();
  void queue(Outgoing message);
  void send_last(Outgoing message);
  void close();
  [[nodiscard]] bool too_much_unread() const { return outgoing_bytes_ > context_->config.unread_bytes; }
  [[nodiscard]] Clock::time_point deadline() const;

  tcp::socket socket_;
  std::shared_ptr<NetContext> context_;
  OpenConnection open_;
  SessionId id_;
  bool busy_;
  std::shared_ptr<Conversation> conversation_;
  FrameSplitter splitter_;
  std::array<std::byte, 16384> buffer_{};

  std::deque<Outgoing> outgoing_;
  size_t outgoing_bytes_ = 0;
  bool last_words_ = false;  ///< close when the queue is empty

  asio::steady_timer watchdog_;
  asio::steady_timer room_;  ///< cancelled when the reader should look again whether it may go on
  bool greeted_ = false;
  Clock::time_point last_request_ = Clock::now();
  Clock::time_point last_write_ = Clock::now();
};

asio::awaitable<void> FramedSession::read_all() {
  bool going_on = co_await exchange_hellos();
  greeted_ = going_on;
  last_request_ = Clock::now();
  while (going_on) {
    // GCC 12 makes wrong code of a co_await inside a condition: it stands by itself here and below.
    going_on = co_await read_some();
    if (going_on) going_on = handle_frames();
  }
  if (!last_words_) close();
}

asio::awaitable<Result<Hello>> FramedSession::read_hello() {
  error_code code;
  Bytes bytes(kHelloHeaderBytes);
  co_await asio::async_read(socket_, asio::buffer(bytes), into(code));
  if (code) co_return fail(ErrorKind::kIo, code.message());
  const Result<size_t> text = hello_text_bytes(std::span(bytes).first<kHelloHeaderBytes>());
  if (!text) co_return fail(text.error());
  bytes.resize(kHelloHeaderBytes + *text);
  co_await asio::async_read(socket_, asio::buffer(bytes.data() + kHelloHeaderBytes, *text), into(code));
  if (code) co_return fail(ErrorKind::kIo, code.message());
  co_return decode_hello(bytes);
}

asio::awaitable<bool> FramedSession::exchange_hellos() {
  const Result<Hello> client = co_await read_hello();
  if (!client) co_return false;
  Hello answer = answer_hello(*client, "surfcastd");
  if (busy_ && answer.status == HelloStatus::kWelcome) {
    answer.status = HelloStatus::kBusy;
    answer.message = "the server is busy: too many connections";
  }
  if (answer.status == HelloStatus::kWelcome) {
    queue({{}, encode_hello(answer)});
    co_return true;
  }
  spdlog::info("connection {} refused: {}", id_, answer.message);
  send_last({{}, encode_hello(answer)});
  co_return false;
}

/// Waits until the client has read enough of its answers, then reads. False at the end of the stream.
asio::awaitable<bool> FramedSession::read_some() {
  error_code code;
  while (too_much_unread() && socket_.is_open()) {
    co_await room_.async_wait(into(code));
  }
  const size_t count = co_await socket_.async_read_some(asio::buffer(buffer_), into(code));
  if (code) co_return false;
  splitter_.append(std::span(buffer_).first(count));
  co_return true;
}

/// Handles every whole request that has arrived. False when the stream is of no use any more.
bool FramedSession::handle_frames() {
  for (;;) {
    const Result<std::optional<Bytes>> frame = splitter_.next();
    if (frame && !frame->has_value()) return true;
    if (frame) last_request_ = Clock::now();
    const Status handled = frame ? conversation_->receive(**frame) : fail(frame.error());
    if (handled) continue;
    spdlog::info("connection {}: {}", id_, handled.error().message);
    ++context_->metrics.errors;
    conversation_->abandon();
    send_last(framed(encode_error(0, handled.error())));
    return false;
  }
}

void FramedSession::queue(Outgoing message) {
  if (!socket_.is_open() || last_words_) return;
  outgoing_bytes_ += message.size();
  outgoing_.push_back(std::move(message));
  if (outgoing_.size() > 1) return;  // the writer is at work
  last_write_ = Clock::now();
  spawn([](auto self) -> asio::awaitable<void> { co_await self->write_all(); });
}

/// Sends, then closes.
void FramedSession::send_last(Outgoing message) {
  queue(std::move(message));
  last_words_ = true;
}

asio::awaitable<void> FramedSession::write_one(const Outgoing& message, error_code& code) {
  std::array<asio::const_buffer, 2> rest{asio::buffer(message.header), asio::buffer(message.content)};
  while (asio::buffer_size(rest) > 0 && !code) {
    const size_t sent = co_await socket_.async_write_some(rest, into(code));
    const size_t of_header = std::min(sent, rest[0].size());
    rest[0] += of_header;
    rest[1] += sent - of_header;
    last_write_ = Clock::now();
  }
}

asio::awaitable<void> FramedSession::write_all() {
  error_code code;
  while (!outgoing_.empty() && socket_.is_open()) {
    co_await write_one(outgoing_.front(), code);
    if (code) break;
    outgoing_bytes_ -= outgoing_.front().size();
    outgoing_.pop_front();
    room_.cancel();
    conversation_->more_room();
  }
  if (code) close();
  if (last_words_ && socket_.is_open()) co_await linger();
  settled();
}

/// Lets the client read the last words. Closing at once would reset the connection if bytes of the client are unread,
/// and a reset may throw away what is still on its way to it.
asio::awaitable<void> FramedSession::linger() {
  error_code code;
  socket_.shutdown(tcp::socket::shutdown_send, code);
  while (!code) {
    co_await socket_.async_read_some(asio::buffer(buffer_), into(code));
  }
  close();
}

/// When the session is to be closed if nothing happens until then.
Clock::time_point FramedSession::deadline() const {
  const ServerConfig& config = context_->config;
  if (!outgoing_.empty()) return last_write_ + config.stall;
  if (last_words_) return last_write_ + std::min(config.hello, config.stall);
  if (!greeted_) return last_request_ + config.hello;
  if (conversation_->outstanding() > 0) return Clock::now() + config.idle;
  return last_request_ + config.idle;
}

asio::awaitable<void> FramedSession::watch() {
  error_code code;
  while (socket_.is_open()) {
    // What counts can change while it waits; looking four times per limit finds out soon enough.
    const auto limits = context_->config;
    watchdog_.expires_after(std::min({limits.hello, limits.idle, limits.stall}) / 4);
    co_await watchdog_.async_wait(into(code));
    if (Clock::now() >= deadline()) close();
  }
}

void FramedSession::close() {
  if (!socket_.is_open()) return;
  conversation_->abandon();
  error_code ignored;
  socket_.shutdown(tcp::socket::shutdown_both, ignored);
  socket_.close(ignored);
  watchdog_.cancel();
  room_.cancel();
}

void FramedSession::settled() {
  if (context_->draining && conversation_->outstanding() == 0 && outgoing_.empty()) close();
}

}  // namespace

std::shared_ptr<Session> start_framed_session(Connection connection) {
  const auto session = std::make_shared<FramedSession>(std::move(connection));
  session->start();
  return session;
}

}  // namespace surfcast
