#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <chrono>
#include <functional>
#include <optional>

#include "base/result.h"
#include "net/answers.h"

namespace surfcast::net {

/// Carries whole messages over one socket. One reader and one writer may be at work at a time; both on the thread of
/// the sockets.
class Transport {
 public:
  template <typename Value>
  using Awaitable = boost::asio::awaitable<Value>;
  using Clock = std::chrono::steady_clock;

  virtual ~Transport() = default;

  /// The first message of the client.
  virtual Awaitable<Result<Bytes>> read_hello() = 0;
  /// The next one; nothing at the end of the stream. After an error the stream is of no use any more.
  virtual Awaitable<Result<std::optional<Bytes>>> read() = 0;

  /// When the client has begun with the message that is being read. Nothing: it has not.
  [[nodiscard]] virtual std::optional<Clock::time_point> reading_since() const = 0;

  /// False when the connection is gone.
  virtual Awaitable<bool> write_hello(const Bytes& hello) = 0;
  /// `progress` is called whenever the client has taken some bytes of the message.
  virtual Awaitable<bool> write(const Bytes& message, const std::function<void(size_t)>& progress) = 0;

  /// Lets the client read the last words before the connection is closed.
  virtual Awaitable<void> linger() = 0;
  /// Tells the client that the server stops, if there is a way to say so.
  virtual Awaitable<void> send_close() = 0;
  /// Looks whether the client is still there; to be called now and then. False when it is not.
  virtual bool keep_alive(Clock::time_point now) = 0;

  virtual void close() = 0;
  [[nodiscard]] virtual bool is_open() const = 0;
  [[nodiscard]] virtual boost::asio::any_io_executor executor() = 0;
};

}  // namespace surfcast::net
