#pragma once

#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "reference/linear_picture.h"

namespace surfcast::reference {

/// Premultiplied colour and opacity of every pixel, rows from top to bottom.
struct LightPicture {
  int width = 0;
  int height = 0;
  std::vector<glm::dvec4> pixels;

  LightPicture() = default;
  LightPicture(int w, int h) : width(w), height(h), pixels(static_cast<size_t>(w) * h) {}
  [[nodiscard]] size_t index(int x, int y) const { return static_cast<size_t>(y) * width + x; }
};

/// Premultiplied colour and opacity at a position of the picture, in pixels from its top left corner.
using LightSampler = std::function<glm::dvec4(const glm::dvec2& pixel)>;

/// The picture of `sample` at the centres of the pixels.
LightPicture sampled_picture(int width, int height, const LightSampler& sample);
/// The picture of `sample`, filtered with the pixel prefilter: a Gaussian with a variance of 1 px^2, cut at 4 px. Takes
/// a regular lattice of `samples` x `samples` per pixel, at positions up to 4.5 pixels outside of the picture.
LightPicture prefiltered_picture(int width, int height, int samples, const LightSampler& sample);

/// The same filter on a lattice of `samples` x `samples` per pixel that reaches kFilterReach pixels over the picture.
constexpr int kFilterReach = 4;
/// Lattices that are filtered already take a smaller standard deviation, pixels.
LightPicture reduced(const LightPicture& lattice, int samples, double deviation = 1);
/// The same filter on a finished picture; what lies outside of it repeats its border.
LightPicture filtered(const LightPicture& picture);
/// A picture without a border of `pixels` on every side.
LightPicture inner_part(const LightPicture& picture, int pixels);

/// Colours in linear light over black as 8 bit sRGB.
SrgbPicture encode(const LightPicture& picture);
/// Colours that are sRGB codes in [0, 1] already, over black.
SrgbPicture encode_codes(const LightPicture& picture);

/// Peak signal to noise ratio over the pixels that either picture covers (opacity above half a level), dB; over black.
double covered_psnr(const LightPicture& a, const LightPicture& b);
/// The same for pictures of sRGB codes.
double covered_psnr_of_codes(const LightPicture& a, const LightPicture& b);
/// The same over values in linear light without quantisation, for comparisons of methods that agree closely.
double linear_psnr(const LightPicture& a, const LightPicture& b);

}  // namespace surfcast::reference
