#include "net/proxy_reader.h"

#include <array>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/steady_timer.hpp>
#include <optional>
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
          const std::optional<asio::ip::address> client = co_await self->read();
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
  asio::awaitable<std::optional<asio::ip::address>> read();
  asio::awaitable<std::optional<asio::ip::address>> read_header(const asio::ip::address& proxy);

  asio::steady_timer timeout_;
  tcp::socket socket_;
  AdmitClient admit_;
};

/// The address of the client; nothing: the connection is of no use.
asio::awaitable<std::optional<asio::ip::address>> ProxyReader::read() {
  error_code code;
  std::array<std::byte, 1> first{};
  const asio::ip::address proxy = socket_.remote_endpoint(code).address();
  if (code) co_return std::nullopt;
  co_await socket_.async_receive(asio::buffer(first), tcp::socket::message_peek, redirect_error_to(code));
  if (code) co_return std::nullopt;
  if (first[0] != kProxyByte) co_return proxy;
  co_return co_await read_header(proxy);
}

asio::awaitable<std::optional<asio::ip::address>> ProxyReader::read_header(const asio::ip::address& proxy) {
  error_code code;
  std::array<std::byte, kProxyHeadBytes> head{};
  co_await asio::async_read(socket_, asio::buffer(head), redirect_error_to(code));
  if (code) co_return std::nullopt;
  const Result<size_t> bytes = proxy_rest_bytes(head);
  if (!bytes) co_return std::nullopt;
  std::vector<std::byte> rest(*bytes);
  co_await asio::async_read(socket_, asio::buffer(rest), redirect_error_to(code));
  if (code) co_return std::nullopt;
  const Result<std::optional<asio::ip::address>> client = client_of_proxy(head, rest);
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
