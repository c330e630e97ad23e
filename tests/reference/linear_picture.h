#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <vector>

namespace surfcast::reference {

/// Colours in linear light, rows from top to bottom.
struct LinearPicture {
  int width = 0;
  int height = 0;
  std::vector<glm::dvec3> pixels;

  LinearPicture() = default;
  LinearPicture(int w, int h) : width(w), height(h), pixels(static_cast<size_t>(w) * h) {}
  [[nodiscard]] size_t index(int x, int y) const { return static_cast<size_t>(y) * width + x; }
};

/// An 8 bit sRGB picture of three channels, rows from top to bottom.
struct SrgbPicture {
  int width = 0;
  int height = 0;
  std::vector<glm::u8vec3> pixels;
};

/// The sRGB transfer function (IEC 61966-2-1) on values in [0, 1].
double linear_from_srgb(double encoded);
glm::dvec3 linear_from_srgb(const glm::dvec3& encoded);
double srgb_from_linear(double linear);
glm::dvec3 linear_from_srgb8(const glm::dvec3& levels);  ///< levels 0 to 255
glm::u8vec3 srgb8_from_linear(const glm::dvec3& linear);

SrgbPicture encode(const LinearPicture& picture);

/// Peak signal to noise ratio over all channels of all pixels, dB; infinite for equal pictures.
double psnr(const SrgbPicture& a, const SrgbPicture& b);
/// Absolute differences, multiplied by `gain` to make them visible.
SrgbPicture difference(const SrgbPicture& a, const SrgbPicture& b, double gain);

/// Writes a binary PPM for inspection. False when the file cannot be written.
bool write_ppm(const std::filesystem::path& path, const SrgbPicture& picture);

}  // namespace surfcast::reference
