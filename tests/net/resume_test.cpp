#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/view.h"
#include "net/net_fixture.h"

namespace surfcast::net {
namespace {

using client::ServerConnection;

/// Clients that come back, over both transports.
class ResumeTest : public NetFixture, public ::testing::WithParamInterface<bool> {
 protected:
  [[nodiscard]] ServerConnection connected() const {
    return std::move(*ServerConnection::open({.host = "127.0.0.1", .port = port_, .websocket = GetParam()},
                                             {.connect = milliseconds(10'000), .answer = milliseconds(20'000)}));
  }
  static wire::Resumed resume(ServerConnection& connection, const std::string& session) {
    const auto resumed = connection.resume(session);
    return resumed ? *resumed : wire::Resumed();
  }
  static wire::DrawPicture picture(uint32_t width = 32) {
    wire::DrawPicture picture = picture_request("cube", width, 16).draw_picture();
    picture.mutable_camera()->mutable_position()->set_z(5);
    picture.mutable_camera()->mutable_focal_point();
    picture.mutable_camera()->mutable_view_up()->set_y(1);
    return picture;
  }
  static uint64_t open_view(ServerConnection& connection) {
    wire::Request request;
    *request.mutable_open_view()->mutable_picture() = picture();
    return *connection.send(std::move(request));
  }
  static void update_view(ServerConnection& connection, uint64_t view, uint64_t number, uint32_t width) {
    wire::Request request;
    request.mutable_update_view()->set_update(number);
    *request.mutable_update_view()->mutable_picture() = picture(width);
    ASSERT_TRUE(connection.send_as(view, std::move(request)));
  }
  /// The first message of a view that shows an update, or of any if none is named.
  static std::optional<wire::ViewFrame> frame_of(ServerConnection& connection, uint64_t view, uint64_t update = 0) {
    for (;;) {
      const auto answer = connection.receive();
      if (!answer) return std::nullopt;
      if (answer->has_error() && answer->id() == view) ADD_FAILURE() << answer->error().message();
      if (answer->id() != view || !answer->has_view_frame()) continue;
      if (answer->view_frame().update() >= update) return answer->view_frame();
      wire::Request painted;
      painted.mutable_frame_painted()->set_frame(answer->view_frame().frame());
      if (!connection.send_as(view, std::move(painted))) return std::nullopt;
    }
  }
};

INSTANTIATE_TEST_SUITE_P(Transports, ResumeTest, ::testing::Bool(),
                         [](const auto& test) { return test.param ? "WebSocket" : "Framed"; });

TEST_P(ResumeTest, AViewIsOpenAgainAfterItsConnectionIsGone) {
  start();
  std::string session;
  uint64_t view = 0;
  {
    ServerConnection first = connected();
    session = resume(first, "").session();
    view = open_view(first);
    update_view(first, view, 5, 24);
    ASSERT_TRUE(frame_of(first, view, 5));
  }
  ASSERT_TRUE(eventually([&] { return metric("surfcast_sessions_waiting") == 1; }));
  EXPECT_EQ(metric("surfcast_views_open"), 0) << "a view that waits is not drawn";
  ServerConnection second = connected();
  const wire::Resumed resumed = resume(second, session);
  ASSERT_EQ(resumed.views_size(), 1);
  EXPECT_EQ(resumed.views(0), view);
  EXPECT_NE(resumed.session(), session) << "a secret is good for one time";
  const auto frame = frame_of(second, view);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->frame(), 1U);
  EXPECT_EQ(frame->update(), 5U);
  EXPECT_EQ(frame->resolution().width(), 24U);
}

TEST_P(ResumeTest, AClientThatComesBackBeforeItsConnectionIsMissedTakesItsViewsAlong) {
  start();
  ServerConnection first = connected();
  const std::string session = resume(first, "").session();
  const uint64_t view = open_view(first);
  ASSERT_TRUE(frame_of(first, view));
  ServerConnection second = connected();
  EXPECT_EQ(resume(second, session).views_size(), 1);
  EXPECT_TRUE(frame_of(second, view));
  EXPECT_FALSE(frame_of(first, view, 1000)) << "the former connection ends";
  EXPECT_EQ(metric("surfcast_views_open"), 1);
}

TEST_P(ResumeTest, AViewOfTheClientGoesOnWhereItWas) {
  start();
  std::string session;
  std::optional<client::View> view;
  {
    ServerConnection first = connected();
    session = resume(first, "").session();
    view.emplace(*client::View::open(first, picture(), {}));
    ASSERT_EQ(view->show(picture(16), false).value_or(0), 1U);
    ASSERT_TRUE(first.ask(ping_request()));
  }
  ServerConnection second = connected();
  ASSERT_EQ(resume(second, session).views_size(), 1);
  view->go_on(second);
  const auto frame = view->next_until(client::View::Clock::now() + std::chrono::seconds(20));
  ASSERT_TRUE(frame && frame->has_value());
  EXPECT_EQ((*frame)->frame.update(), 1U);
  EXPECT_EQ(view->show(picture(24), false).value_or(0), 2U);
  const auto pong = second.ask(ping_request());
  ASSERT_TRUE(pong);
  EXPECT_GT(pong->id(), view->id());
}

TEST_P(ResumeTest, AViewThatWasClosedStaysClosed) {
  start();
  std::string session;
  {
    ServerConnection first = connected();
    session = resume(first, "").session();
    wire::Request close;
    close.mutable_close_view()->set_view(open_view(first));
    ASSERT_TRUE(first.ask(std::move(close)));
  }
  ASSERT_TRUE(eventually([&] { return metric("surfcast_connections_open") == 1; }));
  EXPECT_EQ(metric("surfcast_sessions_waiting"), 0);
  ServerConnection second = connected();
  EXPECT_EQ(resume(second, session).views_size(), 0);
}

TEST_P(ResumeTest, ASessionThatIsNotKnownIsANewOne) {
  start();
  ServerConnection connection = connected();
  const wire::Resumed resumed = resume(connection, "of another server");
  EXPECT_EQ(resumed.views_size(), 0);
  EXPECT_EQ(resumed.session().size(), 43U);
  EXPECT_EQ(resumed.seconds(), 180);
  EXPECT_TRUE(frame_of(connection, open_view(connection)));
}

TEST_P(ResumeTest, WithoutASessionNothingWaits) {
  start();
  {
    ServerConnection first = connected();
    ASSERT_TRUE(frame_of(first, open_view(first)));
  }
  ASSERT_TRUE(eventually([&] { return metric("surfcast_views_open") == 0; }));
  EXPECT_EQ(metric("surfcast_sessions_waiting"), 0);
}

TEST_P(ResumeTest, AServerThatStopsSendsClientsWithViewsAwayOneAfterTheOther) {
  ServerConfig config;
  config.leave = milliseconds(120'000);
  start(config);
  std::vector<ServerConnection> clients;
  for (int i = 0; i < 2; ++i) {
    clients.push_back(connected());
    ASSERT_TRUE(frame_of(clients.back(), open_view(clients.back())));
  }
  ServerConnection idle = connected();
  server_->stop();
  EXPECT_FALSE(frame_of(clients[0], 1, 1000)) << "the first one is to go at once";
  EXPECT_FALSE(RawSocket(port_).connected()) << "and to come back elsewhere";
  EXPECT_TRUE(clients[1].ask(ping_request())) << "the second one is still served";
  server_->stop();
  EXPECT_FALSE(frame_of(clients[1], 1, 1000));
}

}  // namespace
}  // namespace surfcast::net
