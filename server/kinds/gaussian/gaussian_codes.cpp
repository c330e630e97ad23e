#include "gaussian/gaussian_codes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace surfcast::gaussian {
namespace {

constexpr double kLargestPart = std::numbers::sqrt2 / 2;  // of a component that is not the largest
constexpr int kRangeSteps = 8;                            // of the ranges of coefficients, per octave
constexpr int kRangeOctaves = 16;                         // code 0 is 2^-16

uint16_t encode_color(double coefficient) {
  const double code = (0.5 + kConstantHarmonic * coefficient + 1) * kColorSteps;
  return static_cast<uint16_t>(std::clamp(std::round(code), 0.0, double{kMaxColorCode}));
}

float decode_color(uint16_t code) {
  return coefficient_of(static_cast<double>(code) / kColorSteps - 1);
}

/// On a square scale: most coefficients are far smaller than the largest of a block.
uint8_t encode_coefficient(double value, double range) {
  const double root = std::sqrt(std::min(1.0, std::abs(value) / range)) * kHarmonicHalf;
  return static_cast<uint8_t>(kHarmonicHalf + static_cast<int>(std::round(value < 0 ? -root : root)));
}

float decode_coefficient(uint8_t code, double range) {
  const double root = (static_cast<double>(code) - kHarmonicHalf) / kHarmonicHalf;
  return static_cast<float>(root * std::abs(root) * range);
}

std::array<uint8_t, kMaxDegree> ranges_of(const Gaussians& gaussians, size_t width) {
  std::array<float, kMaxDegree> largest{};
  for (size_t i = 0; i < gaussians.harmonics.size(); ++i) {
    if (i % width < 3) continue;
    float& most = largest.at(static_cast<size_t>(degree_of_coefficient(i % width - 3)) - 1);
    most = std::max(most, std::abs(gaussians.harmonics[i]));
  }
  std::array<uint8_t, kMaxDegree> codes{};
  std::transform(largest.begin(), largest.end(), codes.begin(), encode_range);
  return codes;
}

void encode_harmonics(std::span<const float> values, GaussianCodes& codes) {
  codes.colors.emplace_back(encode_color(values[0]), encode_color(values[1]), encode_color(values[2]));
  for (size_t i = 3; i < values.size(); ++i) {
    const double range = decode_range(codes.ranges.at(static_cast<size_t>(degree_of_coefficient(i - 3)) - 1));
    codes.harmonics.push_back(encode_coefficient(values[i], range));
  }
}

void decode_harmonics(const GaussianCodes& codes, size_t i, Gaussians& gaussians) {
  for (int channel = 0; channel < 3; ++channel) gaussians.harmonics.push_back(decode_color(codes.colors[i][channel]));
  const size_t width = varying_coefficients(codes.traits.degree);
  for (size_t k = 0; k < width; ++k) {
    const double range = decode_range(codes.ranges.at(static_cast<size_t>(degree_of_coefficient(k)) - 1));
    gaussians.harmonics.push_back(decode_coefficient(codes.harmonics[i * width + k], range));
  }
}

}  // namespace

int degree_of_coefficient(size_t coefficient) {
  const size_t function = coefficient / 3 + 1;
  int degree = 1;
  while (harmonics_of(degree) <= function) ++degree;
  return degree;
}

uint16_t encode_scale(float deviation) {
  if (!(deviation > 0)) return 0;
  const double code = std::round((std::log2(double{deviation}) + kScaleRange) * kScaleSteps);
  return static_cast<uint16_t>(std::clamp(code, 1.0, 65535.0));
}

double decode_scale(uint16_t code) {
  return code == 0 ? 0 : std::exp2(static_cast<double>(code) / kScaleSteps - kScaleRange);
}

RotationCode encode_rotation(const glm::quat& unit) {
  const std::array<double, 4> parts{double{unit.w}, double{unit.x}, double{unit.y}, double{unit.z}};
  const auto smaller = [](double a, double b) { return std::abs(a) < std::abs(b); };
  const auto largest = static_cast<size_t>(std::max_element(parts.begin(), parts.end(), smaller) - parts.begin());
  const double sign = parts.at(largest) < 0 ? -1 : 1;
  RotationCode code{static_cast<uint8_t>(largest), {}};
  for (size_t i = 0, at = 0; i < parts.size(); ++i) {
    if (i == largest) continue;
    const double step = std::round(sign * parts.at(i) / kLargestPart * kRotationHalf);
    code.parts.at(at++) =
        static_cast<uint16_t>(std::clamp(step, -1.0 * kRotationHalf, 1.0 * kRotationHalf) + kRotationHalf);
  }
  return code;
}

glm::dquat decode_rotation(const RotationCode& code) {
  std::array<double, 4> parts{};
  double rest = 1;
  for (size_t i = 0, at = 0; i < parts.size(); ++i) {
    if (i == code.largest) continue;
    parts.at(i) = (static_cast<double>(code.parts.at(at++)) - kRotationHalf) / kRotationHalf * kLargestPart;
    rest -= parts.at(i) * parts.at(i);
  }
  parts.at(code.largest) = std::sqrt(std::max(0.0, rest));
  return {parts[0], parts[1], parts[2], parts[3]};
}

uint8_t encode_range(float largest) {
  if (!(largest > 0)) return 0;
  const double code = std::ceil((std::log2(double{largest}) + kRangeOctaves) * kRangeSteps);
  return static_cast<uint8_t>(std::clamp(code, 0.0, 255.0));
}

double decode_range(uint8_t code) {
  return std::exp2(static_cast<double>(code) / kRangeSteps - kRangeOctaves);
}

GaussianCodes encode_shapes(const Gaussians& gaussians, const BlockTraits& traits) {
  GaussianCodes codes;
  codes.traits = traits;
  const size_t width = 3 * harmonics_of(traits.degree);
  codes.ranges = ranges_of(gaussians, width);
  codes.harmonics.reserve(gaussians.size() * (width - 3));
  for (size_t i = 0; i < gaussians.size(); ++i) {
    const glm::vec3& s = gaussians.scales[i];
    codes.scales.emplace_back(encode_scale(s.x), encode_scale(s.y), encode_scale(s.z));
    codes.rotations.push_back(encode_rotation(gaussians.rotations[i]));
    codes.opacities.push_back(static_cast<uint8_t>(std::lround(255 * gaussians.opacities[i])));
    encode_harmonics(std::span(gaussians.harmonics).subspan(i * width, width), codes);
  }
  return codes;
}

Gaussians decode_shapes(const GaussianCodes& codes) {
  Gaussians gaussians;
  gaussians.harmonics.reserve(codes.size() * 3 * harmonics_of(codes.traits.degree));
  for (size_t i = 0; i < codes.size(); ++i) {
    const glm::u16vec3& s = codes.scales[i];
    gaussians.scales.emplace_back(decode_scale(s.x), decode_scale(s.y), decode_scale(s.z));
    gaussians.rotations.emplace_back(decode_rotation(codes.rotations[i]));
    gaussians.opacities.push_back(static_cast<float>(codes.opacities[i]) / 255);
    decode_harmonics(codes, i, gaussians);
  }
  return gaussians;
}

}  // namespace surfcast::gaussian
