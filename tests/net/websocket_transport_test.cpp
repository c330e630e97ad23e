#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/read.hpp>
#include <chrono>
#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include "net/raw_websocket.h"
#include "net/transports.h"

namespace surfcast::net {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;

struct Partings {
  bool server_said_goodbye = false;
  bool reader_ended = false;
};

asio::awaitable<void> say_goodbye(std::shared_ptr<Transport> transport, Partings& partings) {
  co_await transport->send_close();
  partings.server_said_goodbye = true;
}

/// Reads a message. Then the server says goodbye, and the reader goes on `turns` turns of the event loop later.
asio::awaitable<void> part_after_one_message(tcp::acceptor& acceptor, int turns, Partings& partings) {
  ClientStream stream(boost::beast::tcp_stream(co_await acceptor.async_accept(asio::use_awaitable)));
  boost::beast::flat_buffer buffer;
  UpgradeHead head;
  co_await boost::beast::http::async_read(stream, buffer, head, asio::use_awaitable);
  const auto transport = make_websocket_transport(std::move(stream), head, std::chrono::seconds(30), 65536);
  const auto hello = co_await transport->read_hello();
  EXPECT_TRUE(hello);
  const auto message = co_await transport->read();
  EXPECT_TRUE(message && *message);
  asio::co_spawn(acceptor.get_executor(), say_goodbye(transport, partings), asio::detached);
  for (int i = 0; i < turns; ++i) co_await asio::post(acceptor.get_executor(), asio::use_awaitable);
  const auto end = co_await transport->read();
  EXPECT_TRUE(end && !*end);
  partings.reader_ended = true;
}

/// The client's goodbye lies behind a message that the server has just read, and the server says goodbye as well: on
/// its own account, at any moment.
TEST(WebSocketTransportTest, BothSidesMaySayGoodbyeAtOnce) {
  for (int turns = 0; turns < 6; ++turns) {
    asio::io_context io{1};
    tcp::acceptor acceptor(io, tcp::endpoint(asio::ip::address_v4::loopback(), 0));
    Partings partings;
    asio::co_spawn(io, part_after_one_message(acceptor, turns, partings), asio::detached);
    std::jthread server([&io] { io.run_for(std::chrono::seconds(10)); });
    {
      RawWebSocket client(acceptor.local_endpoint().port());
      client.send_hello();
      client.socket.send(RawWebSocket::frame(0x80 | RawWebSocket::kBinary, "painted") +
                         RawWebSocket::frame(0x80 | RawWebSocket::kClose, "\x03\xe8"));
      EXPECT_EQ(client.read_close(), 1001U) << "going away";
    }
    server.join();
    EXPECT_TRUE(partings.server_said_goodbye) << turns << " turns";
    EXPECT_TRUE(partings.reader_ended) << turns << " turns";
  }
}

}  // namespace
}  // namespace surfcast::net
