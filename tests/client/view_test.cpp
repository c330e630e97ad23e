#include "client/view.h"

#include <chrono>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "client/jpeg_file.h"
#include "client/jpeg_scans.h"
#include "client/scripted_server.h"
#include "protocol/framed.h"
#include "protocol/framing.h"
#include "protocol/hello.h"

namespace surfcast::client {
namespace {

using std::chrono::milliseconds;

std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string hello() {
  return text_of(protocol::encode_hello(protocol::make_hello("test")));
}

std::string said(const wire::Answer& answer) {
  return text_of(protocol::framed(answer));
}

/// One message of the view that is opened first.
std::string piece(uint64_t frame, uint64_t update, const std::string& data, bool more) {
  wire::Answer answer;
  answer.set_id(1);
  wire::ViewFrame& view = *answer.mutable_view_frame();
  view.set_frame(frame);
  view.set_update(update);
  view.mutable_picture()->set_data(data);
  view.set_more(more);
  return said(answer);
}

std::string picked(uint64_t id, double x) {
  wire::Answer answer;
  answer.set_id(id);
  answer.mutable_pick_result()->set_hit(true);
  answer.mutable_pick_result()->mutable_position()->set_x(x);
  return said(answer);
}

std::string failure(uint64_t id) {
  wire::Answer answer;
  answer.set_id(id);
  answer.mutable_error()->set_code(wire::ERROR_CODE_NOT_FOUND);
  answer.mutable_error()->set_message("no such model");
  return said(answer);
}

/// The requests that a client sent after its hello.
std::vector<wire::Request> requests_in(const std::string& heard) {
  const size_t greeting = protocol::encode_hello(protocol::make_hello("surfcast")).size();
  protocol::FrameSplitter splitter(protocol::kMaxRequestBytes);
  splitter.append(std::as_bytes(std::span(heard).subspan(greeting)));
  std::vector<wire::Request> requests;
  for (auto next = splitter.next(); next && next->has_value(); next = splitter.next()) {
    EXPECT_TRUE(protocol::decode_message(**next, requests.emplace_back()));
  }
  return requests;
}

wire::DrawPicture picture() {
  wire::DrawPicture picture;
  picture.set_model("cube");
  return picture;
}

View::Clock::time_point soon() {
  return View::Clock::now() + milliseconds(5000);
}

/// A view of a server that says all of this at once.
class ViewTest : public ::testing::Test {
 protected:
  void open(const std::string& words, bool early = false) {
    server_ = std::make_unique<ScriptedServer>(hello() + words, /*stays=*/true);
    auto connection = ServerConnection::open(server_->endpoint(), {});
    ASSERT_TRUE(connection);
    connection_ = std::make_unique<ServerConnection>(std::move(*connection));
    auto view = View::open(*connection_, picture(), {.target_fps = 25, .early = early});
    ASSERT_TRUE(view);
    view_ = std::make_unique<View>(*view);
  }
  /// What the client said in all, hello left out.
  std::vector<wire::Request> said_by_client() {
    connection_.reset();
    return requests_in(server_->heard());
  }

  std::unique_ptr<ScriptedServer> server_;
  std::unique_ptr<ServerConnection> connection_;
  std::unique_ptr<View> view_;
};

TEST_F(ViewTest, AFrameIsPutTogetherAndEachPieceAcknowledgedOnce) {
  open(piece(1, 0, "lo", true) + piece(1, 0, "ssl", true) + piece(1, 0, "ess", false));
  const auto frame = view_->next_until(soon());
  ASSERT_TRUE(frame && *frame);
  EXPECT_EQ((*frame)->frame.picture().data(), "lossless");
  EXPECT_FALSE((*frame)->frame.more());
  ASSERT_TRUE(view_->painted(**frame));
  const auto requests = said_by_client();
  ASSERT_EQ(requests.size(), 4u);
  EXPECT_EQ(requests[0].open_view().target_fps(), 25);
  for (size_t i = 1; i < 4; ++i) {
    EXPECT_EQ(requests[i].id(), requests[0].id());
    EXPECT_EQ(requests[i].frame_painted().frame(), 1u);
  }
}

TEST_F(ViewTest, AFrameWhoseRestWasGivenUpIsDropped) {
  open(piece(1, 0, "half", true) + piece(2, 0, "newer", false));
  const auto frame = view_->next_until(soon());
  ASSERT_TRUE(frame && *frame);
  EXPECT_EQ((*frame)->frame.frame(), 2u);
  EXPECT_EQ((*frame)->frame.picture().data(), "newer");
  EXPECT_EQ(view_->abandoned(), 1u);
}

/// One message of a JPEG file.
std::string jpeg_piece(const std::string& data, bool more) {
  wire::Answer answer;
  answer.set_id(1);
  wire::ViewFrame& view = *answer.mutable_view_frame();
  view.set_frame(1);
  view.mutable_picture()->set_format(wire::FILE_FORMAT_JPEG);
  view.mutable_picture()->set_data(data);
  view.set_more(more);
  return said(answer);
}

TEST_F(ViewTest, WhatCanBeShownOfAFrameComesBeforeItIsWholeWhereThatIsWished) {
  const std::string file = jpeg_file(picture::JpegOrder::kScans);
  const size_t cut = file.size() * 4 / 5;
  const std::string words = jpeg_piece(file.substr(0, cut), true) + jpeg_piece(file.substr(cut), false);
  open(words, /*early=*/true);
  const auto early = view_->next_until(soon());
  ASSERT_TRUE(early && *early);
  EXPECT_FALSE((*early)->whole);
  EXPECT_FALSE((*early)->frame.more());
  const std::string& shown = (*early)->frame.picture().data();
  ASSERT_TRUE(shown.ends_with(kEndOfJpeg));
  EXPECT_TRUE(file.starts_with(shown.substr(0, shown.size() - kEndOfJpeg.size())));
  ASSERT_TRUE(view_->painted(**early));
  const auto frame = view_->next_until(soon());
  ASSERT_TRUE(frame && *frame);
  EXPECT_TRUE((*frame)->whole);
  EXPECT_EQ((*frame)->frame.picture().data(), file);
  ASSERT_TRUE(view_->painted(**frame));
  EXPECT_EQ(said_by_client().size(), 3U) << "the view, and one acknowledgement for each piece";
}

TEST_F(ViewTest, OnlyWholeFramesComeWithoutThatWish) {
  const std::string file = jpeg_file(picture::JpegOrder::kScans);
  open(jpeg_piece(file.substr(0, file.size() - 1), true) + jpeg_piece(file.substr(file.size() - 1), false));
  const auto frame = view_->next_until(soon());
  ASSERT_TRUE(frame && *frame);
  EXPECT_EQ((*frame)->frame.picture().data(), file);
}

TEST_F(ViewTest, UpdatesCarryTheViewsIdAndGrowingNumbers) {
  open("");
  EXPECT_EQ(*view_->show(picture(), true), 1u);
  EXPECT_EQ(*view_->show(picture(), false), 2u);
  const auto requests = said_by_client();
  ASSERT_EQ(requests.size(), 3u);
  EXPECT_EQ(requests[1].id(), requests[0].id());
  EXPECT_EQ(requests[1].update_view().update(), 1u);
  EXPECT_TRUE(requests[1].update_view().moving());
  EXPECT_EQ(requests[2].update_view().update(), 2u);
  EXPECT_FALSE(requests[2].update_view().moving());
}

TEST_F(ViewTest, OfSeveralPicksTheLastIsAnsweredOnceBesideTheFrames) {
  open(picked(2, 20) + picked(3, 30) + piece(1, 0, "one", false) + failure(3));
  ASSERT_TRUE(view_->pick(picture(), 7, 8));
  ASSERT_TRUE(view_->pick(picture(), 9, 10));
  EXPECT_FALSE(view_->take_picked());
  const auto frame = view_->next_until(soon());
  ASSERT_TRUE(frame && *frame);
  const auto result = view_->take_picked();
  ASSERT_TRUE(result);
  EXPECT_EQ(result->position().x(), 30);
  EXPECT_FALSE(view_->take_picked());
  EXPECT_TRUE(view_->next_until(View::Clock::now() + milliseconds(20)));  // a pick that fails ends nothing
  const auto requests = said_by_client();
  ASSERT_EQ(requests.size(), 3u);
  EXPECT_EQ(requests[2].pick_surfel().x(), 9u);
  EXPECT_EQ(requests[2].pick_surfel().y(), 10u);
}

TEST_F(ViewTest, SilenceIsNoFrame) {
  open("");
  const auto frame = view_->next_until(View::Clock::now() + milliseconds(20));
  ASSERT_TRUE(frame);
  EXPECT_FALSE(frame->has_value());
}

TEST_F(ViewTest, AnErrorOfTheViewEndsItAndNoOther) {
  open(failure(77) + piece(1, 0, "one", false) + failure(1));
  const auto frame = view_->next_until(soon());
  ASSERT_TRUE(frame && *frame);
  const auto end = view_->next_until(soon());
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().kind, ErrorKind::kNotFound);
  EXPECT_NE(end.error().message.find("no such model"), std::string::npos);
}

}  // namespace
}  // namespace surfcast::client
