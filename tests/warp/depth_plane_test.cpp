#include "warp/depth_plane.h"

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "encode/encode_depth.h"

namespace surfcast::warp {
namespace {

constexpr int kPictureWidth = 75;  // of the picture; its last cells are cut off
constexpr int kPictureHeight = 38;
constexpr int kPictureTexels = 10;

constexpr size_t kEnough = 1 << 20;  // bytes

wire::DepthPlane to_message(const picture::EncodedDepth& depth) {
  wire::DepthPlane plane;
  plane.set_width(static_cast<uint32_t>(depth.width));
  plane.set_height(static_cast<uint32_t>(depth.height));
  plane.set_cell(static_cast<uint32_t>(depth.cell));
  plane.set_first(depth.first);
  plane.set_last(depth.last);
  plane.set_codes(depth.codes.data(), depth.codes.size());
  plane.set_seen_through(depth.seen_through);
  return plane;
}

/// Depths from 1 to `farthest`, and some background.
picture::DepthMap noise(double farthest) {
  picture::DepthMap map = picture::empty_depth_map(kPictureWidth, kPictureHeight, kPictureTexels);
  std::mt19937 random(1);  // NOLINT(cert-msc51-cpp): the same map in every run
  std::uniform_real_distribution<double> depth(0, std::log(farthest));
  for (float& texel : map.inverse) texel = random() % 4 == 0 ? 0.0F : static_cast<float>(std::exp(-depth(random)));
  return map;
}

wire::DepthPlane valid_plane() {
  return to_message(*encode::encode_depth(noise(100), kEnough));
}

TEST(DepthMap, HasCellsThatCoverThePicture) {
  const picture::DepthMap map = picture::empty_depth_map(kPictureWidth, kPictureHeight, kPictureTexels);
  EXPECT_EQ(map.cell, 8);
  EXPECT_EQ(map.width, 10);
  EXPECT_EQ(map.height, 5);
}

TEST(DepthPlane, HasTheDepthsThatWereEncodedToHalfAStep) {
  for (const double farthest : {1.001, 2.0, 100.0, 1e7}) {
    const picture::DepthMap map = noise(farthest);
    const Result<DepthPlane> plane =
        decode_depth(to_message(*encode::encode_depth(map, kEnough)), kPictureWidth, kPictureHeight);
    ASSERT_TRUE(plane) << plane.error().message;
    ASSERT_EQ(plane->inverse.size(), map.inverse.size());
    const double step = std::log(farthest) / 254;
    for (size_t i = 0; i < map.inverse.size(); ++i) {
      if (map.inverse[i] == 0) {
        EXPECT_EQ(plane->inverse[i], 0);
      } else {
        EXPECT_LE(std::abs(std::log(plane->inverse[i] / map.inverse[i])), step / 2 + 1e-6);
      }
    }
  }
}

TEST(DepthPlane, SaysWhetherThingsAreSeenThrough) {
  for (const bool seen_through : {false, true}) {
    picture::DepthMap map = noise(100);
    map.seen_through = seen_through;
    const size_t halved = encode::encode_depth(map, kEnough)->codes.size() - 1;
    for (const size_t most : {kEnough, halved}) {
      const auto encoded = encode::encode_depth(map, most);
      EXPECT_EQ(decode_depth(to_message(*encoded), kPictureWidth, kPictureHeight)->seen_through, seen_through);
    }
  }
}

TEST(DepthPlane, OfOneDepthHasIt) {
  picture::DepthMap map = picture::empty_depth_map(kPictureWidth, kPictureHeight, kPictureTexels);
  map.inverse[7] = 0.25F;
  const Result<DepthPlane> plane =
      decode_depth(to_message(*encode::encode_depth(map, kEnough)), kPictureWidth, kPictureHeight);
  ASSERT_TRUE(plane) << plane.error().message;
  EXPECT_FLOAT_EQ(plane->inverse[7], 0.25F);
  EXPECT_EQ(plane->inverse[8], 0);
}

TEST(DepthPlane, OfBackgroundAloneIsNone) {
  EXPECT_FALSE(encode::encode_depth(picture::empty_depth_map(kPictureWidth, kPictureHeight, kPictureTexels), kEnough));
}

TEST(DepthPlane, IsMadeCoarserUntilItTakesNoMoreThanItMay) {
  const picture::DepthMap map = noise(100);
  const size_t whole = encode::encode_depth(map, kEnough)->codes.size();
  const picture::EncodedDepth less = *encode::encode_depth(map, whole - 1);
  EXPECT_LT(less.codes.size(), whole);
  EXPECT_EQ(less.cell, 2 * map.cell);
  const Result<DepthPlane> plane = decode_depth(to_message(less), kPictureWidth, kPictureHeight);
  ASSERT_TRUE(plane) << plane.error().message;
  EXPECT_FLOAT_EQ(std::ranges::max(plane->inverse), std::ranges::max(map.inverse));
  EXPECT_EQ(encode::encode_depth(map, 0)->width, 1);
}

TEST(DepthPlane, DepthsThatAreNoNumbersAreBackground) {
  picture::DepthMap map = noise(10);
  map.inverse[3] = std::numeric_limits<float>::quiet_NaN();
  map.inverse[4] = std::numeric_limits<float>::infinity();
  map.inverse[5] = -1;
  const Result<DepthPlane> plane =
      decode_depth(to_message(*encode::encode_depth(map, kEnough)), kPictureWidth, kPictureHeight);
  ASSERT_TRUE(plane) << plane.error().message;
  for (const size_t i : {3, 4, 5}) EXPECT_EQ(plane->inverse[i], 0);
}

TEST(DepthPlane, ThatDoesNotFitItsPictureIsRefused) {
  wire::DepthPlane plane = valid_plane();
  EXPECT_TRUE(decode_depth(plane, kPictureWidth, kPictureHeight));
  EXPECT_FALSE(decode_depth(plane, kPictureWidth + 8, kPictureHeight));
  EXPECT_FALSE(decode_depth(plane, kPictureWidth, kPictureHeight - 8));
  EXPECT_FALSE(decode_depth(plane, 0, 0));
  for (const uint32_t cell : {0U, 7U, 76U, 4294967295U}) {
    plane.set_cell(cell);
    EXPECT_FALSE(decode_depth(plane, kPictureWidth, kPictureHeight)) << cell;
  }
}

TEST(DepthPlane, OfTooManyTexelsIsRefusedBeforeMemoryIsSetAside) {
  wire::DepthPlane plane = valid_plane();
  plane.set_cell(1);
  plane.set_width(16384);
  plane.set_height(16384);
  const Result<DepthPlane> decoded = decode_depth(plane, 16384, 16384);
  ASSERT_FALSE(decoded);
  EXPECT_NE(decoded.error().message.find("too many texels"), std::string::npos);
}

TEST(DepthPlane, WithoutARangeIsRefused) {
  const auto with_range = [](double first, double last) {
    wire::DepthPlane plane = valid_plane();
    plane.set_first(first);
    plane.set_last(last);
    return decode_depth(plane, kPictureWidth, kPictureHeight).has_value();
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(with_range(1, 2));
  EXPECT_FALSE(with_range(0, 2));
  EXPECT_FALSE(with_range(-1, 2));
  EXPECT_FALSE(with_range(2, 2));
  EXPECT_FALSE(with_range(3, 2));
  EXPECT_FALSE(with_range(kNaN, 2));
  EXPECT_FALSE(with_range(1, kNaN));
  EXPECT_FALSE(with_range(1, kInfinite));
  EXPECT_FALSE(with_range(1e-300, 1));
  EXPECT_FALSE(with_range(1, 1e300));
}

TEST(DepthPlane, WithDamagedCodesIsRefused) {
  wire::DepthPlane plane = valid_plane();
  const std::string codes = plane.codes();
  for (size_t size = 0; size < codes.size(); ++size) {
    plane.set_codes(codes.substr(0, size));
    EXPECT_FALSE(decode_depth(plane, kPictureWidth, kPictureHeight)) << size;
  }
  // More codes than texels, as of a bomb.
  picture::DepthMap larger = picture::empty_depth_map(4096, 4096, 4096);
  larger.inverse[0] = 1;
  plane.set_codes(to_message(*encode::encode_depth(larger, kEnough)).codes());
  EXPECT_FALSE(decode_depth(plane, kPictureWidth, kPictureHeight));
}

TEST(DepthPlane, AnyChangedByteGivesAPlaneOrIsRefused) {
  const wire::DepthPlane valid = valid_plane();
  for (size_t at = 0; at < valid.codes().size(); ++at) {
    wire::DepthPlane plane = valid;
    (*plane.mutable_codes())[at] ^= 0x41;
    const Result<DepthPlane> decoded = decode_depth(plane, kPictureWidth, kPictureHeight);
    if (!decoded) continue;
    EXPECT_EQ(decoded->inverse.size(), 50U);
  }
}

}  // namespace
}  // namespace surfcast::warp
