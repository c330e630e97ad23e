#include "view/view_session.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "view/view_fixture.h"

namespace surfcast::view {
namespace {

TEST_F(ViewOfAScanTest, GoesFromPreviewToModelWithoutBeingAsked) {
  ASSERT_TRUE(run_until(is_final));
  EXPECT_TRUE(frames_.back().picture.preview);
  frames_.clear();
  publish(2);
  ASSERT_TRUE(run_until(is_final));
  for (const ViewMessage& frame : frames_) {
    EXPECT_FALSE(frame.picture.preview);
    EXPECT_FALSE(frame.moving) << "no picture of a motion between two at rest";
  }
}

TEST_F(ViewOfAScanTest, ShowsThePreviewUntilTheModelsBlocksAreThere) {
  ASSERT_TRUE(run_until(is_final));
  control_->loading_edition = 2;
  control_->loading = true;
  publish(2);
  update();  // the hand moves on: pictures of the preview
  frames_.clear();
  ASSERT_TRUE(run_until([](const ViewMessage& frame) { return !frame.moving; }));
  const int drawn = control_->drawn;
  while (control_->drawn < drawn + 3) {  // asked for the model in vain
    run_tasks();
    view_->advance(Clock::now());
  }
  EXPECT_TRUE(std::ranges::all_of(frames_, [](const ViewMessage& frame) { return frame.picture.preview; }));
  control_->loading = false;
  ASSERT_TRUE(run_until(is_final));
  EXPECT_FALSE(frames_.back().picture.preview);
}

TEST_F(ViewOfAScanTest, GoesToTheModelInAMotionThatNeverRests) {
  ASSERT_TRUE(run_until(is_final));
  control_->loading_edition = 2;
  control_->loading = true;
  publish(2);
  frames_.clear();
  const auto many = [this](const ViewMessage&) { return frames_.size() > 30; };
  ASSERT_TRUE(move_until(many)) << "the preview goes on";
  EXPECT_TRUE(std::ranges::all_of(frames_, [](const ViewMessage& frame) { return frame.picture.preview; }));
  control_->loading = false;
  frames_.clear();
  ASSERT_TRUE(move_until([](const ViewMessage& frame) { return !frame.picture.preview; }));
  EXPECT_TRUE(std::ranges::all_of(frames_, [](const ViewMessage& frame) { return frame.moving; }));
  frames_.clear();
  ASSERT_TRUE(move_until([this](const ViewMessage&) { return frames_.size() > 10; }));
  EXPECT_TRUE(std::ranges::none_of(frames_, [](const ViewMessage& frame) { return frame.picture.preview; }));
}

TEST_F(ViewOfAScanTest, StaysWithTheModelOnceItWasShown) {
  publish(2);
  ASSERT_TRUE(run_until([](const ViewMessage& frame) { return is_final(frame) && !frame.picture.preview; }));
  frames_.clear();
  update();
  ASSERT_TRUE(run_until(is_final));
  EXPECT_TRUE(std::ranges::none_of(frames_, [](const ViewMessage& frame) { return frame.picture.preview; }));
}

/// Whether a JPEG file is progressive: it has the marker of such a frame (ITU-T T.81, table B.1).
bool is_progressive(const ViewMessage& frame) {
  const std::vector<std::byte>& bytes = frame.picture.bytes;
  const std::array marker{std::byte{0xFF}, std::byte{0xC2}};
  // Not std::ranges::search: clang 14 does not compile it.
  return std::search(bytes.begin(), bytes.end(), marker.begin(), marker.end()) != bytes.end();
}

TEST_F(ViewOfAScanTest, FilesAreThoseOfAPictureWithoutDepth) {
  ASSERT_TRUE(move_until([](const ViewMessage& frame) { return frame.moving; }));
  update();
  ASSERT_TRUE(run_until(is_final));
  EXPECT_TRUE(std::ranges::none_of(frames_, is_progressive));
}

class ViewWithDepthTest : public ViewOfAScanTest {
 protected:
  ViewWithDepthTest() { depth_ = true; }
};

TEST_F(ViewWithDepthTest, AFrameAtRestGoesFromCoarseToFine) {
  ASSERT_TRUE(move_until([](const ViewMessage& frame) { return frame.moving; }));
  update();
  ASSERT_TRUE(run_until(is_final));
  size_t refined = 0;
  for (const ViewMessage& frame : frames_) {
    const bool expected = !frame.moving && !is_final(frame);
    EXPECT_EQ(is_progressive(frame), expected) << frame.frame;
    refined += expected ? 1 : 0;
  }
  EXPECT_GE(refined, 1U);
}

TEST_F(ViewOfAScanTest, OnlyTheFinalFrameIsDrawnToAnError) {
  ASSERT_TRUE(run_until(is_final));
  control_->requests.clear();
  frames_.clear();
  error_ = 40;
  update(/*moving=*/true);
  ASSERT_TRUE(run_until([](const ViewMessage& frame) { return frame.moving; }));
  frames_.clear();
  update();
  ASSERT_TRUE(run_until(is_final));
  std::vector<picture::PictureRequest> drawn = control_->requests;
  ASSERT_GE(drawn.size(), 3U) << "in motion, at rest, and the final one: it is not made of the one before";
  EXPECT_EQ(drawn.back().error, 40);
  EXPECT_EQ(drawn.back().loading, picture::Loading::kWait);
  drawn.pop_back();
  for (const picture::PictureRequest& request : drawn) {
    EXPECT_EQ(request.error, 0);
    EXPECT_GE(request.spacing, 1) << "not the finest level";
  }
}

/// The same view, of a client that decodes VP9.
class ViewOfAVideoTest : public ViewOfAScanTest {
 protected:
  ViewOfAVideoTest() { video_ = true; }

  bool move_for(size_t frames) {
    frames_.clear();
    return move_until([this, frames](const ViewMessage&) { return frames_.size() >= frames; });
  }
  static bool is_packet(const ViewMessage& frame) { return frame.picture.video.has_value(); }
  /// Whether a decoder that gets these frames, and has decoded this one before, can decode them.
  static ::testing::AssertionResult decodable(const std::vector<ViewMessage>& frames, uint64_t last = 0) {
    for (const ViewMessage& frame : frames) {
      if (!is_packet(frame)) continue;
      const service::PacketPlace& place = *frame.picture.video;
      if (place.key ? place.refers_to != 0 : last == 0 || place.refers_to != last) {
        return ::testing::AssertionFailure() << frame.frame << " refers to " << place.refers_to << " after " << last;
      }
      if (frame.more || !frame.first) return ::testing::AssertionFailure() << "packets are sent as a whole";
      last = frame.frame;
    }
    return ::testing::AssertionSuccess();
  }
};

TEST_F(ViewOfAVideoTest, SendsFilesOverAFastLink) {
  ASSERT_TRUE(move_for(30));
  EXPECT_TRUE(std::ranges::none_of(frames_, is_packet));
}

TEST_F(ViewOfAVideoTest, SendsOneStreamOfPacketsOverASlowLink) {
  every_message_ = std::chrono::milliseconds(100);
  ASSERT_TRUE(move_for(40));
  EXPECT_TRUE(std::ranges::all_of(frames_.begin() + 30, frames_.end(), is_packet));
  EXPECT_TRUE(decodable(frames_));
  const auto keys = std::ranges::count_if(
      frames_, [](const ViewMessage& frame) { return is_packet(frame) && frame.picture.video->key; });
  EXPECT_EQ(keys, 1);
}

TEST_F(ViewOfAVideoTest, DrawsNoLargerFramesWhileTheyAreLate) {
  every_message_ = std::chrono::milliseconds(100);  // and each one so much later than the one before
  ASSERT_TRUE(move_for(60));
  for (const ViewMessage& frame : frames_) EXPECT_TRUE(!frame.moving || frame.picture.width <= 4) << "of 8";
  // In time again: as large as they can be drawn.
  every_message_ = late_ = std::chrono::milliseconds(0);
  EXPECT_TRUE(move_until([](const ViewMessage& frame) { return frame.moving && frame.picture.width == 8; }));
}

TEST_F(ViewOfAVideoTest, GoesOnWithTheStreamAfterARest) {
  every_message_ = std::chrono::milliseconds(100);
  ASSERT_TRUE(move_for(40));
  const uint64_t last = frames_.back().frame;
  frames_.clear();
  update();
  ASSERT_TRUE(run_until(is_final));
  EXPECT_TRUE(decodable(frames_, last));
  const auto at_rest = std::ranges::find(frames_, false, &ViewMessage::moving);
  EXPECT_TRUE(std::none_of(at_rest, frames_.end(), is_packet));
  std::vector<ViewMessage> all = frames_;
  ASSERT_TRUE(move_for(20));
  all.insert(all.end(), frames_.begin(), frames_.end());
  EXPECT_TRUE(decodable(all, last));
  EXPECT_TRUE(
      std::ranges::none_of(all, [](const ViewMessage& frame) { return is_packet(frame) && frame.picture.video->key; }));
}

TEST_F(ViewOfAVideoTest, BeginsAnewAfterAPacketThatWasNotSent) {
  every_message_ = std::chrono::milliseconds(100);
  ASSERT_TRUE(move_for(40));
  const uint64_t last = frames_.back().frame;
  lose_tasks_ = 1;
  update(/*moving=*/true);
  while (lose_tasks_ > 0) view_->advance(Clock::now());
  ASSERT_TRUE(move_for(20));
  EXPECT_TRUE(decodable(frames_, last));
  const auto is_key = [](const ViewMessage& frame) { return is_packet(frame) && frame.picture.video->key; };
  EXPECT_EQ(std::ranges::count_if(frames_, is_key), 1);
}

TEST_F(ViewOfAVideoTest, StaysDecodableWhenTheModelTakesOver) {
  every_message_ = std::chrono::milliseconds(100);
  ASSERT_TRUE(move_for(40));
  const uint64_t last = frames_.back().frame;
  publish(2);
  frames_.clear();
  ASSERT_TRUE(move_until([](const ViewMessage& frame) { return !frame.picture.preview; }));
  ASSERT_TRUE(move_until([this](const ViewMessage&) { return frames_.size() > 20; }));
  EXPECT_TRUE(decodable(frames_, last));
}

TEST_F(ViewOfAScanTest, SendsFilesToWhoDidNotAskForVideo) {
  every_message_ = std::chrono::milliseconds(100);
  ASSERT_TRUE(move_until([this](const ViewMessage&) { return frames_.size() >= 40; }));
  for (const ViewMessage& frame : frames_) EXPECT_FALSE(frame.picture.video);
}

}  // namespace
}  // namespace surfcast::view
