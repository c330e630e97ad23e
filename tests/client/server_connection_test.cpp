#include "client/server_connection.h"

#include <chrono>
#include <span>
#include <string>

#include <gtest/gtest.h>

#include "client/scripted_server.h"
#include "protocol/hello.h"

namespace surfcast::client {
namespace {

using std::chrono::milliseconds;

std::string bytes_of(const protocol::Hello& hello) {
  const std::vector<std::byte> bytes = protocol::encode_hello(hello);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

constexpr milliseconds kShort{200};  // for what never comes

Error error_of_connecting(const std::string& words, bool stays = false, milliseconds timeout = kLong) {
  const ScriptedServer server(words, stays);
  const auto connection = ServerConnection::open(server.endpoint(), {.connect = timeout, .answer = timeout});
  return connection ? Error{ErrorKind::kInternal, "connected"} : connection.error();
}

Error error_of_asking(const std::string& words, bool stays = false, milliseconds timeout = kLong) {
  const ScriptedServer server(bytes_of(protocol::make_hello("surfcastd")) + words, stays);
  auto connection = ServerConnection::open(server.endpoint(), {.connect = kLong, .answer = timeout});
  if (!connection) return connection.error();
  wire::Request request;
  request.mutable_ping();
  const auto answer = connection->ask(request);
  return answer ? Error{ErrorKind::kInternal, "answered"} : answer.error();
}

TEST(ServerConnection, AServerOfAnotherMajorVersionIsExplained) {
  protocol::Hello hello = protocol::make_hello("surfcastd");
  hello.version = {7, 3};
  const Error error = error_of_connecting(bytes_of(hello));
  EXPECT_EQ(error.kind, ErrorKind::kUnsupported);
  EXPECT_NE(error.message.find("protocol 7.3"), std::string::npos);
}

TEST(ServerConnection, ARefusalIsRepeated) {
  protocol::Hello hello = protocol::make_hello("surfcastd");
  hello.status = protocol::HelloStatus::kVersionRefused;
  hello.message = "I am too old for you";
  EXPECT_NE(error_of_connecting(bytes_of(hello)).message.find("I am too old for you"), std::string::npos);
}

TEST(ServerConnection, AServerOfAnotherProtocolIsExplained) {
  const Error error = error_of_connecting("HTTP/1.1 400 Bad Request\r\nContent-Length: 0\r\n\r\n");
  EXPECT_NE(error.message.find("does not speak the surfcast protocol"), std::string::npos);
}

TEST(ServerConnection, EveryTruncatedHelloIsAnError) {
  const std::string hello = bytes_of(protocol::make_hello("surfcastd"));
  for (size_t length = 0; length < hello.size(); length += 5) {
    EXPECT_EQ(error_of_connecting(hello.substr(0, length)).kind, ErrorKind::kIo) << length;
  }
}

TEST(ServerConnection, ASilentServerIsGivenUp) {
  EXPECT_NE(error_of_connecting("", /*stays=*/true, kShort).message.find("timed out"), std::string::npos);
  EXPECT_NE(error_of_asking("", /*stays=*/true, kShort).message.find("timed out"), std::string::npos);
  EXPECT_NE(error_of_asking(std::string("\x40\0\0\0half", 8), /*stays=*/true, kShort).message.find("timed out"),
            std::string::npos);
}

TEST(ServerConnection, AServerThatLeavesIsExplained) {
  EXPECT_NE(error_of_asking("").message.find("closed the connection"), std::string::npos);
}

TEST(ServerConnection, AnAnswerBeyondTheLimitIsRefusedWithoutReadingIt) {
  EXPECT_EQ(error_of_asking("\xff\xff\xff\xff", /*stays=*/true).kind, ErrorKind::kLimit);
}

TEST(ServerConnection, AnAnswerThatIsNotOneIsAnError) {
  EXPECT_EQ(error_of_asking(std::string("\x02\0\0\0\xff\xff", 6), /*stays=*/true).kind, ErrorKind::kInvalidInput);
}

TEST(ServerConnection, TheHelloNamesTheModelThatWillBeAskedFor) {
  ScriptedServer server(bytes_of(protocol::make_hello("surfcastd")), /*stays=*/true);
  { EXPECT_TRUE(ServerConnection::open(server.endpoint(), {.connect = kLong, .answer = kLong, .model = "church"})); }
  EXPECT_TRUE(server.heard().ends_with(" model=church")) << server.heard();
}

TEST(ServerConnection, AnInterruptEndsTheWaitAndTheServerIsTold) {
  ScriptedServer server(bytes_of(protocol::make_hello("surfcastd")), /*stays=*/true);
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  wire::Request request;
  request.mutable_ping();
  {
    auto connection = ServerConnection::open(
        server.endpoint(), {.connect = milliseconds(5000), .answer = milliseconds(60'000), .interrupt = ends[0]});
    ASSERT_TRUE(connection);
    ASSERT_EQ(::write(ends[1], "x", 1), 1);
    EXPECT_EQ(connection->ask(request).error().kind, ErrorKind::kCancelled);
  }
  wire::Request cancel;
  cancel.set_id(2);
  cancel.mutable_cancel()->set_request_id(1);
  EXPECT_TRUE(server.heard().ends_with(cancel.SerializeAsString()));
  ::close(ends[0]);
  ::close(ends[1]);
}

}  // namespace
}  // namespace surfcast::client
