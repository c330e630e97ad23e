#include "net/framed_session.h"

#include <algorithm>
#include <array>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/log.h"
#include "net/convert.h"
#include "protocol/errors.h"
#include "protocol/framing.h"
#include "protocol/hello.h"

namespace surfcast {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;
using Bytes = std::vector<std::byte>;

auto into(error_code& code) {
  return asio::redirect_error(asio::use_awaitable, code);
}

Bytes error_frame(uint64_t id, const Error& error) {
  wire::Answer answer;
  answer.set_id(id);
  to_wire(error, *answer.mutable_error());
  return *encode_frame(answer, kMaxAnswerBytes);
}

/// The frame of an answer, or of the error that it is too large.
Bytes answer_frame(const wire::Answer& answer) {
  Result<Bytes> frame = encode_frame(answer, kMaxAnswerBytes);
  return frame ? std::move(*frame) : error_frame(answer.id(), frame.error());
}

/// What the service's threads hand over: an answer as bytes, and what is to be counted.
struct Outcome {
  Bytes frame;
  bool failed = false;
  size_t picture_bytes = 0;         ///< encoded
  std::optional<FrameStats> stats;  ///< of a picture
};

Outcome failure(uint64_t id, const Error& error) {
  return {.frame = error_frame(id, error), .failed = true, .picture_bytes = 0, .stats = {}};
}

Outcome outcome_of(uint64_t id, Result<EncodedPicture> picture) {
  if (!picture) return failure(id, picture.error());
  Outcome outcome;
  outcome.picture_bytes = picture->bytes.size();
  outcome.stats = picture->stats;
  wire::Answer answer;
  answer.set_id(id);
  to_wire(std::move(*picture), *answer.mutable_picture());
  outcome.frame = answer_frame(answer);
  return outcome;
}

Outcome outcome_of(uint64_t id, const std::vector<std::string>& names) {
  wire::Answer answer;
  answer.set_id(id);
  to_wire(names, *answer.mutable_model_list());
  return {.frame = answer_frame(answer), .failed = false, .picture_bytes = 0, .stats = {}};
}

Outcome outcome_of(uint64_t id, const std::string& name, const Result<ModelDescription>& description) {
  if (!description) return failure(id, description.error());
  wire::Answer answer;
  answer.set_id(id);
  to_wire(name, *description, *answer.mutable_model_description());
  return {.frame = answer_frame(answer), .failed = false, .picture_bytes = 0, .stats = {}};
}

/// A reader, one queue of answers with a writer, and a watchdog. Answers of the service are made into bytes on the
/// service's threads and posted here; all else happens on the thread of the sockets.
class FramedSession : public Session, public std::enable_shared_from_this<FramedSession> {
 public:
  explicit FramedSession(Connection connection)
      : socket_(std::move(connection.socket)),
        context_(std::move(connection.context)),
        open_(std::move(connection.open)),
        id_(connection.id),
        busy_(connection.busy),
        window_(context_->config.requests),
        splitter_(kMaxRequestBytes),
        watchdog_(socket_.get_executor()),
        room_(socket_.get_executor(), Clock::time_point::max()) {}

  void start() {
    spawn([](auto self) -> asio::awaitable<void> { co_await self->read_all(); });
    spawn([](auto self) -> asio::awaitable<void> { co_await self->watch(); });
  }
  void drain() override { end_if_drained(); }
  void abort() override { close(); }

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
  asio::awaitable<void> linger();
  asio::awaitable<void> watch();

  bool handle_frames();
  void handle(const wire::Request& request);
  void handle_picture(const wire::Request& request);
  void handle_other(const wire::Request& request);
  void handle_cancel(const wire::Request& request);
  void draw_next();
  std::function<void(Outcome)> answer_later(uint64_t id);
  void hand_over(uint64_t id, Outcome outcome);

  void send(Bytes frame);
  void send_error(uint64_t id, const Error& error);
  void send_last(Bytes frame);
  void close();
  void end_if_drained();
  [[nodiscard]] bool too_much_unread() const { return outgoing_bytes_ > context_->config.unread_bytes; }
  [[nodiscard]] Clock::time_point deadline() const;

  tcp::socket socket_;
  std::shared_ptr<NetContext> context_;
  OpenConnection open_;
  SessionId id_;
  bool busy_;
  RequestWindow window_;
  FrameSplitter splitter_;
  std::array<std::byte, 16384> buffer_{};

  std::deque<Bytes> outgoing_;
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
    send(encode_hello(answer));
    co_return true;
  }
  spdlog::info("connection {} refused: {}", id_, answer.message);
  send_last(encode_hello(answer));
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
    wire::Request request;
    const Status decoded = !frame ? fail(frame.error()) : *frame ? decode_message(**frame, request) : Status();
    if (!decoded) {
      spdlog::info("connection {}: {}", id_, decoded.error().message);
      ++context_->metrics.errors;
      send_last(error_frame(0, decoded.error()));
      return false;
    }
    if (!frame->has_value()) return true;
    last_request_ = Clock::now();
    handle(request);
  }
}

void FramedSession::handle(const wire::Request& request) {
  ++context_->metrics.requests;
  if (context_->draining) return send_error(request.id(), {ErrorKind::kUnavailable, "the server is stopping"});
  switch (request.kind_case()) {
    case wire::Request::kDrawPicture:
      return handle_picture(request);
    case wire::Request::kListModels:
    case wire::Request::kDescribeModel:
      return handle_other(request);
    case wire::Request::kCancel:
      return handle_cancel(request);
    case wire::Request::kPing: {
      wire::Answer answer;
      answer.set_id(request.id());
      answer.mutable_pong();
      return send(answer_frame(answer));
    }
    case wire::Request::kPickSurfel:
    case wire::Request::kOpenView:
    case wire::Request::kUpdateView:
    case wire::Request::kFramePainted:
    case wire::Request::kCloseView:
    case wire::Request::KIND_NOT_SET:
      break;
  }
  send_error(request.id(), {ErrorKind::kUnsupported, "this server does not know that kind of request"});
}

void FramedSession::handle_picture(const wire::Request& request) {
  if (const Status admitted = window_.admit(request.id()); !admitted) {
    return send_error(request.id(), admitted.error());
  }
  Result<PictureJob> job = to_job(request.draw_picture());
  if (!job) return send_error(request.id(), job.error());
  window_.add_picture(request.id(), std::move(*job));
  draw_next();
}

/// Gives the service what it may have of this client's wishes.
void FramedSession::draw_next() {
  while (auto next = window_.next(outgoing_bytes_)) {
    const uint64_t id = next->first;
    const JobId job = context_->service.draw(
        id_, std::move(next->second),
        [later = answer_later(id), id](Result<EncodedPicture> picture) { later(outcome_of(id, std::move(picture))); });
    window_.set_job(id, job);
  }
}

void FramedSession::handle_other(const wire::Request& request) {
  const uint64_t id = request.id();
  if (const Status admitted = window_.admit(id); !admitted) return send_error(id, admitted.error());
  window_.add_other(id);
  if (request.has_list_models()) {
    return context_->service.list_models(
        [later = answer_later(id), id](const std::vector<std::string>& names) { later(outcome_of(id, names)); });
  }
  const std::string& name = request.describe_model().model();
  context_->service.describe_model(name,
                                   [later = answer_later(id), id, name](const Result<ModelDescription>& description) {
                                     later(outcome_of(id, name, description));
                                   });
}

/// A function for any thread that hands an answer over to this object. The io_context runs on until it was called.
std::function<void(Outcome)> FramedSession::answer_later(uint64_t id) {
  return [self = shared_from_this(), id, work = asio::make_work_guard(socket_.get_executor())](Outcome outcome) {
    asio::post(work.get_executor(),
               [self, id, outcome = std::move(outcome)]() mutable { self->hand_over(id, std::move(outcome)); });
  };
}

void FramedSession::hand_over(uint64_t id, Outcome outcome) {
  Metrics& metrics = context_->metrics;
  if (outcome.stats) metrics.count_picture(outcome.picture_bytes, *outcome.stats);
  if (outcome.failed) ++metrics.errors;
  window_.finish(id);
  send(std::move(outcome.frame));
  draw_next();
  end_if_drained();
}

void FramedSession::handle_cancel(const wire::Request& request) {
  const uint64_t target = request.cancel().request_id();
  const bool waited = window_.remove_waiting(target);
  if (waited) send_error(target, {ErrorKind::kCancelled, "the request was cancelled"});
  const std::optional<JobId> job = window_.job(target);
  wire::Answer answer;
  answer.set_id(request.id());
  answer.mutable_cancel_result()->set_was_outstanding(waited || (job && context_->service.cancel(*job)));
  send(answer_frame(answer));
}

void FramedSession::send_error(uint64_t id, const Error& error) {
  ++context_->metrics.errors;
  send(error_frame(id, error));
}

void FramedSession::send(Bytes frame) {
  if (!socket_.is_open() || last_words_) return;
  outgoing_bytes_ += frame.size();
  outgoing_.push_back(std::move(frame));
  if (outgoing_.size() > 1) return;  // the writer is at work
  last_write_ = Clock::now();
  spawn([](auto self) -> asio::awaitable<void> { co_await self->write_all(); });
}

/// Sends, then closes; whatever else is outstanding is given up.
void FramedSession::send_last(Bytes frame) {
  send(std::move(frame));
  last_words_ = true;
  for (const JobId job : window_.abandon()) context_->service.cancel(job);
}

asio::awaitable<void> FramedSession::write_all() {
  error_code code;
  while (!outgoing_.empty() && socket_.is_open()) {
    const Bytes& frame = outgoing_.front();
    size_t sent = 0;
    while (sent < frame.size() && !code) {
      const size_t count =
          co_await socket_.async_write_some(asio::buffer(frame.data() + sent, frame.size() - sent), into(code));
      sent += count;
      last_write_ = Clock::now();
    }
    if (code) break;
    outgoing_bytes_ -= frame.size();
    outgoing_.pop_front();
    room_.cancel();
    draw_next();
  }
  if (code) close();
  if (last_words_ && socket_.is_open()) co_await linger();
  end_if_drained();
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
  if (window_.outstanding() > 0) return Clock::now() + config.idle;
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
  for (const JobId job : window_.abandon()) context_->service.cancel(job);
  error_code ignored;
  socket_.shutdown(tcp::socket::shutdown_both, ignored);
  socket_.close(ignored);
  watchdog_.cancel();
  room_.cancel();
}

void FramedSession::end_if_drained() {
  if (context_->draining && window_.outstanding() == 0 && outgoing_.empty()) close();
}

}  // namespace

std::shared_ptr<Session> start_framed_session(Connection connection) {
  const auto session = std::make_shared<FramedSession>(std::move(connection));
  session->start();
  return session;
}

}  // namespace surfcast
