#include "surfel/srgb.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace surfcast::surfel {
namespace {

double brightest(int bits) {
  return static_cast<double>((1 << bits) - 1);
}

/// A lookup table: `pow` for every surfel would cost more than averaging the colours.
std::vector<float> make_table(int bits) {
  std::vector<float> table(size_t{1} << bits);
  for (size_t i = 0; i < table.size(); ++i) {
    table[i] = static_cast<float>(decode_srgb(static_cast<double>(i) / brightest(bits)));
  }
  return table;
}

const std::vector<float>& table_of(int bits) {
  static const std::vector<float> table8 = make_table(8);
  static const std::vector<float> table16 = make_table(16);
  return bits == 8 ? table8 : table16;
}

}  // namespace

double decode_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

double encode_srgb(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

glm::vec3 to_linear(const glm::u16vec3& color, int bits) {
  const std::vector<float>& table = table_of(bits);
  const auto at = [&table](uint16_t value) { return table[std::min<size_t>(value, table.size() - 1)]; };
  return {at(color.r), at(color.g), at(color.b)};
}

glm::u16vec3 from_linear(const glm::vec3& light, int bits) {
  const auto quantise = [bits](float value) {
    return static_cast<uint16_t>(std::lround(encode_srgb(std::clamp(double{value}, 0.0, 1.0)) * brightest(bits)));
  };
  return {quantise(light.r), quantise(light.g), quantise(light.b)};
}

}  // namespace surfcast::surfel
