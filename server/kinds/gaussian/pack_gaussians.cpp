#include "gaussian/pack_gaussians.h"

#include <algorithm>

#include "shared/gaussian_layout.h"

namespace surfcast::gaussian {
namespace {

constexpr int kPositionBits = 20;
constexpr uint32_t kLowRotation = 5;  // bits of a part that are stored apart

static_assert(SURFCAST_SCALE_STEPS == kScaleSteps && SURFCAST_ROTATION_HALF == kRotationHalf);
static_assert(SURFCAST_COLOR_STEPS == kColorSteps && SURFCAST_HARMONIC_HALF == kHarmonicHalf);

/// The code of the file at which the codes of the GPU begin. Thinner deviations are drawn as thick as that: a
/// 65536th of the largest.
int zero_of(const GaussianCodes& codes) {
  int largest = 1;
  for (const glm::u16vec3& s : codes.scales) largest = std::max({largest, int{s.x}, int{s.y}, int{s.z}});
  return largest - (SURFCAST_SCALE_CODES - 1);
}

uint32_t scale_code(uint16_t code, int zero) {
  return code == 0 ? 0 : static_cast<uint32_t>(std::max(1, int{code} - zero));
}

uint32_t high_parts(const RotationCode& code) {
  uint32_t word = code.largest;
  for (uint32_t i = 0; i < 3; ++i) word |= static_cast<uint32_t>(code.parts.at(i) >> kLowRotation) << (2 + 10 * i);
  return word;
}

uint32_t low_parts(const RotationCode& code) {
  uint32_t word = 0;
  for (uint32_t i = 0; i < 3; ++i) word |= (code.parts.at(i) & ((1U << kLowRotation) - 1)) << (kLowRotation * i);
  return word;
}

uint32_t four_bytes(const uint8_t* bytes) {
  return uint32_t{bytes[0]} | (uint32_t{bytes[1]} << 8) | (uint32_t{bytes[2]} << 16) | (uint32_t{bytes[3]} << 24);
}

void append_gaussian(const GaussianCodes& codes, size_t i, int zero, std::vector<glm::uvec4>& texels) {
  const glm::uvec3& p = codes.positions[i];
  const glm::u16vec3& s = codes.scales[i];
  texels.emplace_back(p.x | (scale_code(s.x, zero) << kPositionBits), p.y | (scale_code(s.y, zero) << kPositionBits),
                      p.z | (scale_code(s.z, zero) << kPositionBits), high_parts(codes.rotations[i]));
  // The first word of coefficients has one, so that the others begin at words.
  const uint32_t each = texels_per_gaussian(codes.traits.degree);
  const size_t width = varying_coefficients(codes.traits.degree);
  std::vector<uint8_t> bytes(3, 0);
  const auto first = codes.harmonics.begin() + static_cast<ptrdiff_t>(i * width);
  bytes.insert(bytes.end(), first, first + static_cast<ptrdiff_t>(width));
  bytes.resize(12 + size_t{each - 2} * SURFCAST_TEXEL_COEFFICIENTS, kHarmonicHalf);
  const glm::uvec3 c(codes.colors[i]);
  texels.emplace_back(low_parts(codes.rotations[i]) | (uint32_t{codes.opacities[i]} << 15) | ((c.r >> 2) << 23),
                      (c.r & 3U) | (c.g << 2) | (c.b << 13) | (uint32_t{bytes[3]} << 24), four_bytes(&bytes[4]),
                      four_bytes(&bytes[8]));
  for (size_t at = 12; at < bytes.size(); at += 16) {
    texels.emplace_back(four_bytes(&bytes[at]), four_bytes(&bytes[at + 4]), four_bytes(&bytes[at + 8]),
                        four_bytes(&bytes[at + 12]));
  }
}

}  // namespace

PackedGaussians pack_gaussians(const GaussianCodes& codes, uint32_t page) {
  const int zero = zero_of(codes);
  PackedGaussians packed;
  packed.log2_zero = static_cast<double>(zero) / kScaleSteps - kScaleRange;
  const uint32_t each = texels_per_gaussian(codes.traits.degree);
  packed.texels.reserve(packed_texels(codes.size(), codes.traits.degree, page));
  for (size_t i = 0; i < codes.size(); ++i) {
    if (packed.texels.size() % page + each > page) packed.texels.resize((packed.texels.size() / page + 1) * page);
    append_gaussian(codes, i, zero, packed.texels);
  }
  return packed;
}

}  // namespace surfcast::gaussian
