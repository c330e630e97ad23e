#include "protocol/framed.h"

#include <random>
#include <set>
#include <vector>

#include "net/net_fixture.h"
#include "protocol/framing.h"
#include "protocol/hello.h"

namespace surfcast::net {
namespace {

class FramedSessionTest : public NetFixture {};

std::string bytes_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string hello_bytes() {
  return bytes_of(protocol::encode_hello(protocol::make_hello("test")));
}

/// Bytes of the hello at the beginning of what a server has said.
size_t said_by_hello(const std::string& said) {
  const auto head = std::as_bytes(std::span(said)).first<protocol::kHelloHeaderBytes>();
  return head.size() + *protocol::hello_text_bytes(head);
}

std::string frame_of(const google::protobuf::MessageLite& message) {
  return bytes_of(protocol::framed(message));
}

TEST_F(FramedSessionTest, ModelsAreListed) {
  start();
  auto connection = connect();
  ASSERT_TRUE(connection);
  wire::Request request;
  request.mutable_list_models();
  const auto answer = connection->ask(request);
  ASSERT_TRUE(answer);
  ASSERT_EQ(answer->model_list().models_size(), 2);
  EXPECT_EQ(answer->model_list().models(0), "cube");
}

TEST_F(FramedSessionTest, AModelIsDescribed) {
  start();
  auto connection = connect();
  ASSERT_TRUE(connection);
  wire::Request request;
  request.mutable_describe_model()->set_model("teapot");
  const auto answer = connection->ask(request);
  ASSERT_TRUE(answer);
  const wire::ModelDescription& model = answer->model_description();
  EXPECT_EQ(model.model(), "teapot");
  EXPECT_EQ(model.surfels(), 1234u);
  EXPECT_EQ(model.bounds().max().y(), 5);
  EXPECT_FALSE(model.z_up());
  EXPECT_EQ(model.attributes(0), "intensity");
  EXPECT_EQ(model.spacing(), 0.25);
  EXPECT_EQ(model.ranges(0).low(), 2);
  EXPECT_EQ(model.classes(0).code(), 2u);
}

TEST_F(FramedSessionTest, PicksAreAnsweredOrSayWhyNot) {
  start();
  auto connection = connect();
  ASSERT_TRUE(connection);
  wire::Request request;
  request.mutable_pick_surfel()->mutable_picture()->set_model("cube");
  EXPECT_EQ(connection->ask(request).error().kind, ErrorKind::kNotFound) << "fake models have no surfels";
  request.mutable_pick_surfel()->set_x(100000);
  EXPECT_EQ(connection->ask(request).error().kind, ErrorKind::kInvalidInput);
  request.mutable_pick_surfel()->mutable_picture()->add_hidden_classes(256);
  EXPECT_EQ(connection->ask(request).error().kind, ErrorKind::kInvalidInput);
}

TEST_F(FramedSessionTest, APictureComesWithWhatItShows) {
  start();
  auto connection = connect();
  ASSERT_TRUE(connection);
  wire::Request request = picture_request("cube", 16, 9);
  wire::Camera* camera = request.mutable_draw_picture()->mutable_camera();
  camera->mutable_position()->set_x(5);
  camera->mutable_focal_point()->set_z(2);
  request.mutable_draw_picture()->set_spacing(1.5);
  request.mutable_draw_picture()->set_normalization(wire::NORMALIZATION_SURFEL);
  const auto answer = connection->ask(request);
  ASSERT_TRUE(answer);
  const wire::Picture& picture = answer->picture();
  EXPECT_EQ(picture.data().substr(1, 3), "PNG");
  EXPECT_EQ(picture.resolution().width(), 16u);
  EXPECT_EQ(picture.resolution().height(), 9u);
  EXPECT_EQ(picture.camera().position().x(), 5);
  EXPECT_EQ(picture.camera().view_up().z(), 1);
  EXPECT_EQ(picture.camera().view_angle(), 30);
  EXPECT_EQ(picture.spacing(), 1.5);
  EXPECT_EQ(picture.normalization(), wire::NORMALIZATION_SURFEL);
  EXPECT_TRUE(picture.converged());
  EXPECT_EQ(picture.surfels_drawn(), 99u);
  EXPECT_EQ(picture.blocks_drawn(), 5u);
  EXPECT_EQ(picture.gl_renderer(), "fake");
  ASSERT_EQ(picture.stages_size(), 3);
  EXPECT_EQ(picture.stages(0).name(), "queue");
}

TEST_F(FramedSessionTest, ErrorsKeepTheirKind) {
  start();
  auto connection = connect();
  ASSERT_TRUE(connection);
  EXPECT_EQ(connection->ask(picture_request("absent")).error().kind, ErrorKind::kNotFound);
  EXPECT_EQ(connection->ask(picture_request("cube", 9000, 1)).error().kind, ErrorKind::kLimit);
  EXPECT_EQ(connection->ask(picture_request("cube", 0, 1)).error().kind, ErrorKind::kInvalidInput);
  EXPECT_EQ(connection->ask(picture_request("cube", 4'000'000'000, 4'000'000'000)).error().kind, ErrorKind::kLimit);
  EXPECT_EQ(connection->ask(wire::Request()).error().kind, ErrorKind::kUnsupported);
  wire::Request request;
  request.mutable_describe_model()->set_model("absent");
  EXPECT_EQ(connection->ask(request).error().kind, ErrorKind::kNotFound);
  EXPECT_TRUE(connection->ask(ping_request()));  // none of this ends the connection
}

TEST_F(FramedSessionTest, PipelinedRequestsAreAllAnswered) {
  start();
  auto connection = connect();
  ASSERT_TRUE(connection);
  std::set<uint64_t> ids;
  for (int i = 0; i < 40; ++i) {
    const auto id = connection->send(picture_request("cube"));
    ASSERT_TRUE(id);
    ids.insert(*id);
  }
  while (!ids.empty()) {
    const auto answer = connection->receive();
    ASSERT_TRUE(answer);
    EXPECT_TRUE(answer->has_picture());
    ASSERT_EQ(ids.erase(answer->id()), 1u);
  }
}

TEST_F(FramedSessionTest, APingIsAnsweredWhileAPictureIsDrawn) {
  control_->slow = true;
  start();
  auto connection = connect();
  ASSERT_TRUE(connection);
  ASSERT_TRUE(connection->send(picture_request("cube")));
  EXPECT_TRUE(connection->ask(ping_request()));
  control_->slow = false;
}

TEST_F(FramedSessionTest, ACancelledPictureIsGivenUpAndAnswered) {
  control_->slow = true;
  start();
  auto connection = connect();
  ASSERT_TRUE(connection);
  const auto drawn = connection->send(picture_request("cube"));
  ASSERT_TRUE(drawn && eventually([&] { return control_->drawn == 1; }));
  wire::Request cancel;
  cancel.mutable_cancel()->set_request_id(*drawn);
  const auto cancelled = connection->send(cancel);
  ASSERT_TRUE(cancelled);
  for (int i = 0; i < 2; ++i) {
    const auto answer = connection->receive();
    ASSERT_TRUE(answer);
    if (answer->id() == *drawn) {
      EXPECT_EQ(protocol::from_wire(answer->error()).kind, ErrorKind::kCancelled);
    } else {
      EXPECT_EQ(answer->id(), *cancelled);
      EXPECT_TRUE(answer->cancel_result().was_outstanding());
    }
  }
  EXPECT_EQ(control_->cancelled, 1);
}

TEST_F(FramedSessionTest, APictureThatStillWaitsIsCancelledWithoutBeingDrawn) {
  control_->slow = true;
  ServerConfig config;
  config.requests.drawing = 1;
  start(config);
  auto connection = connect();
  ASSERT_TRUE(connection);
  const auto first = connection->send(picture_request("cube"));
  const auto second = connection->send(picture_request("teapot"));
  wire::Request cancel;
  cancel.mutable_cancel()->set_request_id(*second);
  const auto outcome = connection->send(cancel);
  const auto answer = connection->receive();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->id(), *second);
  EXPECT_EQ(protocol::from_wire(answer->error()).kind, ErrorKind::kCancelled);
  control_->slow = false;
  ASSERT_TRUE(connection->receive());
  ASSERT_TRUE(connection->receive());
  EXPECT_EQ(control_->order, std::vector<std::string>{"cube"});
}

TEST_F(FramedSessionTest, CancellingWhatIsNotOutstandingSaysSo) {
  start();
  auto connection = connect();
  ASSERT_TRUE(connection);
  wire::Request cancel;
  cancel.mutable_cancel()->set_request_id(12345);
  const auto answer = connection->ask(cancel);
  ASSERT_TRUE(answer);
  EXPECT_FALSE(answer->cancel_result().was_outstanding());
}

TEST_F(FramedSessionTest, TooManyOutstandingRequestsAreRefusedAsBusy) {
  control_->slow = true;
  ServerConfig config;
  config.requests.outstanding = 3;
  start(config);
  auto connection = connect();
  ASSERT_TRUE(connection);
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(connection->send(picture_request("cube")));
  const auto refusal = connection->receive();
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->id(), 4u);
  EXPECT_EQ(protocol::from_wire(refusal->error()).kind, ErrorKind::kUnavailable);
  control_->slow = false;
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(connection->receive()->has_picture());
}

TEST_F(FramedSessionTest, AnIdThatIsStillOutstandingIsRefused) {
  control_->slow = true;
  start();
  RawSocket socket(port_);
  wire::Request request = picture_request("cube");
  request.set_id(9);
  socket.send(hello_bytes() + frame_of(request) + frame_of(request));
  protocol::FrameSplitter splitter(protocol::kMaxAnswerBytes);
  socket.read_exactly(protocol::encode_hello(protocol::make_hello("surfcastd")).size());
  const std::string header = socket.read_exactly(protocol::kFrameHeaderBytes);
  const std::string content = socket.read_exactly(static_cast<unsigned char>(header.at(0)));
  wire::Answer answer;
  ASSERT_TRUE(answer.ParseFromString(content));
  EXPECT_EQ(answer.id(), 9u);
  EXPECT_EQ(protocol::from_wire(answer.error()).kind, ErrorKind::kInvalidInput);
  control_->slow = false;
}

TEST_F(FramedSessionTest, AClientThatVanishesHasItsPicturesCancelled) {
  for (const bool reset : {false, true}) {
    control_->slow = true;
    const int cancelled = control_->cancelled;
    const int drawn = control_->drawn;
    start();
    RawSocket socket(port_);
    socket.send(hello_bytes() + frame_of(picture_request("cube")));
    ASSERT_TRUE(eventually([&] { return control_->drawn == drawn + 1; }));
    reset ? socket.reset() : socket.close();
    EXPECT_TRUE(eventually([&] { return control_->cancelled == cancelled + 1; }));
    stop();
  }
}

TEST_F(FramedSessionTest, FiftyClientsAtOnceAreAllServed) {
  start();
  std::atomic<int> served = 0;
  {
    std::vector<std::jthread> clients;
    for (int client = 0; client < 50; ++client) {
      clients.emplace_back([&] {
        auto connection = connect();
        for (int i = 0; connection && i < 4; ++i) {
          const auto answer = connection->ask(picture_request("cube", 64, 64));
          if (answer && answer->has_picture()) ++served;
        }
      });
    }
  }
  EXPECT_EQ(served, 200);
  EXPECT_TRUE(eventually([&] { return metric("surfcast_connections_open") == 1; }));
}

TEST_F(FramedSessionTest, AReaderThatNeverReadsCostsOnlyItself) {
  constexpr int kRequests = 40;
  ServerConfig config;
  config.requests.outgoing_bytes = 2'000'000;
  config.stall = milliseconds(400);
  start(config);
  RawSocket sleeper(port_, 4096);
  std::string words = hello_bytes();
  for (int id = 1; id <= kRequests; ++id) {
    wire::Request request = picture_request("noise", 512, 512);
    request.set_id(id);
    words += frame_of(request);
  }
  ASSERT_TRUE(sleeper.send(words)) << "at once: the server ends the connection after a while";
  auto connection = connect();
  ASSERT_TRUE(connection);
  EXPECT_TRUE(connection->ask(picture_request("teapot")));
  // Nobody takes the sleeper's answers: its connection ends, and what it waited for is not drawn.
  EXPECT_TRUE(eventually([&] { return metric("surfcast_connections_open") == 2; }));
  EXPECT_LT(control_->drawn, kRequests);
}

TEST_F(FramedSessionTest, AFrameBeyondTheLimitEndsTheConnectionWithAnError) {
  start();
  RawSocket socket(port_);
  socket.send(hello_bytes() + std::string("\xff\xff\xff\xff", 4) + "and whatever follows");
  const std::string answer = socket.read_to_end();
  EXPECT_NE(answer.find("4294967295 bytes"), std::string::npos);
}

TEST_F(FramedSessionTest, AMessageThatIsNotOneEndsTheConnectionWithAnError) {
  start();
  RawSocket socket(port_);
  socket.send(hello_bytes() + std::string("\x03\0\0\0\xff\xff\xff", 7));
  EXPECT_NE(socket.read_to_end().find("cannot be decoded"), std::string::npos);
}

TEST_F(FramedSessionTest, GarbageAfterTheHelloNeverHurtsTheServer) {
  start();
  std::mt19937 random(7);
  for (int round = 0; round < 40; ++round) {
    RawSocket socket(port_);
    std::string garbage(random() % 5000, '\0');
    for (char& c : garbage) c = static_cast<char>(random());
    socket.send(hello_bytes() + garbage);
    socket.close();
  }
  auto connection = connect();
  ASSERT_TRUE(connection);
  EXPECT_TRUE(connection->ask(ping_request()));
}

TEST_F(FramedSessionTest, ClientsOfAnotherMajorVersionAreToldWhy) {
  start();
  protocol::Hello old = protocol::make_hello("ancient");
  old.version = {0, 9};
  RawSocket socket(port_);
  // What an old client sends right behind its hello must not keep it from reading the refusal.
  socket.send(bytes_of(protocol::encode_hello(old)) + frame_of(picture_request("cube")));
  const std::string bytes = socket.read_to_end();
  const Result<protocol::Hello> refusal = protocol::decode_hello(std::as_bytes(std::span(bytes)));
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->status, protocol::HelloStatus::kVersionRefused);
  EXPECT_NE(refusal->message.find("0.9"), std::string::npos);
  EXPECT_NE(refusal->message.find(" 1.11"), std::string::npos);
}

TEST_F(FramedSessionTest, AClientOfALaterMinorVersionIsWelcome) {
  start();
  protocol::Hello later = protocol::make_hello("later");
  later.version.minor = 77;
  RawSocket socket(port_);
  socket.send(protocol::encode_hello(later));
  const std::string bytes = socket.read_exactly(protocol::kHelloHeaderBytes);
  EXPECT_EQ(bytes[12], 0);
}

TEST_F(FramedSessionTest, EveryHelloThatIsCutShortEndsInTheTimeForHellos) {
  ServerConfig config;
  config.hello = milliseconds(100);
  start(config);
  const std::string hello = hello_bytes();
  for (const size_t length : {size_t{1}, size_t{8}, size_t{17}, hello.size() - 1}) {
    RawSocket socket(port_);
    socket.send(hello.substr(0, length));
    EXPECT_TRUE(socket.closed_within(milliseconds(5000))) << length;
  }
}

TEST_F(FramedSessionTest, AConnectionThatNeverSpeaksIsClosed) {
  ServerConfig config;
  config.hello = milliseconds(100);
  start(config);
  RawSocket socket(port_);
  EXPECT_TRUE(socket.closed_within(milliseconds(5000)));
}

TEST_F(FramedSessionTest, ASlowLorisIsClosedThoughItSendsAByteNowAndThen) {
  ServerConfig config;
  config.idle = milliseconds(200);
  start(config);
  RawSocket socket(port_);
  socket.send(hello_bytes() + std::string("\x40\0\0\0", 4));
  bool open = true;
  for (int i = 0; i < 500 && open; ++i) {
    std::this_thread::sleep_for(milliseconds(20));
    open = socket.send("x");
  }
  EXPECT_FALSE(open);
}

TEST_F(FramedSessionTest, AConnectionThatWaitsForAPictureIsNotIdle) {
  control_->slow = true;
  ServerConfig config;
  config.idle = milliseconds(300);
  start(config);
  RawSocket socket(port_);
  ASSERT_TRUE(socket.send(hello_bytes() + frame_of(picture_request("cube")))) << "at once, so that it is never idle";
  ASSERT_TRUE(eventually([&] { return control_->drawn == 1; }));
  for (int i = 0; i < 3; ++i) {
    RawSocket idle(port_);
    idle.send(hello_bytes());
    ASSERT_TRUE(idle.closed_within(milliseconds(10'000))) << "the time of idle connections passes";
  }
  control_->slow = false;
  const std::string said = socket.read_to_end();
  ASSERT_GE(said.size(), protocol::kHelloHeaderBytes);
  protocol::FrameSplitter splitter(protocol::kMaxAnswerBytes);
  splitter.append(std::as_bytes(std::span(said)).subspan(said_by_hello(said)));
  const auto frame = splitter.next();
  ASSERT_TRUE(frame && frame->has_value());
  wire::Answer answer;
  ASSERT_TRUE(protocol::decode_message(**frame, answer));
  EXPECT_TRUE(answer.has_picture());
}

TEST_F(FramedSessionTest, ConnectionsBeyondTheLimitAreToldThatTheServerIsBusy) {
  ServerConfig config;
  config.clients.connections = 1;
  start(config);
  auto first = connect();
  ASSERT_TRUE(first);
  const auto second = connect();
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, ErrorKind::kUnavailable);
  EXPECT_NE(second.error().message.find("too many connections"), std::string::npos);
  EXPECT_NE(get("/api/models").find("503"), std::string::npos);
  EXPECT_TRUE(first->ask(ping_request()));
}

}  // namespace
}  // namespace surfcast::net
