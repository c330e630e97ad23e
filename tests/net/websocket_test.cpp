#include <string>
#include <vector>

#include "net/net_fixture.h"
#include "net/raw_websocket.h"
#include "protocol/framing.h"

namespace surfcast::net {
namespace {

class WebSocketTest : public NetFixture {
 protected:
  static std::string encoded(uint64_t id, wire::Request request) {
    request.set_id(id);
    return request.SerializeAsString();
  }
  static wire::Answer decoded(const std::string& message) {
    wire::Answer answer;
    EXPECT_TRUE(answer.ParseFromString(message));
    return answer;
  }
  static protocol::Hello hello_of(const std::string& message) {
    const auto hello = protocol::decode_hello(std::as_bytes(std::span(message)));
    return hello ? *hello
                 : protocol::Hello{.version = {}, .status = protocol::HelloStatus{99}, .program = {}, .message = {}};
  }
  /// A WebSocket that has exchanged hellos.
  RawWebSocket greeted(int receive_buffer = 0) const {
    RawWebSocket socket(port_, "", receive_buffer);
    socket.send_hello();
    EXPECT_EQ(hello_of(socket.read_message()).status, protocol::HelloStatus::kWelcome);
    return socket;
  }
};

TEST_F(WebSocketTest, IsGrantedWithItsSubprotocolAndWithoutCompression) {
  start();
  const RawWebSocket socket(port_, "Sec-WebSocket-Extensions: permessage-deflate\r\n");
  EXPECT_EQ(socket.answer.substr(9, 3), "101");
  EXPECT_NE(socket.answer.find("Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n"), std::string::npos);
  EXPECT_NE(socket.answer.find("Sec-WebSocket-Protocol: surfcast.v1\r\n"), std::string::npos);
  EXPECT_EQ(socket.answer.find("deflate"), std::string::npos);
}

TEST_F(WebSocketTest, AnswersRequests) {
  start();
  RawWebSocket socket = greeted();
  socket.send(RawWebSocket::kBinary, encoded(7, ping_request()));
  const wire::Answer pong = decoded(socket.read_message());
  EXPECT_EQ(pong.id(), 7u);
  EXPECT_TRUE(pong.has_pong());
}

TEST_F(WebSocketTest, LargePicturesComeWholeInSeveralFrames) {
  start();
  RawWebSocket socket = greeted();
  socket.send(RawWebSocket::kBinary, encoded(1, picture_request("noise", 400, 300)));
  const RawWebSocket::Frame first = socket.read_frame();
  EXPECT_FALSE(first.last);
  const wire::Answer answer = decoded(first.content + socket.read_message());
  EXPECT_GT(answer.picture().data().size(), 300'000u);
  EXPECT_EQ(answer.picture().data().substr(1, 3), "PNG");
}

TEST_F(WebSocketTest, RequestsMayComeInFragmentsWithPingsBetween) {
  start();
  RawWebSocket socket = greeted();
  const std::string request = encoded(300, ping_request());
  socket.send(RawWebSocket::kBinary, request.substr(0, 1), /*last=*/false);
  socket.send(RawWebSocket::kPing, "still there?");
  socket.send(RawWebSocket::kContinuation, request.substr(1, 1), /*last=*/false);
  socket.send(RawWebSocket::kContinuation, "", /*last=*/false);
  socket.send(RawWebSocket::kContinuation, request.substr(2));
  const RawWebSocket::Frame pong = socket.read_frame();
  EXPECT_EQ(pong.opcode, RawWebSocket::kPong);
  EXPECT_EQ(pong.content, "still there?");
  EXPECT_EQ(decoded(socket.read_message()).id(), 300u);
}

TEST_F(WebSocketTest, AWrongVersionIsToldWhichOneIsRight) {
  start();
  RawWebSocket socket(port_);
  protocol::Hello old = protocol::make_hello("test");
  old.version = {9, 0};
  socket.send_hello(old);
  const protocol::Hello answer = hello_of(socket.read_message());
  EXPECT_EQ(answer.status, protocol::HelloStatus::kVersionRefused);
  EXPECT_NE(answer.message.find("9.0"), std::string::npos);
  EXPECT_EQ(socket.read_close(), 1000u);
}

TEST_F(WebSocketTest, ABusyServerSaysSoInItsHello) {
  ServerConfig config;
  config.clients.connections = 1;
  start(config);
  RawWebSocket first = greeted();
  RawWebSocket second(port_);
  second.send_hello();
  EXPECT_EQ(hello_of(second.read_message()).status, protocol::HelloStatus::kBusy);
}

TEST_F(WebSocketTest, PagesOfOtherOriginsAreRefusedUnlessAllowed) {
  ServerConfig config;
  config.allowed_origins = {"https://friend.example"};
  start(config);
  const auto status = [this](const std::string& origin) {
    return RawWebSocket(port_, "Origin: " + origin + "\r\n").answer.substr(9, 3);
  };
  EXPECT_EQ(status("http://here"), "101");
  EXPECT_EQ(status("http://HERE"), "101");
  EXPECT_EQ(status("https://here"), "403") << "the server speaks no TLS";
  EXPECT_EQ(status("https://HERE\r\nX-Forwarded-Proto: https"), "101") << "a proxy before it does";
  EXPECT_EQ(status("http://here\r\nX-Forwarded-Proto: https"), "403");
  EXPECT_EQ(status("https://friend.example"), "101");
  for (const char* stranger : {"http://elsewhere", "http://here.elsewhere", "http://here:81", "null", "here", "http://",
                               "http://friend.example", "https://friend.example.org"}) {
    EXPECT_EQ(status(stranger), "403") << stranger;
  }
}

TEST_F(WebSocketTest, RequestsThatAskForNoneAreExplained) {
  start();
  EXPECT_EQ(get("/ws").substr(9, 3), "426");
  const std::string upgrade = "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n";
  const std::string key = "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
  const std::string without_protocol = http("GET /ws HTTP/1.1\r\nHost: here\r\n" + upgrade + key + "\r\n");
  EXPECT_EQ(without_protocol.substr(9, 3), "400");
  EXPECT_NE(without_protocol.find("surfcast.v1"), std::string::npos);
  EXPECT_EQ(http("GET /api/models HTTP/1.1\r\nHost: here\r\n" + upgrade + key + "\r\n").substr(9, 3), "200");
}

TEST_F(WebSocketTest, WordsBeforeTheGrantAreRefused) {
  start();
  RawSocket socket(port_);
  socket.send(
      "GET /ws HTTP/1.1\r\nHost: here\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
      "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: surfcast.v1\r\n\r\n" +
      RawWebSocket::frame(0x82, "hello"));
  EXPECT_EQ(socket.read_http().substr(9, 3), "400");
}

TEST_F(WebSocketTest, ATextMessageIsAnsweredAndEndsIt) {
  start();
  RawWebSocket socket = greeted();
  socket.send(RawWebSocket::kText, "{\"list_models\": {}}");
  EXPECT_EQ(decoded(socket.read_message()).error().code(), wire::ERROR_CODE_INVALID_INPUT);
  EXPECT_EQ(socket.read_close(), 1000u);
}

TEST_F(WebSocketTest, AMessageThatCannotBeDecodedIsAnsweredAndEndsIt) {
  start();
  RawWebSocket socket = greeted();
  socket.send(RawWebSocket::kBinary, "\xff\xff\xff\xff");
  EXPECT_TRUE(decoded(socket.read_message()).has_error());
  EXPECT_EQ(socket.read_close(), 1000u);
  socket.send(RawWebSocket::kClose, "\x03\xe8");
  EXPECT_TRUE(socket.socket.closed_within(milliseconds(5000)));
}

TEST_F(WebSocketTest, AMessageBeyondTheLimitEndsItBeforeItIsRead) {
  start();
  RawWebSocket socket = greeted();
  std::string announced = RawWebSocket::frame(0x82, std::string(70'000, 'x')).substr(0, 1000);
  announced[2] = '\x7f';  // the length's highest byte: more than 2^62 are to come
  socket.socket.send(announced);
  EXPECT_EQ(socket.read_close(), 1009u);
}

TEST_F(WebSocketTest, FragmentsThatTogetherExceedTheLimitEndIt) {
  start();
  RawWebSocket socket = greeted();
  const std::string piece(protocol::kMaxRequestBytes / 2 + 1, 'x');
  socket.send(RawWebSocket::kBinary, piece, /*last=*/false);
  socket.send(RawWebSocket::kContinuation, piece);
  EXPECT_EQ(socket.read_close(), 1009u);
}

TEST_F(WebSocketTest, BrokenFramesEndIt) {
  start();
  const std::string long_ping = RawWebSocket::frame(0x89, std::string(126, 'x'));
  for (const std::string& broken :
       {RawWebSocket::frame(0x82, "unmasked", false), RawWebSocket::frame(0x83, "reserved opcode"),
        RawWebSocket::frame(0x8b, "reserved control"), RawWebSocket::frame(0xc2, "compressed"),
        RawWebSocket::frame(0x80, "nothing to continue"), RawWebSocket::frame(0x09, "ping in fragments"), long_ping}) {
    RawWebSocket socket = greeted();
    socket.socket.send(broken);
    EXPECT_EQ(socket.read_close(), 1002u) << broken;
  }
}

TEST_F(WebSocketTest, AHalfClosedOrVanishedClientIsForgotten) {
  start();
  {
    RawWebSocket half = greeted();
    half.socket.shut_down();
    RawWebSocket gone = greeted();
    gone.send(RawWebSocket::kBinary, encoded(1, ping_request()).substr(0, 1), /*last=*/false);
    gone.socket.reset();
    EXPECT_TRUE(half.socket.closed_within(milliseconds(5000)));
  }
  EXPECT_TRUE(eventually([this] { return metric("surfcast_connections_open") == 1; }));  // the question's own
}

TEST_F(WebSocketTest, ALeavingClientHasItsPicturesCancelled) {
  start();
  control_->slow = true;
  RawWebSocket socket = greeted();
  socket.send(RawWebSocket::kBinary, encoded(1, picture_request("cube")));
  ASSERT_TRUE(eventually([this] { return control_->drawn == 1; }));
  socket.send(RawWebSocket::kClose, "\x03\xe8");
  EXPECT_TRUE(eventually([this] { return control_->cancelled == 1; }));
}

TEST_F(WebSocketTest, ASilentClientIsAskedAndThenTakenForGone) {
  ServerConfig config;
  config.ping = milliseconds(1500);  // for the answer, too, however busy the machine
  start(config);
  RawWebSocket socket = greeted();
  EXPECT_EQ(socket.read_frame().opcode, RawWebSocket::kPing);
  socket.send(RawWebSocket::kPong, "");
  EXPECT_EQ(socket.read_frame().opcode, RawWebSocket::kPing);
  EXPECT_TRUE(socket.socket.closed_within(milliseconds(10'000)));
}

TEST_F(WebSocketTest, AClientThatNeverGreetsIsSentAway) {
  ServerConfig config;
  config.hello = milliseconds(50);
  start(config);
  RawWebSocket socket(port_);
  EXPECT_TRUE(socket.socket.closed_within(milliseconds(10'000)));
}

TEST_F(WebSocketTest, AClientThatReadsNothingHasNothingMoreDrawn) {
  ServerConfig config;
  config.requests.outgoing_bytes = 500'000;
  config.stall = milliseconds(300);
  start(config);
  RawWebSocket socket = greeted(/*receive_buffer=*/4096);
  for (uint64_t id = 1; id <= 60; ++id) {
    socket.send(RawWebSocket::kBinary, encoded(id, picture_request("noise", 500, 500)));
  }
  EXPECT_TRUE(eventually([this] { return metric("surfcast_connections_open") == 1; }));
  EXPECT_LT(control_->drawn, 30);
}

TEST_F(WebSocketTest, AStoppingServerSaysGoodbye) {
  start();
  RawWebSocket socket = greeted();
  server_->stop();
  EXPECT_EQ(socket.read_close(), 1001u);
  socket.send(RawWebSocket::kClose, "\x03\xe9");
  EXPECT_TRUE(socket.socket.closed_within(milliseconds(5000)));
}

TEST_F(WebSocketTest, AStoppingServerFinishesWhatIsOutstanding) {
  start();
  control_->slow = true;
  RawWebSocket socket = greeted();
  socket.send(RawWebSocket::kBinary, encoded(1, picture_request("cube")));
  ASSERT_TRUE(eventually([this] { return control_->drawn == 1; }));
  server_->stop();
  control_->slow = false;
  EXPECT_TRUE(decoded(socket.read_message()).has_picture());
  EXPECT_EQ(socket.read_close(), 1001u);
}

}  // namespace
}  // namespace surfcast::net
