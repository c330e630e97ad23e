#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <future>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "client/message_channel.h"
#include "client/scripted_server.h"
#include "protocol/hello.h"

namespace surfcast::client {
namespace {

namespace asio = boost::asio;
namespace websocket = boost::beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;
using std::chrono::milliseconds;
using namespace std::string_literals;

/// Grants one WebSocket, or takes a framed connection, then sends these bytes, right or wrong, whatever the client
/// sends.
class ScriptedWebSocketServer {
 public:
  explicit ScriptedWebSocketServer(std::vector<std::string> pieces, bool websocket = true)
      : websocket_(websocket), thread_([this, pieces = std::move(pieces)] { serve(pieces); }) {}

  [[nodiscard]] protocol::Endpoint endpoint() const {
    return {"127.0.0.1", acceptor_.local_endpoint().port(), websocket_};
  }
  /// All pieces but the first wait for this.
  void go_on() { going_on_.set_value(); }
  /// Returns when all pieces have been sent.
  void wait_until_sent() { sent_.get_future().wait(); }
  /// What the client sent after its request; ask when its channel is gone.
  const std::string& heard() {
    thread_.join();
    return heard_;
  }

 private:
  void serve(const std::vector<std::string>& pieces) {
    error_code code;
    websocket::stream<tcp::socket> stream(acceptor_.accept());
    tcp::socket& socket = stream.next_layer();
    socket.set_option(tcp::no_delay(true));
    if (websocket_) stream.accept(code);
    asio::write(socket, asio::buffer(pieces.front()), code);
    if (pieces.size() > 1) going_on_.get_future().wait();
    for (size_t i = 1; i < pieces.size(); ++i) asio::write(socket, asio::buffer(pieces[i]), code);
    sent_.set_value();
    asio::read(socket, asio::dynamic_buffer(heard_), code);
  }

  const bool websocket_;
  asio::io_context io_;
  tcp::acceptor acceptor_{io_, tcp::endpoint(asio::ip::address_v4::loopback(), 0)};
  std::promise<void> going_on_;
  std::promise<void> sent_;
  std::string heard_;
  std::jthread thread_;
};

MessageChannel::TimePoint in(milliseconds duration) {
  return std::chrono::steady_clock::now() + duration;
}

std::string text_of(const Result<MessageChannel::Bytes>& message) {
  if (!message) return "error: " + message.error().message;
  return {reinterpret_cast<const char*>(message->data()), message->size()};
}

std::unique_ptr<MessageChannel> connect_to(const protocol::Endpoint& server, const std::string& model = "") {
  auto channel = connect_channel(server, in(kLong), -1, "", model);
  EXPECT_TRUE(channel);
  return std::move(*channel);
}

Result<MessageChannel::Bytes> greet(MessageChannel& channel) {
  return channel.exchange_hellos(std::as_bytes(std::span("hello", 5)), in(kLong));
}

/// What a client makes of the first message of a server that says this.
Result<MessageChannel::Bytes> first_message(const std::string& words) {
  ScriptedWebSocketServer server({words});
  return greet(*connect_to(server.endpoint()));
}

TEST(WebSocketChannel, MessagesComeOutWhole) {
  ScriptedWebSocketServer server({"\x82\x03one\x02\x01t\x00\x00\x80\x02wo"s});
  const auto channel = connect_to(server.endpoint());
  EXPECT_EQ(text_of(greet(*channel)), "one");
  EXPECT_EQ(text_of(channel->read(in(kLong))), "two");
  EXPECT_EQ(channel->read(in(milliseconds(0))).error().kind, ErrorKind::kUnavailable);
}

TEST(WebSocketChannel, BytesMayComeOneByOne) {
  std::vector<std::string> pieces{"\x82\x03one"};
  for (const char byte : "\x02\x7e\x01\x00"s + std::string(256, 'x') + "\x80\x01y"s) pieces.emplace_back(1, byte);
  ScriptedWebSocketServer server(pieces);
  server.go_on();
  const auto channel = connect_to(server.endpoint());
  EXPECT_EQ(text_of(greet(*channel)), "one");
  EXPECT_EQ(text_of(channel->read(in(kLong))), std::string(256, 'x') + "y");
}

TEST(WebSocketChannel, AReadThatTimedOutIsGoneOnWith) {
  ScriptedWebSocketServer server({"\x82\x03one\x82\x08half"s, " two"s});
  const auto channel = connect_to(server.endpoint());
  EXPECT_EQ(text_of(greet(*channel)), "one");
  EXPECT_EQ(channel->read(in(milliseconds(50))).error().kind, ErrorKind::kUnavailable);
  server.go_on();
  EXPECT_EQ(text_of(channel->read(in(kLong))), "half two");
}

TEST(MessageChannel, WhatArrivesDuringAWriteIsKept) {
  const std::vector<std::byte> hello = protocol::encode_hello(protocol::make_hello("test"));
  const std::string framed_hello(reinterpret_cast<const char*>(hello.data()), hello.size());
  for (const bool websocket : {false, true}) {
    ScriptedWebSocketServer server(
        websocket ? std::vector{"\x82\x03one"s, "\x82\x03two"s} : std::vector{framed_hello, "\x03\x00\x00\x00two"s},
        websocket);
    const auto channel = connect_to(server.endpoint());
    ASSERT_TRUE(greet(*channel));
    EXPECT_EQ(channel->read(in(milliseconds(0))).error().kind, ErrorKind::kUnavailable);
    server.go_on();
    server.wait_until_sent();
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(channel->write(std::as_bytes(std::span("more", 4)), in(kLong)));
    EXPECT_EQ(text_of(channel->read(in(kLong))), "two");
  }
}

/// A frame of a client without its mask.
std::string unmasked(std::string_view frame) {
  std::string content(frame.substr(6));
  for (size_t i = 0; i < content.size(); ++i) content[i] = static_cast<char>(content[i] ^ frame[2 + i % 4]);
  return content;
}

TEST(WebSocketChannel, PingsBetweenPiecesAreAnsweredAndAllIsMasked) {
  ScriptedWebSocketServer server(
      {"\x02\x01"
       "a"
       "\x89\x02hi\x80\x01"
       "b"s});
  auto channel = connect_to(server.endpoint());
  EXPECT_EQ(text_of(greet(*channel)), "ab");
  channel.reset();
  const std::string& heard = server.heard();
  ASSERT_EQ(heard.size(), 11u + 8u);
  EXPECT_EQ(heard.substr(0, 2), "\x82\x85");
  EXPECT_EQ(unmasked(heard.substr(0, 11)), "hello");
  EXPECT_EQ(heard.substr(11, 2), "\x8a\x82");
  EXPECT_EQ(unmasked(heard.substr(11)), "hi");
}

TEST(WebSocketChannel, ItsAddressNamesTheModel) {
  ScriptedServer server("HTTP/1.1 403 Forbidden\r\nContent-Length: 0\r\n\r\n");
  protocol::Endpoint endpoint = server.endpoint();
  endpoint.websocket = true;
  EXPECT_FALSE(greet(*connect_to(endpoint, "old church")));
  EXPECT_TRUE(server.heard().starts_with("GET /ws?model=old%20church HTTP/1.1\r\n")) << server.heard();
}

TEST(WebSocketChannel, WhatAServerMustNotSendIsAnErrorAtOnce) {
  for (const std::string& wrong : {"\x82\x83"
                                   "abcdone"s,
                                   "\x81\x04text"s, "\xc2\x01x"s, "\x80\x01x"s, "\x02\x01x\x82\x01x"s, "\x83\x01x"s}) {
    const auto message = first_message(wrong);
    ASSERT_FALSE(message) << wrong;
    EXPECT_EQ(message.error().kind, ErrorKind::kInvalidInput) << wrong << ": " << message.error().message;
  }
}

TEST(WebSocketChannel, AMessageBeyondTheLimitIsRefusedWithoutReadingIt) {
  const auto message = first_message("\x82\x7f\x00\x00\x00\x00\x20\x00\x00\x01"s);
  ASSERT_FALSE(message);
  EXPECT_EQ(message.error().kind, ErrorKind::kLimit);
}

TEST(WebSocketChannel, AGoodbyeIsTheEndThoughTheConnectionStays) {
  EXPECT_EQ(text_of(first_message("\x88\x02\x03\xe8"s)), "error: the server closed the connection");
}

TEST(WebSocketChannel, ARefusalIsRepeated) {
  for (const auto& [answer, explained] : std::vector<std::pair<std::string, std::string>>{
           {"HTTP/1.1 403 Forbidden\r\nContent-Length: 0\r\n\r\n", "403 Forbidden"},
           {"HTTP/1.1 101 Switching Protocols\r\n\r\n", "does not speak WebSocket"},
           {"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: upgrade\r\n"
            "Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n\r\n",
            "does not speak WebSocket"},
           {"\xf5SURFCST, and more of it", "does not speak WebSocket"},
           {"HTTP/1.1 10", "closed the connection"},
           {"", "closed the connection"}}) {
    ScriptedServer server(answer);
    protocol::Endpoint endpoint = server.endpoint();
    endpoint.websocket = true;
    const std::string outcome = text_of(greet(*connect_to(endpoint)));
    EXPECT_NE(outcome.find(explained), std::string::npos) << outcome;
  }
}

}  // namespace
}  // namespace surfcast::client
