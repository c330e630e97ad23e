#include "net/proxy_reader.h"

#include <array>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/steady_timer.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "net/proxy_header.h"
#include "net/redirect_error_to.h"

namespace surfcast::net {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

class ProxyReader : public Session, public std::enable_shared_from_this<ProxyReader> {
 public:
  ProxyReader(tcp::socket socket, std::chrono::milliseconds most, AdmitClient admit)
      : timeout_(socket.get_executor(), most), socket_(std::move(socket)), admit_(std::move(admit)) {}

  void start() {
    timeout_.async_wait([self = shared_from_this()](error_code code) {
      if (!code) self->abort();
    });
    asio::co_spawn(
        timeout_.get_executor(),
        [](std::shared_ptr<ProxyReader> self) -> asio::awaitable<void> {
          const Client client = co_await self->read();
          self->timeout_.cancel();
          if (client) self->admit_(std::move(self->socket_), *client);
        }(shared_from_this()),
        asio::detached);
  }
  void drain() override { abort(); }
  void abort() override {
    error_code ignored;
    socket_.close(ignored);
  }

 private:
  using Client = std::optional<asio::ip::address>;  ///< nothing: the connection is of no use

  asio::awaitable<Client> read();
  asio::awaitable<Client> read_line(const asio::ip::address& proxy);
  asio::awaitable<Client> read_header(const asio::ip::address& proxy);

  asio::steady_timer timeout_;
  tcp::socket socket_;
  AdmitClient admit_;
};

asio::awaitable<ProxyReader::Client> ProxyReader::read() {
  error_code code;
  const asio::ip::address proxy = socket_.remote_endpoint(code).address();
  if (code) co_return std::nullopt;
  // A peek would otherwise return with the first byte, again and again until the others have come.
  socket_.set_option(asio::socket_base::receive_low_watermark(static_cast<int>(kProxyProbeBytes)), code);
  std::array<std::byte, kProxyProbeBytes> first{};
  co_await socket_.async_wait(tcp::socket::wait_read, redirect_error_to(code));
  if (code) co_return std::nullopt;
  const size_t peeked = socket_.receive(asio::buffer(first), tcp::socket::message_peek, code);
  if (code || peeked < first.size()) co_return std::nullopt;  // the peer has closed the connection
  socket_.set_option(asio::socket_base::receive_low_watermark(1), code);
  switch (proxy_version(first)) {
    case ProxyVersion::kText:
      co_return co_await read_line(proxy);
    case ProxyVersion::kBinary:
      co_return co_await read_header(proxy);
    case ProxyVersion::kNone:
      break;
  }
  co_return proxy;
}

/// Byte by byte, because what follows the line is the client's.
asio::awaitable<ProxyReader::Client> ProxyReader::read_line(const asio::ip::address& proxy) {
  std::string line;
  while (!line.ends_with("\r\n")) {
    if (line.size() == kMaxProxyLine) co_return std::nullopt;
    char next = 0;
    error_code code;
    co_await asio::async_read(socket_, asio::buffer(&next, 1), redirect_error_to(code));
    if (code) co_return std::nullopt;
    line += next;
  }
  line.resize(line.size() - 2);
  const Result<Client> client = client_of_proxy_line(line);
  if (!client) co_return std::nullopt;
  co_return client->value_or(proxy);
}

asio::awaitable<ProxyReader::Client> ProxyReader::read_header(const asio::ip::address& proxy) {
  error_code code;
  std::array<std::byte, kProxyHeadBytes> head{};
  co_await asio::async_read(socket_, asio::buffer(head), redirect_error_to(code));
  if (code) co_return std::nullopt;
  const Result<size_t> bytes = proxy_rest_bytes(head);
  if (!bytes) co_return std::nullopt;
  std::vector<std::byte> rest(*bytes);
  co_await asio::async_read(socket_, asio::buffer(rest), redirect_error_to(code));
  if (code) co_return std::nullopt;
  const Result<Client> client = client_of_proxy(head, rest);
  if (!client) co_return std::nullopt;
  co_return client->value_or(proxy);
}

}  // namespace

std::shared_ptr<Session> start_proxy_reader(tcp::socket socket, std::chrono::milliseconds most, AdmitClient admit) {
  const auto reader = std::make_shared<ProxyReader>(std::move(socket), most, std::move(admit));
  reader->start();
  return reader;
}

}  // namespace surfcast::net
