#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace surfcast::gaussian {

using Codebook = std::array<double, 256>;

/// A palette of harmonics beyond the constant.
struct SogPalette {
  uint64_t count = 0;  ///< entries, at most 65536
  int degree = 0;      ///< 1 to 3
  Codebook codebook{};
  std::string centroids;  ///< names of pictures, here and below
  std::string labels;
};

/// The description of a SOG model of version 2 (meta.json).
struct SogMeta {
  uint64_t count = 0;
  bool antialiased = false;
  glm::dvec3 min{0.0};  ///< of the logarithmic positions
  glm::dvec3 max{0.0};
  Codebook scales{};
  Codebook colors{};
  std::string means_low;
  std::string means_high;
  std::string quats;
  std::string scale_codes;
  std::string color_codes;
  std::optional<SogPalette> palette;
};

/// True if text may be such a description.
[[nodiscard]] bool looks_like_sog_meta(std::string_view text);

Result<SogMeta> parse_sog_meta(std::string_view text);

/// The pictures that a description names.
[[nodiscard]] std::vector<std::string> picture_names(const SogMeta& meta);

}  // namespace surfcast::gaussian
