#include "encode/encode_picture.h"

#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

namespace surfcast::encode {
namespace {

/// Smooth colours with a black corner, as a rendered picture has.
picture::Image make_picture(int width, int height) {
  picture::Image image{width, height, picture::PixelFormat::kSrgb8, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool background = x < width / 4 && y < height / 4;
      for (int c = 0; c < 3; ++c) {
        const double value = 128 + 100 * std::sin(0.03 * x + c) * std::cos(0.02 * y);
        image.pixels.push_back(static_cast<std::byte>(background ? 0 : static_cast<int>(value)));
      }
      image.pixels.push_back(std::byte{0xff});
    }
  }
  return image;
}

picture::Image make_light(int width, int height) {
  picture::Image image{width, height, picture::PixelFormat::kLinearFloat, {}};
  std::vector<float> values;
  for (int i = 0; i < width * height; ++i) {
    values.insert(values.end(), {0.001F * static_cast<float>(i), 12345.678F, -1e-6F, 1.0F});
  }
  image.pixels.resize(values.size() * sizeof(float));
  std::memcpy(image.pixels.data(), values.data(), image.pixels.size());
  return image;
}

template <typename T>
struct Decoded {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<T> values;
};

template <typename T>
Decoded<T> decode(const std::vector<std::byte>& bytes, const char* reader, OIIO::TypeDesc type) {
  OIIO::Filesystem::IOMemReader memory(const_cast<std::byte*>(bytes.data()), bytes.size());
  const auto input = OIIO::ImageInput::open(std::string("memory.") + reader, nullptr, &memory);
  if (!input) return {};
  const OIIO::ImageSpec& spec = input->spec();
  Decoded<T> decoded{spec.width, spec.height, spec.nchannels, {}};
  decoded.values.resize(static_cast<size_t>(spec.width) * spec.height * spec.nchannels);
  if (!input->read_image(0, 0, 0, spec.nchannels, type, decoded.values.data())) return {};
  return decoded;
}

/// Largest difference of a colour between the picture and what was decoded.
int largest_error(const picture::Image& image, const Decoded<uint8_t>& decoded) {
  int largest = 0;
  for (size_t pixel = 0; pixel < decoded.values.size() / 3; ++pixel) {
    for (size_t c = 0; c < 3; ++c) {
      const int expected = std::to_integer<int>(image.pixels[4 * pixel + c]);
      largest = std::max(largest, std::abs(expected - decoded.values[3 * pixel + c]));
    }
  }
  return largest;
}

TEST(EncodePicture, PngComesBackToTheLastBit) {
  const picture::Image image = make_picture(301, 77);
  const auto bytes = encode_picture(image, picture::FileFormat::kPng, 90);
  ASSERT_TRUE(bytes);
  const auto decoded = decode<uint8_t>(*bytes, "png", OIIO::TypeDesc::UINT8);
  ASSERT_EQ(decoded.width, 301);
  ASSERT_EQ(decoded.height, 77);
  ASSERT_EQ(decoded.channels, 3);
  EXPECT_EQ(largest_error(image, decoded), 0);
}

TEST(EncodePicture, JpegComesBackClose) {
  const picture::Image image = make_picture(301, 77);
  const auto bytes = encode_picture(image, picture::FileFormat::kJpeg, 95);
  ASSERT_TRUE(bytes);
  const auto decoded = decode<uint8_t>(*bytes, "jpg", OIIO::TypeDesc::UINT8);
  ASSERT_EQ(decoded.width, 301);
  ASSERT_EQ(decoded.channels, 3);
  EXPECT_LT(largest_error(make_picture(301, 77), decoded), 90);  // at the hard edge of the corner
}

TEST(EncodePicture, AJpegFromCoarseToFineHasTheSamePixelsInFewerBytes) {
  const picture::Image image = make_picture(301, 77);
  const auto rows = encode_picture(image, picture::FileFormat::kJpeg, 90);
  const auto scans = encode_picture(image, picture::FileFormat::kJpeg, 90, picture::JpegOrder::kScans);
  ASSERT_TRUE(rows && scans);
  EXPECT_LT(scans->size(), rows->size());
  EXPECT_EQ(decode<uint8_t>(*rows, "jpg", OIIO::TypeDesc::UINT8).values,
            decode<uint8_t>(*scans, "jpg", OIIO::TypeDesc::UINT8).values);
}

TEST(EncodePicture, WebpComesBackClose) {
  const picture::Image image = make_picture(301, 77);
  const auto bytes = encode_picture(image, picture::FileFormat::kWebp, 95);
  ASSERT_TRUE(bytes);
  const auto decoded = decode<uint8_t>(*bytes, "webp", OIIO::TypeDesc::UINT8);
  ASSERT_EQ(decoded.width, 301);
  ASSERT_EQ(decoded.height, 77);
  EXPECT_LT(largest_error(image, decoded), 90);
}

TEST(EncodePicture, LowerQualityGivesSmallerFiles) {
  const picture::Image image = make_picture(640, 480);
  for (const picture::FileFormat format : {picture::FileFormat::kJpeg, picture::FileFormat::kWebp}) {
    const auto low = encode_picture(image, format, 20);
    const auto high = encode_picture(image, format, 95);
    ASSERT_TRUE(low && high);
    EXPECT_LT(low->size(), high->size());
  }
}

TEST(EncodePicture, ExrKeepsLinearFloatsToTheLastBit) {
  const picture::Image image = make_light(40, 30);
  const auto bytes = encode_picture(image, picture::FileFormat::kExr, 90);
  ASSERT_TRUE(bytes);
  const auto decoded = decode<float>(*bytes, "exr", OIIO::TypeDesc::FLOAT);
  ASSERT_EQ(decoded.channels, 3);
  ASSERT_EQ(decoded.values.size(), 40u * 30u * 3u);
  EXPECT_EQ(decoded.values[3 * 7], 0.001F * 7);
  EXPECT_EQ(decoded.values[3 * 7 + 1], 12345.678F);
  EXPECT_EQ(decoded.values[3 * 7 + 2], -1e-6F);
}

TEST(EncodePicture, ChannelsComeBackToTheLastBitAndTheColorsStayTheSame) {
  const picture::Image image = make_light(70, 130);
  picture::Channels channels;
  channels.channels = {{"Z"}, {"N.X"}, {"id", true}};
  channels.origin = {1'234'567.890123456789, -2, 1e-9};
  const float infinite = std::numeric_limits<float>::infinity();
  for (uint32_t i = 0; i < 70 * 130; ++i) {
    const uint32_t depth = std::bit_cast<uint32_t>(i % 7 == 0 ? infinite : 0.1F * static_cast<float>(i));
    channels.words.insert(channels.words.end(), {depth, std::bit_cast<uint32_t>(-0.5F), 0xffffff00U + i % 256});
  }
  const auto bytes = encode_picture(image, picture::FileFormat::kExr, 90, picture::JpegOrder::kRows, &channels);
  ASSERT_TRUE(bytes);
  OIIO::Filesystem::IOMemReader memory(const_cast<std::byte*>(bytes->data()), bytes->size());
  const auto input = OIIO::ImageInput::open("memory.exr", nullptr, &memory);
  ASSERT_TRUE(input);
  const OIIO::ImageSpec& spec = input->spec();
  ASSERT_EQ(spec.nchannels, 6);
  glm::dvec3 origin(0);
  ASSERT_TRUE(
      spec.getattribute("surfcast:origin", OIIO::TypeDesc(OIIO::TypeDesc::DOUBLE, OIIO::TypeDesc::VEC3), &origin.x));
  EXPECT_EQ(origin, channels.origin);
  std::vector<uint32_t> words(size_t{70} * 130 * 6);
  ASSERT_TRUE(input->read_image(0, 0, 0, 6, OIIO::TypeDesc::UNKNOWN, words.data()));
  const std::vector<std::string> names{"R", "G", "B", "Z", "N.X", "id"};
  for (size_t i = 0; i < size_t{70} * 130; ++i) {
    for (size_t c = 0; c < 6; ++c) {
      const auto place = static_cast<size_t>(spec.channelindex(names[c]));
      ASSERT_LT(place, 6U) << names[c];
      uint32_t expected = 0;
      if (c < 3) std::memcpy(&expected, image.pixels.data() + 16 * i + 4 * c, 4);
      if (c >= 3) expected = channels.words[3 * i + c - 3];
      ASSERT_EQ(words[6 * i + place], expected) << names[c] << ' ' << i;
    }
  }
  EXPECT_EQ(*encode_picture(image, picture::FileFormat::kExr, 90, picture::JpegOrder::kRows, &channels), *bytes);
}

TEST(EncodePicture, TheSameImageGivesTheSameBytes) {
  for (const picture::FileFormat format :
       {picture::FileFormat::kPng, picture::FileFormat::kJpeg, picture::FileFormat::kWebp, picture::FileFormat::kExr}) {
    const picture::Image image = format == picture::FileFormat::kExr ? make_light(40, 30) : make_picture(200, 100);
    const auto first = encode_picture(image, format, 90);
    const auto second = encode_picture(image, format, 90);
    ASSERT_TRUE(first && second);
    EXPECT_TRUE(*first == *second);
  }
}

TEST(EncodePicture, OnePixelIsAPicture) {
  for (const picture::FileFormat format :
       {picture::FileFormat::kPng, picture::FileFormat::kJpeg, picture::FileFormat::kWebp}) {
    EXPECT_TRUE(encode_picture(make_picture(1, 1), format, 90));
  }
  EXPECT_TRUE(encode_picture(make_light(1, 1), picture::FileFormat::kExr, 90));
}

TEST(EncodePicture, ASideBeyondTheFormatIsAnErrorAndNotACrash) {
  EXPECT_FALSE(encode_picture(make_picture(16384, 1), picture::FileFormat::kWebp, 90));  // ends at 16383 pixels
  EXPECT_FALSE(encode_picture(make_picture(65501, 1), picture::FileFormat::kJpeg, 90));  // at 65500
  EXPECT_FALSE(
      encode_picture(make_picture(1000001, 1), picture::FileFormat::kPng, 90));  // at a million, by libpng's own limit
}

}  // namespace
}  // namespace surfcast::encode
