#include "video/quantizer.h"

#include <cmath>

#include <gtest/gtest.h>

#include "video/codec_module.h"

namespace surfcast::video {
namespace {

constexpr double kPixels = 1280 * 720;

/// A codec whose pictures take `scale` bytes at quantizer 0, and half for each `halving` quantizers.
struct ImaginaryCodec {
  double scale = 0;
  double halving = 0;
  [[nodiscard]] double bytes(int quantizer) const { return scale * std::exp2(-quantizer / halving); }
};

constexpr SizeModel kModel{0, 0.11};

TEST(QuantizerTest, FindsTheSizeOfAnyCodecWithinAFewPictures) {
  for (const double scale : {5e4, 1e5, 3e5}) {
    for (const double halving : {6.0, 9.0, 12.0}) {
      const ImaginaryCodec codec{scale, halving};
      SizeModel model = kModel;
      int quantizer = 0;
      for (int i = 0; i < 12; ++i) {
        quantizer = quantizer_for(model, 15'000, kPixels);
        model = learned(model, quantizer, codec.bytes(quantizer), kPixels);
      }
      EXPECT_LE(codec.bytes(quantizer), 15'000 * 1.05) << scale << ' ' << halving;
      EXPECT_GE(codec.bytes(quantizer), 15'000 * 0.75) << scale << ' ' << halving;
    }
  }
}

TEST(QuantizerTest, FollowsACollapseAtOnce) {
  const ImaginaryCodec codec{5e5, 9};
  SizeModel model = kModel;
  for (int i = 0; i < 12; ++i) {
    const int quantizer = quantizer_for(model, 20'000, kPixels);
    model = learned(model, quantizer, codec.bytes(quantizer), kPixels);
  }
  EXPECT_LE(codec.bytes(quantizer_for(model, 4'000, kPixels)), 4'000 * 1.1);
}

TEST(QuantizerTest, IsCoarserForAPictureThatHasBecomeLarger) {
  const SizeModel model{-1, 0.1};
  const SizeModel larger = sizes_of_larger(model);
  EXPECT_EQ(quantizer_for(larger, 1000, 100'000), quantizer_for(model, 1000, 100'000) + 6) << "0.6 of 0.1 each";
}

TEST(QuantizerTest, StaysWithinThoseOfTheCodec) {
  EXPECT_EQ(quantizer_for({10, 0.11}, 1, kPixels), kCoarsestQuantizer);
  EXPECT_EQ(quantizer_for({10, 0.07}, 0, kPixels), kCoarsestQuantizer);
  EXPECT_GE(quantizer_for({-20, 0.11}, 1e9, kPixels), kFinestQuantizer);
  EXPECT_GT(learned(kModel, 40, 0, kPixels).complexity, -30) << "no picture is smaller than a byte";
}

TEST(QuantizerTest, ALargePictureCountsMoreThanASmallOne) {
  const double expected = std::exp2(-0.11 * 30) * kPixels;
  const SizeModel larger = learned(kModel, 30, 2 * expected, kPixels);
  const SizeModel smaller = learned(kModel, 30, expected / 2, kPixels);
  EXPECT_NEAR(larger.complexity, 1, 1e-9);
  EXPECT_NEAR(smaller.complexity, -0.5, 1e-9);
}

TEST(QuantizerTest, TakesTheFirstSizesFromTheKeyFrame) {
  const SizeModel model = sizes_after_key(30, 60'000, kPixels);
  EXPECT_EQ(quantizer_for(model, 1.01 * 60'000, kPixels), 30);
  EXPECT_GT(quantizer_for(model, 10'000, kPixels), 45);
}

}  // namespace
}  // namespace surfcast::video
