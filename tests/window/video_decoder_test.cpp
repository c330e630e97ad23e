#include "client/window/video_decoder.h"

#include <cmath>

#include <gtest/gtest.h>

#include "video/pictures.h"
#include "video/video_stream.h"

namespace surfcast::window {
namespace {

using video::noise;
using video::waves;

/// dB over all pixels and colours.
double psnr(const picture::Image& image, const PixelImage& shown) {
  double squares = 0;
  for (size_t i = 0; i < image.pixels.size(); i += 4) {
    for (size_t channel = 0; channel < 3; ++channel) {
      squares += std::pow(static_cast<double>(image.pixels[i + channel]) - shown.pixels[i + 2 - channel], 2);
    }
  }
  return 10 * std::log10(255.0 * 255.0 * 0.75 * static_cast<double>(image.pixels.size()) / squares);
}

class VideoDecoderTest : public ::testing::Test {
 protected:
  /// The frame of the next number, as a view sends it.
  wire::ViewFrame encode(const picture::Image& image, size_t bytes = 20'000) {
    wire::ViewFrame frame;
    frame.set_frame(++last_frame_);
    const Result<video::VideoPacket> packet = stream_->encode(image, {last_frame_, bytes, 320, 192});
    EXPECT_TRUE(packet);
    frame.mutable_video()->set_codec(wire::VIDEO_CODEC_VP9);
    frame.mutable_video()->set_key(packet->key);
    frame.mutable_video()->set_refers_to(packet->refers_to);
    frame.mutable_picture()->set_data(packet->bytes.data(), packet->bytes.size());
    return frame;
  }
  void expect_like(const picture::Image& image, double least_psnr, size_t bytes = 20'000) {
    const Result<PixelImage> shown = decoder_.decode(encode(image, bytes));
    ASSERT_TRUE(shown) << shown.error().message;
    ASSERT_EQ(shown->width, image.width);
    ASSERT_EQ(shown->height, image.height);
    EXPECT_GT(psnr(image, *shown), least_psnr);
  }

  std::shared_ptr<video::VideoStream> stream_ = video::VideoStream::open().value();
  VideoDecoder decoder_;
  uint64_t last_frame_ = 0;
};

TEST_F(VideoDecoderTest, ShowsWhatWasEncoded) {
  for (int i = 0; i < 5; ++i) expect_like(waves(320, 192, i), 40);
}

TEST_F(VideoDecoderTest, ShowsNoiseAsWellAsItsBytesAllow) {
  for (unsigned i = 0; i < 3; ++i) expect_like(noise(320, 192, i), 11, 200'000);
}

TEST_F(VideoDecoderTest, KeepsTheColours) {
  for (const int channel : {0, 1, 2}) {
    expect_like(video::image_of(64, 64, [channel](int, int, int c) { return c == channel ? 250 : 20; }), 40);
  }
}

TEST_F(VideoDecoderTest, FollowsChangesOfTheSize) {
  int i = 0;
  for (const auto& [width, height] : {std::pair{320, 180}, {280, 158}, {161, 91}, {321, 181}, {640, 360}, {81, 47}}) {
    expect_like(waves(width, height, ++i), 38);
    expect_like(waves(width, height, ++i), 38);
  }
}

TEST_F(VideoDecoderTest, ShowsPicturesOfAFewPixels) {
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 1}, {1, 7}, {5, 5}})
    expect_like(waves(width, height, 1), 35);
}

TEST_F(VideoDecoderTest, GoesOnAfterADamagedPacketWithTheNextKeyFrame) {
  expect_like(waves(320, 192, 0), 40);
  wire::ViewFrame damaged = encode(waves(320, 192, 1));
  damaged.mutable_picture()->set_data(damaged.picture().data().substr(0, 2));
  EXPECT_FALSE(decoder_.decode(damaged));
  EXPECT_FALSE(decoder_.decode(encode(waves(320, 192, 2)))) << "the frame that it refers to is missing";
  stream_->restart();
  expect_like(waves(320, 192, 3), 40);
}

TEST_F(VideoDecoderTest, RefusesAFrameWhosePredecessorIsMissing) {
  EXPECT_TRUE(decoder_.decode(encode(waves(320, 192, 0))));
  encode(waves(320, 192, 1));
  EXPECT_FALSE(decoder_.decode(encode(waves(320, 192, 2))));
  VideoDecoder fresh;
  EXPECT_FALSE(fresh.decode(encode(waves(320, 192, 3))));
}

TEST_F(VideoDecoderTest, RefusesWhatIsNoVideo) {
  EXPECT_FALSE(decoder_.decode(std::string_view()));
  EXPECT_FALSE(decoder_.decode("nothing of VP9"));
  wire::ViewFrame other = encode(waves(320, 192, 0));
  other.mutable_video()->set_codec(wire::VIDEO_CODEC_NONE);
  EXPECT_FALSE(decoder_.decode(other));
}

/// Of damaged bytes anything may come, but nothing beyond the picture is read or written.
TEST_F(VideoDecoderTest, SurvivesBytesOfAnyKind) {
  const std::string key = encode(waves(96, 64, 0)).picture().data();
  std::mt19937 random(7);
  for (int i = 0; i < 300; ++i) {
    std::string damaged = key;
    for (int k = 0; k < 4; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
    static_cast<void>(decoder_.decode(damaged));
  }
  stream_->restart();
  expect_like(waves(96, 64, 1), 38);
}

}  // namespace
}  // namespace surfcast::window
