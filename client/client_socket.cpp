#include "client/client_socket.h"

#include <boost/asio/error.hpp>
#include <boost/asio/ssl/error.hpp>
#include <string>

#include <fcntl.h>

#include "tls/trust.h"

namespace surfcast::client {

using boost::asio::ip::tcp;
using boost::system::error_code;

Status ClientSocket::watch(int interrupt) {
  if (interrupt < 0) return {};
  error_code code;
  interrupt_.assign(::fcntl(interrupt, F_DUPFD_CLOEXEC, 0), code);
  if (code) return fail(ErrorKind::kInternal, "an interrupt cannot be waited for: " + code.message());
  interrupt_.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                        [this](const error_code& failed) { interrupted_ = !failed; });
  return {};
}

Status ClientSocket::connect(const protocol::Endpoint& server, Clock::time_point deadline, int interrupt) {
  if (Status status = watch(interrupt); !status) return status;
  error_code code;
  const auto addresses = tcp::resolver(io_).resolve(server.host, std::to_string(server.port), code);
  if (code) return fail(ErrorKind::kIo, code.message());
  Status connected = fail(ErrorKind::kIo, "no address");
  for (const auto& address : addresses) {
    stream_.socket().close(code);
    stream_.socket().async_connect(address.endpoint(), connecting_.begin());
    connected = finish(connecting_, deadline);
    if (connected || connecting_.pending) break;
  }
  if (connected) stream_.socket().set_option(tcp::no_delay(true), code);
  return connected;
}

Status ClientSocket::encrypt(const std::string& host, const std::string& ca, Clock::time_point deadline) {
  const auto trust = tls::make_trust(ca);
  if (!trust) return fail(trust);
  stream_.encrypt(**trust);
  tls::expect_host(stream_, host);
  stream_.async_handshake(boost::asio::ssl::stream_base::client, shaking_hands_.begin());
  Status status = finish(shaking_hands_, deadline);
  if (status || shaking_hands_.pending) return status;
  return fail(ErrorKind::kIo, tls::explain_handshake(stream_, shaking_hands_.outcome));
}

bool ClientSocket::interrupted() {
  io_.restart();
  io_.poll();
  return interrupted_;
}

Status ClientSocket::finish(const Operation& operation, Clock::time_point deadline) {
  io_.restart();
  io_.poll();  // what can be done at once is done, whatever the deadline
  while (operation.pending) {
    if (interrupted_) return fail(ErrorKind::kCancelled, "interrupted");
    if (io_.run_one_until(deadline) == 0) return fail(ErrorKind::kUnavailable, "timed out");
  }
  if (!operation.outcome) return {};
  const bool left =
      operation.outcome == boost::asio::error::eof || operation.outcome == boost::asio::ssl::error::stream_truncated;
  return fail(ErrorKind::kIo, left ? "the server closed the connection" : operation.outcome.message());
}

}  // namespace surfcast::client
