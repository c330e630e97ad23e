#include "client/server_connection.h"

#include <array>
#include <span>
#include <string>
#include <thread>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "protocol/hello.h"

namespace surfcast {
namespace {

using std::chrono::milliseconds;

/// Accepts one connection and says what it is told, whatever the client sends.
class ScriptedServer {
 public:
  explicit ScriptedServer(std::string words, bool stays = false) : listener_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ::bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address);
    ::listen(listener_, 1);
    socklen_t size = sizeof address;
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::jthread([this, said = std::move(words), stays] { speak(said, stays); });
  }
  ~ScriptedServer() {
    ::shutdown(listener_, SHUT_RDWR);
    if (thread_.joinable()) thread_.join();
    ::close(listener_);
  }
  [[nodiscard]] Endpoint endpoint() const { return {"127.0.0.1", port_}; }

 private:
  void speak(const std::string& words, bool stays) const {
    const int peer = ::accept(listener_, nullptr, nullptr);
    if (peer < 0) return;
    ::send(peer, words.data(), words.size(), MSG_NOSIGNAL);
    std::array<char, 4096> ignored{};
    if (!stays) ::shutdown(peer, SHUT_WR);
    while (::recv(peer, ignored.data(), ignored.size(), 0) > 0) {
    }
    ::close(peer);
  }

  int listener_;
  uint16_t port_ = 0;
  std::jthread thread_;
};

std::string bytes_of(const Hello& hello) {
  const std::vector<std::byte> bytes = encode_hello(hello);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

ClientConfig impatient() {
  return {.connect = milliseconds(200), .answer = milliseconds(200), .interrupt = -1};
}

Error error_of_connecting(const std::string& words, bool stays = false) {
  const ScriptedServer server(words, stays);
  const auto connection = ServerConnection::open(server.endpoint(), impatient());
  return connection ? Error{ErrorKind::kInternal, "connected"} : connection.error();
}

Error error_of_asking(const std::string& words, bool stays = false) {
  const ScriptedServer server(bytes_of(make_hello("surfcastd")) + words, stays);
  auto connection = ServerConnection::open(server.endpoint(), impatient());
  if (!connection) return connection.error();
  wire::Request request;
  request.mutable_ping();
  const auto answer = connection->ask(request);
  return answer ? Error{ErrorKind::kInternal, "answered"} : answer.error();
}

TEST(ServerConnection, AServerOfAnotherMajorVersionIsExplained) {
  Hello hello = make_hello("surfcastd");
  hello.version = {7, 3};
  const Error error = error_of_connecting(bytes_of(hello));
  EXPECT_EQ(error.kind, ErrorKind::kUnsupported);
  EXPECT_NE(error.message.find("protocol 7.3"), std::string::npos);
}

TEST(ServerConnection, ARefusalIsRepeated) {
  Hello hello = make_hello("surfcastd");
  hello.status = HelloStatus::kVersionRefused;
  hello.message = "I am too old for you";
  EXPECT_NE(error_of_connecting(bytes_of(hello)).message.find("I am too old for you"), std::string::npos);
}

TEST(ServerConnection, AServerOfAnotherProtocolIsExplained) {
  const Error error = error_of_connecting("HTTP/1.1 400 Bad Request\r\nContent-Length: 0\r\n\r\n");
  EXPECT_NE(error.message.find("does not speak the surfcast protocol"), std::string::npos);
}

TEST(ServerConnection, EveryTruncatedHelloIsAnError) {
  const std::string hello = bytes_of(make_hello("surfcastd"));
  for (size_t length = 0; length < hello.size(); length += 5) {
    EXPECT_EQ(error_of_connecting(hello.substr(0, length)).kind, ErrorKind::kIo) << length;
  }
}

TEST(ServerConnection, ASilentServerIsGivenUp) {
  EXPECT_NE(error_of_connecting("", /*stays=*/true).message.find("timed out"), std::string::npos);
  EXPECT_NE(error_of_asking("", /*stays=*/true).message.find("timed out"), std::string::npos);
  EXPECT_NE(error_of_asking(std::string("\x40\0\0\0half", 8), /*stays=*/true).message.find("timed out"),
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

TEST(ServerConnection, AnInterruptEndsTheWait) {
  const ScriptedServer server(bytes_of(make_hello("surfcastd")), /*stays=*/true);
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  auto connection = ServerConnection::open(
      server.endpoint(), {.connect = milliseconds(5000), .answer = milliseconds(60'000), .interrupt = ends[0]});
  ASSERT_TRUE(connection);
  ASSERT_EQ(::write(ends[1], "x", 1), 1);
  wire::Request request;
  request.mutable_ping();
  EXPECT_EQ(connection->ask(request).error().kind, ErrorKind::kCancelled);
  ::close(ends[0]);
  ::close(ends[1]);
}

}  // namespace
}  // namespace surfcast
