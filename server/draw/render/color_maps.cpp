#include "render/color_maps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <span>

#include "surfel/srgb.h"

namespace surfcast::render {
namespace {

// Colours at even steps of each map, sRGB as 0xrrggbb. Between them, sRGB values are interpolated: the maps are defined
// that way, and other programs show them that way.

/// Perceptually uniform, also with colour vision deficiency: the published map of van der Walt and Smith, 2015, at
/// eighths.
constexpr std::array<uint32_t, 9> kViridis{0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21918c,
                                           0x27ad81, 0x5ec962, 0xaadc32, 0xfde725};
/// A rainbow without its false edges: the published map of Mikhailov, 2019, at fourteenths.
constexpr std::array<uint32_t, 15> kTurbo{0x30123b, 0x4145ab, 0x4675ed, 0x39a2fc, 0x1bcfd4,
                                          0x24eca6, 0x61fc6c, 0xa4fc3b, 0xd1e834, 0xf3c63a,
                                          0xfe9b2d, 0xf36315, 0xd93806, 0xb11901, 0x7a0403};
constexpr std::array<uint32_t, 2> kGray{0x000000, 0xffffff};
/// Colours of topographic maps: lowland greens, uplands, rock, snow.
constexpr std::array<uint32_t, 9> kTerrain{0x1d5b4f, 0x3f8a55, 0x86b061, 0xcfcf7d, 0xdcb873,
                                           0xb98a58, 0x8e6a52, 0xb3a69d, 0xfafafa};

std::span<const uint32_t> steps_of(picture::ColorMap map) {
  switch (map) {
    case picture::ColorMap::kTurbo:
      return kTurbo;
    case picture::ColorMap::kGray:
      return kGray;
    case picture::ColorMap::kTerrain:
      return kTerrain;
    case picture::ColorMap::kViridis:
      break;
  }
  return kViridis;
}

glm::u8vec3 channels(uint32_t rgb) {
  return {rgb >> 16, (rgb >> 8) & 255, rgb & 255};
}

/// The classes that the ASPRS names (LAS 1.4, table 17), by code.
constexpr std::array<uint32_t, 19> kNamedClasses{
    0x8c8c8c,  // never classified
    0xb4b4b4,  // unclassified
    0xa87b4f,  // ground
    0xa6cf5a,  // low vegetation
    0x5fab4a,  // medium vegetation
    0x2a7a3d,  // high vegetation
    0xe0603f,  // building
    0xff2fd0,  // low point, noise
    0xd9a441,  // model key point
    0x2f7fe0,  // water
    0x7a5ea8,  // rail
    0x5d6470,  // road
    0xe8cf86,  // overlap
    0xffe14a,  // wire, guard
    0xffb52e,  // wire, conductor
    0x9b4fd1,  // transmission tower
    0xc58af0,  // wire connector
    0x3fc1c9,  // bridge deck
    0xff4040,  // high noise
};

/// Colours of codes without a name: consecutive hues are a golden section of the circle apart, so neighbouring codes
/// look different.
glm::u8vec3 unnamed_class_color(uint8_t code) {
  const double hue = 6 * std::fmod(code * 0.6180339887, 1.0);
  const auto channel = [hue](double offset) {
    const double x = std::clamp(std::abs(std::fmod(hue + offset, 6.0) - 3) - 1, 0.0, 1.0);
    return static_cast<uint8_t>(std::lround(80 + 150 * x));
  };
  return {channel(0), channel(4), channel(2)};
}

/// The square root of the linear light of an sRGB value.
double linear_root(double encoded) {
  return std::sqrt(surfel::decode_srgb(encoded));
}

/// Unpacked by unpack_linear_color in shaders/include/packing.glsl.
uint32_t packed(const glm::dvec3& srgb) {
  const auto code = [](double value, int largest) { return static_cast<uint32_t>(std::lround(value * largest)); };
  return code(linear_root(srgb.r), 2047) | (code(linear_root(srgb.g), 2047) << 11) |
         (code(linear_root(srgb.b), 1023) << 22);
}

}  // namespace

glm::dvec3 map_color(picture::ColorMap map, double t) {
  const std::span<const uint32_t> steps = steps_of(map);
  const double place = std::clamp(t, 0.0, 1.0) * static_cast<double>(steps.size() - 1);
  const size_t first = std::min(static_cast<size_t>(place), steps.size() - 2);
  const glm::dvec3 low(channels(steps[first]));
  const glm::dvec3 high(channels(steps[first + 1]));
  return glm::mix(low, high, place - static_cast<double>(first)) / 255.0;
}

glm::u8vec3 class_color(uint8_t code) {
  return code < kNamedClasses.size() ? channels(kNamedClasses[code]) : unnamed_class_color(code);
}

std::vector<uint32_t> map_color_table(picture::ColorMap map) {
  std::vector<uint32_t> table;
  table.reserve(kMapEntries);
  for (size_t i = 0; i < kMapEntries; ++i) {
    table.push_back(packed(map_color(map, static_cast<double>(i) / static_cast<double>(kMapEntries - 1))));
  }
  return table;
}

std::vector<uint32_t> class_color_table() {
  std::vector<uint32_t> table;
  table.reserve(256);
  for (int code = 0; code < 256; ++code) {
    table.push_back(packed(glm::dvec3(class_color(static_cast<uint8_t>(code))) / 255.0));
  }
  return table;
}

}  // namespace surfcast::render
