// This program finds the module of image codecs, and none of the video codec.
#include <gtest/gtest.h>

#include "video/video_stream.h"
#include "view/view_fixture.h"

namespace surfcast::view {
namespace {

class WithoutCodecTest : public ViewOfAScanTest {
 protected:
  WithoutCodecTest() { video_ = true; }
};

TEST_F(WithoutCodecTest, FramesInMotionAreFiles) {
  every_message_ = std::chrono::milliseconds(100);
  ASSERT_TRUE(move_until([this](const ViewMessage&) { return frames_.size() >= 40; }));
  for (const ViewMessage& frame : frames_) {
    EXPECT_FALSE(frame.picture.video);
    EXPECT_FALSE(frame.picture.bytes.empty());
  }
}

TEST_F(WithoutCodecTest, TheErrorNamesTheModule) {
  const auto stream = video::VideoStream::open();
  ASSERT_FALSE(stream);
  EXPECT_NE(stream.error().message.find("video_codec.so"), std::string::npos) << stream.error().message;
}

}  // namespace
}  // namespace surfcast::view
