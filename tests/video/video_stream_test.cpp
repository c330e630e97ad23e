#include "video/video_stream.h"

#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

#include "video/pictures.h"

namespace surfcast::video {
namespace {

constexpr size_t kBytes = 2000;

class VideoStreamTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto opened = VideoStream::open();
    ASSERT_TRUE(opened) << opened.error().message;
    stream_ = std::move(*opened);
  }
  VideoPacket encode(const picture::Image& image, uint64_t frame, size_t bytes = kBytes) {
    Result<VideoPacket> packet = stream_->encode(image, {frame, bytes, 320, 192});
    EXPECT_TRUE(packet) << packet.error().message;
    return packet.value_or(VideoPacket());
  }
  std::shared_ptr<VideoStream> stream_;
};

TEST_F(VideoStreamTest, EachFrameRefersToTheOneBefore) {
  const VideoPacket first = encode(waves(160, 96, 0), 7);
  EXPECT_TRUE(first.key);
  EXPECT_EQ(first.refers_to, 0U);
  uint64_t before = 7;
  for (const uint64_t frame : {8U, 9U, 12U}) {  // others are files
    const VideoPacket next = encode(waves(160, 96, static_cast<double>(frame)), frame);
    EXPECT_FALSE(next.key);
    EXPECT_EQ(next.refers_to, before);
    before = frame;
  }
}

TEST_F(VideoStreamTest, BeginsAnewWhereAPacketWasDropped) {
  encode(waves(160, 96, 0), 1);
  EXPECT_FALSE(encode(waves(160, 96, 1), 2).key);
  stream_->restart();
  const VideoPacket key = encode(waves(160, 96, 2), 3);
  EXPECT_TRUE(key.key);
  EXPECT_EQ(key.refers_to, 0U);
  EXPECT_EQ(encode(waves(160, 96, 3), 4).refers_to, 3U);
}

TEST_F(VideoStreamTest, FramesOfOtherSizesReferToTheOnesBeforeUpToTwiceTheSize) {
  encode(waves(320, 192, 0), 1);
  EXPECT_FALSE(encode(waves(240, 144, 1), 2).key);
  EXPECT_FALSE(encode(waves(160, 96, 2), 3).key);
  EXPECT_FALSE(encode(waves(301, 181, 3), 4).key);
  EXPECT_TRUE(encode(waves(80, 48, 4), 5).key) << "a quarter of a frame that may still be referred to";
}

TEST_F(VideoStreamTest, ALargerViewBeginsAnew) {
  encode(waves(160, 96, 0), 1);
  EXPECT_TRUE(encode(waves(640, 384, 0), 2).key);
  EXPECT_FALSE(encode(waves(640, 384, 1), 3).key);
  EXPECT_FALSE(encode(waves(320, 192, 2), 4).key);
}

TEST_F(VideoStreamTest, KeepsToTheBytes) {
  double sum = 0;
  constexpr int kFrames = 20;
  for (uint64_t frame = 1; frame <= kFrames; ++frame) {
    const picture::Image image = noise(320, 192, static_cast<unsigned>(frame));
    const size_t size = encode(image, frame, 6000).bytes.size();
    EXPECT_LE(size, frame <= 2 ? 30'000U : 9000U) << frame;
    sum += static_cast<double>(size);
  }
  EXPECT_GT(sum / kFrames, 3000);
}

TEST_F(VideoStreamTest, ALargerPictureIsCodedMoreCoarsely) {
  // Grain, of which each picture takes as many bytes as the one before.
  const picture::Image grain = noise(320, 192, 1);
  const auto seen = [&](int width, int height, int shift) {
    return image_of(width, height, [&](int x, int y, int channel) {
      const int column = (x * 320 / width + shift) % 320;
      const int row = y * 192 / height;
      const auto level = std::to_integer<int>(grain.pixels[static_cast<size_t>((row * 320 + column) * 4 + channel)]);
      return 127 + (level - 127) / 4 + std::lround(60 * std::sin(column * 0.05 + channel));
    });
  };
  uint64_t frame = 0;
  const auto encode_next = [&](int width) {
    ++frame;
    return encode(seen(width, width * 3 / 5, static_cast<int>(frame)), frame, 6000).bytes.size();
  };
  for (int i = 0; i < 15; ++i) encode_next(200);
  for (const int width : {240, 280, 320}) {
    EXPECT_LE(encode_next(width), 5300U) << width << ": what is not in the smaller one may take as much again";
    for (int i = 0; i < 15; ++i) encode_next(width);
  }
}

TEST_F(VideoStreamTest, FollowsFewerBytesWithTheNextFrame) {
  uint64_t frame = 0;
  for (; frame < 10; ++frame) encode(noise(320, 192, static_cast<unsigned>(frame)), frame + 1, 20'000);
  const picture::Image image = noise(320, 192, 99);
  EXPECT_LE(encode(image, frame + 1, 4000).bytes.size(), 7000U);
}

TEST_F(VideoStreamTest, EncodersBeyondTheMemoryOfTheHostAreRefused) {
  const picture::Image image = waves(160, 96, 0);
  const Result<VideoPacket> refused = stream_->encode(image, {1, kBytes, 1 << 20, 1 << 20});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kLimit);
  EXPECT_TRUE(encode(image, 2).key) << "the refusal takes nothing";
}

TEST_F(VideoStreamTest, TakesTheSmallestPictures) {
  encode(noise(1, 1, 1), 1);
  encode(noise(3, 1, 2), 2);
  encode(noise(1, 5, 3), 3);
}

}  // namespace
}  // namespace surfcast::video
