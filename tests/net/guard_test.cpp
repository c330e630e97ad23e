#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "net/net_fixture.h"
#include "net/raw_websocket.h"
#include "net/reading_rate.h"
#include "protocol/framing.h"
#include "protocol/hello.h"

namespace surfcast::net {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// Clients that mean no good.
class GuardTest : public NetFixture {
 protected:
  /// All that the server says to these bytes until it closes the connection.
  [[nodiscard]] std::string all_answers(const std::string& bytes) const {
    RawSocket socket(port_);
    socket.send(bytes);
    return socket.read_to_end();
  }
  static size_t count(const std::string& text, const std::string& word) {
    size_t found = 0;
    for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
    return found;
  }
  /// A connection of the framed protocol after its hellos.
  [[nodiscard]] RawSocket greeted(int receive_buffer = 0) const {
    RawSocket socket(port_, receive_buffer);
    socket.send(protocol::encode_hello(protocol::make_hello("test")));
    const std::string head = socket.read_exactly(protocol::kHelloHeaderBytes);
    const auto text = protocol::hello_text_bytes(std::as_bytes(std::span(head)).first<protocol::kHelloHeaderBytes>());
    socket.read_exactly(*text);
    return socket;
  }
};

TEST_F(GuardTest, ARequestInTheBodyOfAnotherIsNotAnswered) {
  start();
  const std::string second = "GET /metrics HTTP/1.1\r\nHost: here\r\nConnection: close\r\n\r\n";
  for (const std::string method : {"GET", "POST"}) {
    for (const std::string encoding : {"gzip", "identity", "xchunked", "\"chunked\"", "chunked, gzip"}) {
      const std::string answers = all_answers(
          method + " /healthz HTTP/1.1\r\nHost: here\r\nTransfer-Encoding: " + encoding + "\r\n\r\n" + second);
      EXPECT_THAT(answers, StartsWith("HTTP/1.1 400")) << encoding;
      EXPECT_EQ(count(answers, "HTTP/1.1 "), 1U) << encoding;
    }
  }
}

TEST_F(GuardTest, ARequestWithoutOneHostIsRefused) {
  start();
  EXPECT_THAT(all_answers("GET /healthz HTTP/1.1\r\n\r\n"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(all_answers("GET /healthz HTTP/1.1\r\nHost: here\r\nHost: here\r\n\r\n"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(all_answers("GET /healthz HTTP/1.0\r\n\r\n"), StartsWith("HTTP/1.0 200"));
}

TEST_F(GuardTest, ANameThatWasMadeToLeadHereGetsNothing) {
  start();
  for (const std::string target : {"/api/models", "/metrics", "/healthz", "/"}) {
    const std::string answer = all_answers("GET " + target + " HTTP/1.1\r\nHost: attacker.example:7600\r\n\r\n");
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 421")) << target;
  }
  EXPECT_THAT(all_answers("PUT /api/uploads/a.laz HTTP/1.1\r\nHost: attacker.example\r\nContent-Length: 1\r\n\r\nx"),
              StartsWith("HTTP/1.1 421"));
  EXPECT_THAT(all_answers("GET /ws HTTP/1.1\r\nHost: attacker.example\r\nOrigin: http://attacker.example\r\n"
                          "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                          "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: surfcast.v1\r\n\r\n"),
              StartsWith("HTTP/1.1 421"));
}

TEST_F(GuardTest, PagesOfOtherSitesNeitherShowNorOrderPictures) {
  start();
  const std::string picture =
      "GET /api/models/cube/image?resolution=4,4 HTTP/1.1\r\nHost: here\r\nConnection: close\r\n";
  EXPECT_THAT(all_answers(picture + "Sec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: no-cors\r\n\r\n"),
              StartsWith("HTTP/1.1 403"));
  EXPECT_EQ(control_->drawn, 0);
  const std::string own = all_answers(picture + "Sec-Fetch-Site: same-origin\r\n\r\n");
  EXPECT_THAT(own, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(own, HasSubstr("Cross-Origin-Resource-Policy: same-origin\r\n"));
  EXPECT_THAT(get("/api/models/absent"), HasSubstr("Cross-Origin-Resource-Policy: same-origin\r\n"));
}

TEST_F(GuardTest, ASecondRequestMustBeWholeInTime) {
  ServerConfig config;
  config.hello = milliseconds(1500);  // for the first request, too, however busy the machine
  start(config);
  RawSocket socket(port_);
  socket.send(std::string_view("GET /healthz HTTP/1.1\r\nHost: here\r\n\r\n"));
  ASSERT_THAT(socket.read_http(), HasSubstr("200"));
  socket.send(std::string_view("GET /healthz HT"));
  EXPECT_TRUE(socket.closed_within(milliseconds(20'000)));
}

TEST_F(GuardTest, AMessageOfTheFramedProtocolMustBeWholeInTime) {
  ServerConfig config;
  config.hello = milliseconds(1500);  // for the hello, too, however busy the machine
  start(config);
  RawSocket socket = greeted();
  socket.send(std::string_view("\x10\0", 2));
  EXPECT_TRUE(socket.closed_within(milliseconds(20'000)));
}

TEST_F(GuardTest, AMessageOfAWebSocketMustBeWholeInTime) {
  ServerConfig config;
  config.hello = milliseconds(100);
  start(config);
  RawWebSocket socket(port_);
  socket.send_hello();
  socket.read_message();
  socket.send(RawWebSocket::kBinary, "x", /*last=*/false);
  EXPECT_TRUE(socket.socket.closed_within(milliseconds(20'000)));
}

TEST_F(GuardTest, ThreeRequestsOfNoKindEndTheConnection) {
  start();
  RawSocket socket = greeted();
  const std::string empty(4, '\0');
  socket.send(empty + empty + empty + empty);
  EXPECT_TRUE(socket.closed_within(milliseconds(20'000)));
}

TEST_F(GuardTest, AClientThatReadsNoAnswersIsNotReadFrom) {
  ServerConfig config;
  config.small_unread_bytes = 4096;
  start(config);
  RawSocket socket = greeted(/*receive_buffer=*/4096);
  const std::string ping = ping_request().SerializeAsString();
  std::string frames;
  const auto header = protocol::frame_header(ping.size());
  for (int i = 0; i < 1000; ++i)
    frames += std::string(reinterpret_cast<const char*>(header.data()), header.size()) + ping;
  size_t sent = 0;
  while (sent < (size_t{64} << 20) && socket.send_some(frames)) sent += frames.size();
  EXPECT_LT(sent, size_t{64} << 20) << "the buffers of both sockets are full, and the server keeps no more";
}

TEST_F(GuardTest, AClientThatVanishesBehindAnotherRequestHasItsPictureCancelled) {
  control_->slow = true;
  start();
  RawSocket socket(port_);
  socket.send(std::string_view("GET /api/models/cube/image HTTP/1.1\r\nHost: here\r\n\r\n"));
  ASSERT_TRUE(eventually([&] { return control_->drawn == 1; }));
  socket.send(std::string_view("G"));
  socket.close();
  EXPECT_TRUE(eventually([&] { return control_->cancelled == 1; }));
}

TEST(ReadingRateTest, IsTheAverageOverEachWindow) {
  const auto begin = ReadingRate::Clock::now();
  ReadingRate rate(milliseconds(1000), /*least=*/100, begin);
  EXPECT_FALSE(rate.is_too_slow(begin + milliseconds(999)));
  rate.take(100);
  EXPECT_FALSE(rate.is_too_slow(begin + milliseconds(1000)));
  rate.take(99);
  EXPECT_TRUE(rate.is_too_slow(begin + milliseconds(2000)));
  ReadingRate any(milliseconds(1000), /*least=*/0, begin);
  EXPECT_FALSE(any.is_too_slow(begin + milliseconds(5000)));
}

TEST_F(GuardTest, AClientThatHardlyReadsIsCutOff) {
  ServerConfig config;
  config.stall = milliseconds(200);
  config.least_rate = size_t{1} << 30;
  start(config);
  RawSocket socket(port_, /*receive_buffer=*/4096);
  socket.send(
      std::string_view("GET /api/models/noise/image?resolution=1024,1024&format=exr HTTP/1.1\r\nHost: here\r\n\r\n"));
  size_t taken = 0;
  for (std::string some = "x"; !some.empty(); taken += some.size()) {
    some = socket.read_exactly(1000);
    std::this_thread::sleep_for(milliseconds(1));
  }
  EXPECT_LT(taken, size_t{1024} * 1024 * 16) << "it is not taken to its end";
}

TEST_F(GuardTest, PicturesThatAreNotTakenCountAsMemory) {
  start();
  RawSocket socket(port_, /*receive_buffer=*/4096);
  socket.send(
      std::string_view("GET /api/models/noise/image?resolution=1024,1024&format=exr HTTP/1.1\r\nHost: here\r\n\r\n"));
  ASSERT_THAT(socket.read_exactly(15), StartsWith("HTTP/1.1 200"));
  EXPECT_GT(metric("surfcast_picture_memory_bytes"), 1'000'000);
  socket.close();
  EXPECT_TRUE(eventually([this] { return metric("surfcast_picture_memory_bytes") == 0; }));
}

}  // namespace
}  // namespace surfcast::net
