#include "reference/linear_picture.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "base/contract.h"

namespace surfcast::reference {
namespace {

uint8_t to_level(double encoded) {
  return static_cast<uint8_t>(std::lround(255 * std::clamp(encoded, 0.0, 1.0)));
}

}  // namespace

double linear_from_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

double srgb_from_linear(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

glm::dvec3 linear_from_srgb(const glm::dvec3& encoded) {
  return {linear_from_srgb(encoded.x), linear_from_srgb(encoded.y), linear_from_srgb(encoded.z)};
}

glm::dvec3 linear_from_srgb8(const glm::dvec3& levels) {
  return linear_from_srgb(levels / 255.0);
}

glm::u8vec3 srgb8_from_linear(const glm::dvec3& linear) {
  return {to_level(srgb_from_linear(linear.x)), to_level(srgb_from_linear(linear.y)),
          to_level(srgb_from_linear(linear.z))};
}

SrgbPicture encode(const LinearPicture& picture) {
  SrgbPicture encoded{picture.width, picture.height, std::vector<glm::u8vec3>(picture.pixels.size())};
  std::transform(picture.pixels.begin(), picture.pixels.end(), encoded.pixels.begin(), srgb8_from_linear);
  return encoded;
}

double psnr(const SrgbPicture& a, const SrgbPicture& b) {
  SURFCAST_EXPECTS(a.width == b.width && a.height == b.height && !a.pixels.empty());
  double sum = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    const glm::dvec3 d = glm::dvec3(a.pixels[i]) - glm::dvec3(b.pixels[i]);
    sum += glm::dot(d, d);
  }
  if (sum == 0) return std::numeric_limits<double>::infinity();
  return 10 * std::log10(255.0 * 255.0 * 3 * static_cast<double>(a.pixels.size()) / sum);
}

SrgbPicture difference(const SrgbPicture& a, const SrgbPicture& b, double gain) {
  SURFCAST_EXPECTS(a.width == b.width && a.height == b.height);
  SrgbPicture result{a.width, a.height, std::vector<glm::u8vec3>(a.pixels.size())};
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    const glm::dvec3 d = gain * glm::abs(glm::dvec3(a.pixels[i]) - glm::dvec3(b.pixels[i]));
    result.pixels[i] = glm::u8vec3(glm::min(d, glm::dvec3(255)));
  }
  return result;
}

bool write_ppm(const std::filesystem::path& path, const SrgbPicture& picture) {
  std::ofstream file(path, std::ios::binary);
  file << "P6\n" << picture.width << ' ' << picture.height << "\n255\n";
  for (const glm::u8vec3& p : picture.pixels) {
    file.put(static_cast<char>(p.x)).put(static_cast<char>(p.y)).put(static_cast<char>(p.z));
  }
  return file.good();
}

}  // namespace surfcast::reference
