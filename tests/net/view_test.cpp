#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "net/net_fixture.h"
#include "support/link_relay.h"

namespace surfcast::net {
namespace {

/// A client with one view open, which answers every message of it at once unless it is told not to.
class ViewSessionTest : public NetFixture {
 protected:
  void open_view(const std::string& model = "cube", uint32_t width = 64, uint32_t height = 32, bool depth = false,
                 bool video = false, uint16_t port = 0) {
    auto connection = port == 0 ? connect() : client::ServerConnection::open({.host = "127.0.0.1", .port = port}, {});
    ASSERT_TRUE(connection);
    connection_.emplace(std::move(*connection));
    wire::Request request;
    *request.mutable_open_view()->mutable_picture() = picture(model, 0, width, height);
    request.mutable_open_view()->set_depth(depth);
    if (video) request.mutable_open_view()->add_video(wire::VIDEO_CODEC_VP9);
    const auto id = connection_->send(request);
    ASSERT_TRUE(id);
    view_ = *id;
  }

  static wire::DrawPicture picture(const std::string& model, double x, uint32_t width = 64, uint32_t height = 32) {
    wire::DrawPicture picture = picture_request(model, width, height).draw_picture();
    picture.mutable_camera()->mutable_position()->set_x(x);
    picture.mutable_camera()->mutable_position()->set_z(5);
    picture.mutable_camera()->mutable_focal_point();
    picture.mutable_camera()->mutable_view_up()->set_y(1);
    return picture;
  }

  void update(uint64_t number, const wire::DrawPicture& picture, bool moving) {
    wire::Request request;
    request.mutable_update_view()->set_update(number);
    *request.mutable_update_view()->mutable_picture() = picture;
    request.mutable_update_view()->set_moving(moving);
    ASSERT_TRUE(connection_->send_as(view_, request));
  }

  void acknowledge(uint64_t frame) {
    wire::Request request;
    request.mutable_frame_painted()->set_frame(frame);
    ASSERT_TRUE(connection_->send_as(view_, request));
  }

  /// The next whole frame, its pieces answered.
  wire::ViewFrame next_frame() {
    wire::ViewFrame frame;
    for (;;) {
      const auto answer = connection_->receive();
      if (!answer || !answer->has_view_frame()) {
        ADD_FAILURE() << (answer ? answer->error().message() : answer.error().message);
        return frame;
      }
      EXPECT_EQ(answer->id(), view_);
      const wire::ViewFrame& piece = answer->view_frame();
      acknowledge(piece.frame());
      if (piece.frame() == frame.frame()) {
        frame.mutable_picture()->mutable_data()->append(piece.picture().data());
      } else {
        frame = piece;
      }
      if (!piece.more()) return frame;
    }
  }

  wire::ViewFrame converged_frame() {
    wire::ViewFrame frame = next_frame();
    while (!frame.picture().converged() && !HasFailure()) frame = next_frame();
    return frame;
  }

  std::optional<client::ServerConnection> connection_;
  uint64_t view_ = 0;
};

TEST_F(ViewSessionTest, AViewAtRestEndsWithTheAnswerToItsPictureAndThenFallsSilent) {
  start();
  open_view("noise", 320, 200);
  std::vector<wire::ViewFrame> frames;
  do {
    frames.push_back(next_frame());
  } while (!frames.back().picture().converged() && !HasFailure());
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(control_->drawn, 2) << "the last frame has the pixels of the one before";
  EXPECT_TRUE(frames[0].moving());
  EXPECT_EQ(frames[0].picture().format(), wire::FILE_FORMAT_JPEG);
  EXPECT_EQ(frames[0].picture().normalization(), wire::NORMALIZATION_SURFEL);
  EXPECT_LT(frames[0].picture().resolution().width(), 320u);
  EXPECT_EQ(frames[0].resolution().width(), 320u);
  EXPECT_FALSE(frames[1].moving());
  EXPECT_EQ(frames[1].picture().format(), wire::FILE_FORMAT_JPEG);
  EXPECT_EQ(frames[1].picture().resolution().width(), 320u);
  EXPECT_EQ(frames[2].picture().format(), wire::FILE_FORMAT_PNG);

  wire::Request request;
  *request.mutable_draw_picture() = picture("noise", 0, 320, 200);
  const auto answer = connection_->ask(request);
  ASSERT_TRUE(answer) << "what comes next is this picture and no frame";
  EXPECT_EQ(answer->picture().data(), frames[2].picture().data());
}

TEST_F(ViewSessionTest, FramesHaveTheirDepthWhereTheViewAsksForIt) {
  start();
  open_view("noise", 320, 200, /*depth=*/true);
  wire::ViewFrame frame;
  do {
    frame = next_frame();
    const wire::Resolution& size = frame.picture().resolution();
    const wire::DepthPlane& depth = frame.depth();
    ASSERT_GT(depth.cell(), 0U);
    EXPECT_EQ(depth.width(), (size.width() + depth.cell() - 1) / depth.cell());
    EXPECT_EQ(depth.height(), (size.height() + depth.cell() - 1) / depth.cell());
    EXPECT_LE(depth.width(), frame.moving() ? 80U : 160U);
    EXPECT_FLOAT_EQ(static_cast<float>(depth.first()), 0.25F);
    EXPECT_FLOAT_EQ(static_cast<float>(depth.last()), 0.5F);
    EXPECT_FALSE(depth.codes().empty());
  } while (!frame.picture().converged() && !HasFailure());

  wire::Request request;
  *request.mutable_draw_picture() = picture("noise", 0, 320, 200);
  const auto answer = connection_->ask(request);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->picture().data(), frame.picture().data()) << "depth stands beside the picture";
}

/// The view moves until a frame shows a later camera than its update, or for this many updates.
TEST_F(ViewSessionTest, FramesInMotionAreDrawnAheadWhereTheClientCanWarpThem) {
  start();
  for (const auto& [model, updates] : {std::pair<std::string, uint64_t>{"cube", 400}, {"teapot", 40}}) {
    open_view(model, 64, 32, /*depth=*/true);
    converged_frame();
    bool ahead = false;
    for (uint64_t i = 1; i <= updates && !ahead && !HasFailure(); ++i) {
      update(i, picture(model, 0.1 * static_cast<double>(i)), /*moving=*/true);
      const wire::ViewFrame frame = next_frame();
      const double x = frame.picture().camera().position().x();
      EXPECT_GE(x, 0.1 * static_cast<double>(frame.update()) - 1e-9);
      ahead = x > 0.1 * static_cast<double>(frame.update()) + 1e-9;
    }
    EXPECT_EQ(ahead, model == "cube");
  }
}

TEST_F(ViewSessionTest, FramesHaveNoDepthWhereTheViewDoesNotAskForIt) {
  start();
  open_view("noise", 320, 200);
  wire::ViewFrame frame;
  do {
    frame = next_frame();
    EXPECT_FALSE(frame.has_depth());
  } while (!frame.picture().converged() && !HasFailure());
}

/// Moves a view of noise over a link of 1 Mbit/s. Over it a frame of noise takes seconds as a file.
class ThinLinkTest : public ViewSessionTest {
 protected:
  std::vector<wire::ViewFrame> move(bool video, size_t frames) {
    start();
    const testing::LinkRelay relay(port_, {.bits_per_second = 1e6});
    open_view("noise", 320, 200, /*depth=*/false, video, relay.port());
    std::vector<wire::ViewFrame> received;
    for (uint64_t i = 1; received.size() < frames && !HasFailure(); ++i) {
      update(i, picture("noise", static_cast<double>(i), 320, 200), /*moving=*/true);
      received.push_back(next_frame());
    }
    return received;
  }
};

TEST_F(ThinLinkTest, FramesInMotionArePacketsForWhoDecodesThem) {
  const std::vector<wire::ViewFrame> frames = move(/*video=*/true, 30);
  uint64_t last = 0, before = 0;  // the packet and the frame before
  size_t packets = 0, keys = 0;
  for (const wire::ViewFrame& frame : frames) {
    const bool next = frame.frame() == std::exchange(before, frame.frame()) + 1;
    if (!frame.has_video()) continue;
    EXPECT_EQ(frame.video().codec(), wire::VIDEO_CODEC_VP9);
    // A busy machine may drop a packet that a newer update has outdated. The next one is a key frame then.
    const bool key = frame.video().key();
    EXPECT_EQ(frame.video().refers_to(), key ? 0 : last);
    EXPECT_TRUE(key || last != 0) << "the first packet refers to another";
    EXPECT_FALSE(key && last != 0 && next) << "no packet is missing";
    EXPECT_TRUE(frame.moving());
    last = frame.frame();
    ++packets;
    if (key) ++keys;
  }
  EXPECT_GT(packets, 10U);
  EXPECT_LT(keys, packets / 2);
}

TEST_F(ThinLinkTest, FramesAreFilesForWhoDidNotAskForVideo) {
  for (const wire::ViewFrame& frame : move(/*video=*/false, 30)) {
    EXPECT_FALSE(frame.has_video());
    EXPECT_EQ(frame.picture().data().substr(0, 2), "\xff\xd8") << "JPEG";
  }
}

TEST_F(ViewSessionTest, FramesRepeatTheNewestUpdateAndItsCamera) {
  start();
  open_view();
  converged_frame();
  update(7, picture("cube", 3), /*moving=*/false);
  const wire::ViewFrame frame = next_frame();
  EXPECT_EQ(frame.update(), 7u);
  EXPECT_EQ(frame.picture().camera().position().x(), 3);
  EXPECT_EQ(converged_frame().update(), 7u);
}

TEST_F(ViewSessionTest, AClientThatAnswersNothingGetsTwoFramesAndHoldsUpNobody) {
  start();
  open_view();
  for (uint64_t i = 1; i <= 50; ++i) {
    update(i, picture("cube", static_cast<double>(i)), /*moving=*/true);
    std::this_thread::sleep_for(milliseconds(2));  // so that a server that draws too much has time to do so
  }
  EXPECT_TRUE(eventually([this] { return metric("surfcast_view_updates_replaced_total") >= 45; }));
  EXPECT_TRUE(eventually([this] { return metric("surfcast_view_frames_total") == 2; }));
  std::this_thread::sleep_for(milliseconds(50));  // for a third one, which must not come
  EXPECT_EQ(metric("surfcast_view_frames_total"), 2);
  auto other = connect();
  ASSERT_TRUE(other);
  EXPECT_TRUE(other->ask(picture_request("teapot")));
}

TEST_F(ViewSessionTest, AnUpdateInterruptsWhatIsBeingRefined) {
  // Set before the view opens: a finer frame that is fast would be done before the update arrives.
  control_->slow_motion = false;
  control_->slow = true;
  start();
  open_view();
  next_frame();
  ASSERT_TRUE(eventually([&] { return control_->drawn == 2; })) << "the finer frame";
  update(1, picture("cube", 1), /*moving=*/false);
  EXPECT_EQ(next_frame().update(), 1u);
  EXPECT_TRUE(eventually([&] { return control_->cancelled == 1; }));
  control_->slow = false;
  EXPECT_EQ(converged_frame().update(), 1u);
}

TEST_F(ViewSessionTest, AnUpdateThatShowsTheSamePictureIsNotDrawnAgain) {
  start();
  open_view();
  converged_frame();
  const int drawn = control_->drawn;
  update(1, picture("cube", 0), /*moving=*/false);
  wire::Request ping = ping_request();
  ASSERT_TRUE(connection_->ask(ping)) << "what comes next is no frame";
  std::this_thread::sleep_for(milliseconds(20));  // for a picture that must not be drawn
  EXPECT_EQ(control_->drawn, drawn);
}

TEST_F(ViewSessionTest, AClosedViewSendsNothingMore) {
  start();
  open_view();
  wire::Request close;
  close.mutable_close_view()->set_view(view_);
  const auto id = connection_->send(close);
  ASSERT_TRUE(id);
  for (;;) {
    const auto answer = connection_->receive();
    ASSERT_TRUE(answer);
    if (answer->id() != *id) continue;
    EXPECT_TRUE(answer->has_view_closed());
    break;
  }
  EXPECT_TRUE(connection_->ask(ping_request()));
  EXPECT_EQ(metric("surfcast_views_open"), 0);
  const auto again = connection_->ask(close);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().kind, ErrorKind::kNotFound);
}

TEST_F(ViewSessionTest, AClientThatWarpsButAnswersNothingGetsTwoFrames) {
  start();
  open_view("cube", 64, 32, /*depth=*/true);
  for (uint64_t i = 1; i <= 50; ++i) {
    update(i, picture("cube", static_cast<double>(i)), /*moving=*/true);
    std::this_thread::sleep_for(milliseconds(2));  // so that a server that draws too much has time to do so
  }
  EXPECT_TRUE(eventually([this] { return metric("surfcast_view_updates_replaced_total") >= 45; }));
  EXPECT_TRUE(eventually([this] { return metric("surfcast_view_frames_total") == 2; }));
}

TEST_F(ViewSessionTest, AViewOfNoModelEndsWithTheReason) {
  start();
  open_view("nothing");
  const auto answer = connection_->receive();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->id(), view_);
  EXPECT_EQ(protocol::from_wire(answer->error()).kind, ErrorKind::kNotFound);
  EXPECT_TRUE(eventually([&] { return metric("surfcast_views_open") == 0; }));
}

TEST_F(ViewSessionTest, AWrongUpdateEndsTheView) {
  start();
  open_view();
  converged_frame();
  update(1, picture("teapot", 1), /*moving=*/false);
  const auto answer = connection_->receive();
  ASSERT_TRUE(answer);
  EXPECT_EQ(protocol::from_wire(answer->error()).kind, ErrorKind::kInvalidInput);
  update(2, picture("cube", 1), /*moving=*/false);
  EXPECT_TRUE(connection_->ask(ping_request())) << "messages of a view that is no more do not matter";
}

TEST_F(ViewSessionTest, AnUpdateWithChannelsEndsTheView) {
  start();
  open_view();
  converged_frame();
  wire::DrawPicture wanted = picture("cube", 1);
  wanted.set_format(wire::FILE_FORMAT_EXR);
  wanted.add_channels(wire::CHANNEL_DEPTH);
  update(1, wanted, /*moving=*/true);
  const auto answer = connection_->receive();
  ASSERT_TRUE(answer);
  EXPECT_EQ(protocol::from_wire(answer->error()).message, "channels: a view has none");
  EXPECT_TRUE(connection_->ask(ping_request()));
}

TEST_F(ViewSessionTest, ViewsBeyondTheLimitAreRefused) {
  ServerConfig config;
  config.views = 1;
  start(config);
  open_view();
  converged_frame();
  wire::Request request;
  *request.mutable_open_view()->mutable_picture() = picture("cube", 0);
  const auto second = connection_->ask(request);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, ErrorKind::kUnavailable);
}

TEST_F(ViewSessionTest, AFrameRateThatIsNoneIsRefused) {
  start();
  auto connection = connect();
  ASSERT_TRUE(connection);
  for (const double fps : {-1.0, 1e9, std::numeric_limits<double>::quiet_NaN()}) {
    wire::Request request;
    *request.mutable_open_view()->mutable_picture() = picture("cube", 0);
    request.mutable_open_view()->set_target_fps(fps);
    const auto answer = connection->ask(request);
    ASSERT_FALSE(answer);
    EXPECT_EQ(answer.error().kind, ErrorKind::kInvalidInput);
  }
}

TEST_F(ViewSessionTest, AViewOutlivesARushInWhichTheServerRefusesItsFrames) {
  control_->slow = true;
  start({}, {.queued_jobs = 1});
  auto crowd = connect();
  ASSERT_TRUE(crowd);
  ASSERT_TRUE(crowd->send(picture_request("cube")));
  ASSERT_TRUE(eventually([&] { return control_->drawn == 1; }));
  ASSERT_TRUE(crowd->send(picture_request("cube")));
  ASSERT_TRUE(eventually([&] { return service_->queued() == 1; }));
  open_view();
  ASSERT_TRUE(eventually([&] { return metric("surfcast_view_frames_dropped_total") > 0; })) << "it is refused";
  EXPECT_EQ(metric("surfcast_views_open"), 1);
  control_->slow = false;
  converged_frame();
}

TEST_F(ViewSessionTest, AViewWhoseClientVanishesIsForgotten) {
  start();
  open_view();
  next_frame();
  connection_.reset();
  EXPECT_TRUE(eventually([&] { return metric("surfcast_views_open") == 0; }));
}

TEST_F(ViewSessionTest, AServerThatStopsDoesNotWaitForViewsAtRest) {
  start();
  open_view();
  converged_frame();
  stop();
  EXPECT_FALSE(connection_->receive());
}

}  // namespace
}  // namespace surfcast::net
