#include "client/window/decode_picture.h"

#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "client/jpeg_file.h"
#include "client/jpeg_scans.h"
#include "encode/encode_picture.h"

namespace surfcast::window {
namespace {

wire::Picture encoded(picture::FileFormat format, wire::FileFormat name) {
  picture::Image image{3, 2, picture::PixelFormat::kSrgb8, {}};
  for (int i = 0; i < 6; ++i) {
    for (const int value : {200, 100, 50, 255}) image.pixels.push_back(static_cast<std::byte>(value));
  }
  const auto bytes = encode::encode_picture(image, format, 95);
  EXPECT_TRUE(bytes);
  wire::Picture picture;
  picture.set_format(name);
  picture.set_data(bytes->data(), bytes->size());
  return picture;
}

TEST(DecodePicture, LosslessPixelsAreThoseThatWereEncoded) {
  const auto image = decode_picture(encoded(picture::FileFormat::kPng, wire::FILE_FORMAT_PNG));
  ASSERT_TRUE(image);
  EXPECT_EQ(image->width, 3);
  EXPECT_EQ(image->height, 2);
  ASSERT_EQ(image->pixels.size(), 24u);
  EXPECT_EQ(image->pixels[0], 50);
  EXPECT_EQ(image->pixels[1], 100);
  EXPECT_EQ(image->pixels[22], 200);
}

TEST(DecodePicture, JpegIsNearThem) {
  const auto image = decode_picture(encoded(picture::FileFormat::kJpeg, wire::FILE_FORMAT_JPEG));
  ASSERT_TRUE(image);
  EXPECT_EQ(image->width, 3);
  EXPECT_NEAR(image->pixels[0], 50, 8);
  EXPECT_NEAR(image->pixels[2], 200, 8);
}

TEST(DecodePicture, WhatCanBeShownOfAJpegIsNearTheWhole) {
  const std::string file = client::jpeg_file(picture::JpegOrder::kScans);
  const auto decoded = [](const std::string& data) {
    wire::Picture picture;
    picture.set_format(wire::FILE_FORMAT_JPEG);
    picture.set_data(data);
    return decode_picture(picture);
  };
  const auto whole = decoded(file);
  ASSERT_TRUE(whole);
  double before = 1e9;
  for (size_t length = 0, shown = 0; length <= file.size(); ++length) {
    const size_t now = client::showable_bytes(std::string_view(file).substr(0, length));
    if (now == std::exchange(shown, now)) continue;
    const auto early = decoded(file.substr(0, now).append(client::kEndOfJpeg));
    ASSERT_TRUE(early) << now;
    double error = 0;
    for (size_t i = 0; i < whole->pixels.size(); ++i) error += std::pow(early->pixels[i] - whole->pixels[i], 2);
    error = std::sqrt(error / static_cast<double>(whole->pixels.size()));
    EXPECT_LT(error, 12) << now;  // levels, root mean square
    EXPECT_LE(error, before) << now;
    before = error;
  }
  EXPECT_EQ(before, 0);
}

TEST(DecodePicture, EveryTruncationOfAPngIsAnError) {
  const wire::Picture whole = encoded(picture::FileFormat::kPng, wire::FILE_FORMAT_PNG);
  for (size_t length = 0; length + 13 < whole.data().size(); ++length) {  // what may be missing is the closing chunk
    wire::Picture cut = whole;
    cut.mutable_data()->resize(length);
    EXPECT_FALSE(decode_picture(cut)) << length;
  }
}

TEST(DecodePicture, ATruncatedJpegDoesNoHarm) {
  const wire::Picture whole = encoded(picture::FileFormat::kJpeg, wire::FILE_FORMAT_JPEG);
  for (size_t length = 0; length < whole.data().size(); ++length) {
    wire::Picture cut = whole;
    cut.mutable_data()->resize(length);
    const auto image = decode_picture(cut);  // the decoder may fill in what is missing
    EXPECT_TRUE(!image || image->pixels.size() == 24) << length;
  }
}

TEST(DecodePicture, ASizeBeyondReasonIsRefusedBeforeMemoryIsSetAside) {
  wire::Picture picture = encoded(picture::FileFormat::kPng, wire::FILE_FORMAT_PNG);
  picture.mutable_data()->replace(16, 4, "\x7f\xff\xff\xff");  // the width in the first chunk
  EXPECT_FALSE(decode_picture(picture));
}

TEST(DecodePicture, OtherFormatsAreRefused) {
  wire::Picture picture;
  picture.set_format(wire::FILE_FORMAT_EXR);
  EXPECT_FALSE(decode_picture(picture));
}

}  // namespace
}  // namespace surfcast::window
