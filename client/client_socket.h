#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <chrono>
#include <cstddef>
#include <string>

#include "base/result.h"
#include "protocol/endpoint.h"
#include "tls/stream.h"

namespace surfcast::client {

/// An asynchronous operation of Asio and, once it is not pending any more, its outcome. Must outlive the operation.
struct Operation {
  bool begun = false;  ///< until the owner has used its outcome: it may be done while something else is waited for
  bool pending = false;
  boost::system::error_code outcome;
  size_t bytes = 0;

  /// The handler to start the operation with.
  auto begin() {
    begun = pending = true;
    return [this](const boost::system::error_code& code, size_t count = 0) {
      pending = false;
      outcome = code;
      bytes = count;
    };
  }
};

/// A TCP socket, with TLS or without, whose operations are asynchronous ones that are waited for: what a deadline or an
/// interrupt leaves unfinished goes on while something else is waited for.
class ClientSocket {
 public:
  using Stream = tls::Stream<boost::asio::ip::tcp::socket>;
  using Clock = std::chrono::steady_clock;

  /// Tries each address of the name in turn. Waiting ends when `interrupt` becomes readable (-1: none).
  Status connect(const protocol::Endpoint& server, Clock::time_point deadline, int interrupt);
  /// Begins TLS with the server of that name, which shows a certificate that make_trust(`ca`) believes.
  Status encrypt(const std::string& host, const std::string& ca, Clock::time_point deadline);
  /// Waits until the operation is done, and fails if it failed. kUnavailable at the deadline, kCancelled when
  /// interrupted: only then is it still pending.
  Status finish(const Operation& operation, Clock::time_point deadline);
  /// Whether the interrupt has come.
  bool interrupted();

  Stream& stream() { return stream_; }

 private:
  Status watch(int interrupt);

  boost::asio::io_context io_{1};
  Stream stream_{boost::asio::ip::tcp::socket(io_)};
  boost::asio::posix::stream_descriptor interrupt_{io_};
  bool interrupted_ = false;
  Operation connecting_;
  Operation shaking_hands_;
};

}  // namespace surfcast::client
