#include "volume/brick_coding.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zstd.h>

#include "volume/differences.h"

namespace surfcast::volume {
namespace {

BrickHeader place_of(const glm::u32vec3& count) {
  BrickHeader place;
  place.count = count;
  return place;
}

template <typename Sample>
std::vector<double> samples_of(const glm::u32vec3& count, const Sample& sample) {
  std::vector<double> samples;
  const glm::u32vec3 size = stored_size(count);
  for (uint32_t k = 0; k < size.z; ++k) {
    for (uint32_t j = 0; j < size.y; ++j) {
      for (uint32_t i = 0; i < size.x; ++i) samples.push_back(sample(i, j, k));
    }
  }
  return samples;
}

/// Samples that come back from the bytes of a block.
std::vector<double> round_trip(const glm::u32vec3& count, std::span<const double> samples, const SampleScale& scale) {
  const Brick brick = make_brick(place_of(count), samples, scale);
  const Result<Brick> decoded = decode_brick(encode_brick(brick), place_of(count));
  if (!decoded) return {};
  EXPECT_EQ(decoded->codes, brick.codes);
  EXPECT_EQ(decoded->header.low, brick.header.low);
  EXPECT_EQ(decoded->header.high, brick.header.high);
  std::vector<double> values;
  for (const uint16_t code : decoded->codes) values.push_back(decoded->header.value(code));
  return values;
}

std::string fault_of(std::span<const std::byte> bytes, const glm::u32vec3& count) {
  const Result<Brick> brick = decode_brick(bytes, place_of(count));
  return brick ? std::string() : brick.error().message;
}

TEST(Differences, come_back_from_any_number_of_axes) {
  std::mt19937 random(1);
  for (const glm::u32vec3 size : {glm::u32vec3(36), glm::u32vec3(5, 7, 36), glm::u32vec3(5)}) {
    std::vector<uint16_t> codes(size_t{size.x} * size.y * size.z);
    for (uint16_t& code : codes) code = static_cast<uint16_t>(random());
    for (uint32_t axes = 0; axes <= kDifferenceAxes; ++axes) {
      std::vector<uint16_t> changed = codes;
      take_differences(changed, size, axes);
      sum_differences(changed, size, axes);
      EXPECT_EQ(changed, codes) << axes;
    }
  }
}

TEST(Differences, of_a_linear_field_vanish) {
  const glm::u32vec3 size(36);
  std::vector<uint16_t> codes;
  for (uint32_t t = 0; t < 36 * 36 * 36; ++t) {
    codes.push_back(static_cast<uint16_t>(100 + 3 * (t % 36) + 5 * (t / 36 % 36) + 7 * (t / 36 / 36)));
  }
  take_differences(codes, size, 3);
  EXPECT_EQ(std::ranges::count(codes, 0), 36 * 36 * 36 - (3 * 35 + 1));
}

TEST(BrickCoding, integers_come_back_exactly) {
  const glm::u32vec3 count(32, 9, 1);
  for (const double first : {0.0, -32768.0, 4294901760.0, -9007199254740992.0}) {
    const auto samples = samples_of(
        count, [&](uint32_t i, uint32_t j, uint32_t k) { return first + (i * 1821 + j * 7 + k * 31) % 65536; });
    EXPECT_EQ(round_trip(count, samples, {1, 0, 1}), samples);
  }
}

TEST(BrickCoding, slope_and_intercept_are_applied_to_the_samples) {
  const glm::u32vec3 count(4);
  const auto samples =
      samples_of(count, [](uint32_t i, uint32_t j, uint32_t k) { return double(i + 10 * j + 100 * k); });
  for (const double slope : {0.25, -0.5}) {
    const std::vector<double> values = round_trip(count, samples, {slope, -1024, 1});
    ASSERT_EQ(values.size(), samples.size());
    for (size_t i = 0; i < samples.size(); ++i) EXPECT_EQ(values[i], slope * samples[i] - 1024);
  }
}

TEST(BrickCoding, floats_are_within_half_a_step_of_the_range_of_their_brick) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-3e-4, 5e-4);
  const glm::u32vec3 count(32);
  for (const double scale : {1.0, 1e-30, 1e30}) {
    const auto samples = samples_of(count, [&](uint32_t, uint32_t, uint32_t) { return scale * uniform(random); });
    const auto [low, high] = std::ranges::minmax(samples);
    const std::vector<double> values = round_trip(count, samples, {});
    ASSERT_EQ(values.size(), samples.size());
    for (size_t i = 0; i < samples.size(); ++i) EXPECT_NEAR(values[i], samples[i], (high - low) / 131070 * 1.0001);
    EXPECT_EQ(std::ranges::min(values), low);
    EXPECT_NEAR(std::ranges::max(values), high, 1e-12 * scale);
  }
}

TEST(BrickCoding, integers_with_a_wide_range_are_coded_like_floats) {
  const glm::u32vec3 count(2);
  const auto samples = samples_of(count, [](uint32_t i, uint32_t, uint32_t) { return i * 1e6; });
  const std::vector<double> values = round_trip(count, samples, {1, 0, 1});
  for (size_t i = 0; i < samples.size(); ++i) EXPECT_NEAR(values[i], samples[i], 5e6 / 131070);
}

TEST(BrickCoding, means_are_rounded_to_steps_that_neighbouring_bricks_share) {
  const glm::u32vec3 count(1);
  const auto near = samples_of(count, [](uint32_t i, uint32_t, uint32_t) { return 10.03 + i; });
  const auto far = samples_of(count, [](uint32_t i, uint32_t, uint32_t) { return 9.71 + 0.32 * i; });
  EXPECT_EQ(round_trip(count, near, {1, 0, 0.125})[0], 10.0);
  EXPECT_EQ(round_trip(count, far, {1, 0, 0.125})[1], 10.0);
}

TEST(BrickCoding, a_constant_field_takes_no_space_and_is_exact) {
  const glm::u32vec3 count(32);
  for (const double value : {0.0, -1024.0, 0.1, 1e300}) {
    const auto samples = samples_of(count, [&](uint32_t, uint32_t, uint32_t) { return value; });
    EXPECT_EQ(round_trip(count, samples, {}), samples);
    EXPECT_EQ(encode_brick(make_brick(place_of(count), samples, {})).size(), 18U);
  }
}

TEST(BrickCoding, the_whole_range_of_doubles_does_not_overflow) {
  const glm::u32vec3 count(1);
  const double most = std::numeric_limits<double>::max() / 4;
  const auto samples = samples_of(count, [&](uint32_t i, uint32_t, uint32_t) { return i % 2 == 0 ? -most : most; });
  const std::vector<double> values = round_trip(count, samples, {});
  EXPECT_EQ(values[0], -most);
  EXPECT_NEAR(values[1] / most, 1, 1e-12);
}

TEST(BrickCoding, damaged_bytes_give_errors_or_other_samples_and_never_more_memory) {
  const glm::u32vec3 count(8);
  std::mt19937 random(3);
  const auto samples = samples_of(count, [&](uint32_t, uint32_t, uint32_t) { return double(random() % 4096); });
  const std::vector<std::byte> bytes = encode_brick(make_brick(place_of(count), samples, {1, 0, 1}));
  for (size_t length = 0; length < bytes.size(); ++length) {
    const std::string fault = fault_of(std::span(bytes).first(length), count);
    EXPECT_FALSE(fault.empty()) << length;
    EXPECT_EQ(fault.find('\n'), std::string::npos);
  }
  for (int round = 0; round < 20000; ++round) {
    std::vector<std::byte> changed = bytes;
    changed[random() % (round % 2 == 0 ? 40 : changed.size())] ^= static_cast<std::byte>(1U << random() % 8);
    const Result<Brick> brick = decode_brick(changed, place_of(count));
    if (!brick) continue;
    EXPECT_EQ(brick->codes.size(), stored_samples(count));
    EXPECT_TRUE(std::isfinite(brick->header.low) && std::isfinite(brick->header.high));
  }
}

TEST(BrickCoding, more_samples_than_the_brick_has_are_refused) {
  const glm::u32vec3 count(8);
  const auto samples = samples_of(count, [](uint32_t i, uint32_t j, uint32_t) { return double(i * j); });
  const std::vector<std::byte> bytes = encode_brick(make_brick(place_of(count), samples, {1, 0, 1}));
  EXPECT_EQ(fault_of(bytes, {8, 8, 7}), "its samples cannot be unpacked");
  EXPECT_EQ(fault_of(bytes, {8, 8, 9}), "it has a wrong number of samples");
  // A frame of gigabytes of zeros.
  std::vector<std::byte> bomb(bytes.begin(), bytes.begin() + 16);
  bomb.push_back(std::byte{0});
  bomb.push_back(std::byte{1});
  const std::vector<std::byte> zeros(size_t{1} << 24);
  std::vector<std::byte> packed(ZSTD_compressBound(zeros.size()));
  packed.resize(ZSTD_compress(packed.data(), packed.size(), zeros.data(), zeros.size(), 1));
  bomb.insert(bomb.end(), packed.begin(), packed.end());
  EXPECT_EQ(fault_of(bomb, count), "its samples cannot be unpacked");
}

TEST(BrickCoding, wrong_scales_are_refused) {
  const glm::u32vec3 count(1);
  const std::vector<double> samples(stored_samples(count), 1.0);
  Brick brick = make_brick(place_of(count), samples, {});
  for (const double scale : {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::max()}) {
    brick.header.scale = scale;
    EXPECT_EQ(fault_of(encode_brick(brick), count), "its scale of values is wrong");
  }
}

}  // namespace
}  // namespace surfcast::volume
