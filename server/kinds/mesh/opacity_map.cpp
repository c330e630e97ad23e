#include "mesh/opacity_map.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include <oneapi/tbb/parallel_for.h>

#include "mesh/chart_map.h"
#include "mesh/texel_color.h"
#include "surfel/srgb.h"

namespace surfcast::mesh {
namespace {

bool is_opaque(const Texture& image) {
  return std::all_of(image.texels.begin(), image.texels.end(), [](const auto& texel) { return texel[3] == 255; });
}

/// kAuto as what it means for an image.
OpacityChannel channel_in(const Texture& image, OpacityChannel channel) {
  return channel == OpacityChannel::kAuto && is_opaque(image) ? OpacityChannel::kLuminance : channel;
}

/// The number that states the opacity of a texel. It is no colour: its code is not that of sRGB.
uint8_t opacity_code(const std::array<uint8_t, 4>& texel, OpacityChannel channel) {
  switch (channel) {
    case OpacityChannel::kAuto:
      return texel[3];
    case OpacityChannel::kRed:
      return texel[0];
    case OpacityChannel::kGreen:
      return texel[1];
    case OpacityChannel::kBlue:
      return texel[2];
    case OpacityChannel::kLuminance:
      break;
  }
  return static_cast<uint8_t>(std::lround(0.2126 * texel[0] + 0.7152 * texel[1] + 0.0722 * texel[2]));
}

/// White texels whose alpha is the opacity.
Texture opacities_of(const Texture& image, OpacityChannel channel) {
  Texture opacities{image.width, image.height, {}};
  opacities.texels.reserve(image.texels.size());
  for (const auto& texel : image.texels) {
    opacities.texels.push_back({255, 255, 255, opacity_code(texel, channel)});
  }
  return opacities;
}

/// A texture at the texels of one that is at least as fine along each axis.
class FinerTexels {
 public:
  FinerTexels(const Texture& texture, const glm::ivec2& size, std::span<const Patch* const> patches,
              const std::array<Wrap, 2>& wrap)
      : texture_(texture),
        step_(glm::dvec2(texture.size()) / glm::dvec2(size)),
        wrap_(wrap),
        charts_(patches, texture.size(), wrap) {}

  [[nodiscard]] glm::vec4 light(int64_t x, int64_t y, uint32_t chart) const {
    const TexelArea area{(glm::dvec2(x, y) + 0.5) * step_, step_};
    return mean_light(texture_, area, wrap_, false, &charts_, chart);
  }

 private:
  const Texture& texture_;
  glm::dvec2 step_;  ///< texels of the texture for one of the finer one
  const std::array<Wrap, 2>& wrap_;
  ChartMap charts_;
};

std::array<uint8_t, 4> texel_of(const glm::vec4& light) {
  const glm::u8vec3 code(surfel::from_linear(glm::vec3(light), 8));
  return {code.r, code.g, code.b, static_cast<uint8_t>(std::lround(light.a * 255.0F))};
}

}  // namespace

std::optional<glm::ivec2> MaterialImages::size() const {
  if (color != nullptr && opacity != nullptr) return glm::max(color->size(), opacity->size());
  if (color != nullptr) return color->size();
  return opacity != nullptr ? std::optional(opacity->size()) : std::nullopt;
}

std::optional<Texture> join_opacity(const MaterialImages& images, const Material& material,
                                    std::span<const Patch* const> patches) {
  if (images.opacity == nullptr || !material.opacity) return std::nullopt;
  const OpacityChannel channel = channel_in(*images.opacity, material.opacity->channel);
  if (images.opacity == images.color && channel == OpacityChannel::kAuto) return std::nullopt;
  const glm::ivec2 size = *images.size();
  const ChartMap charts(patches, size, material.wrap);
  const Texture values = opacities_of(*images.opacity, channel);
  const FinerTexels opacities(values, size, patches, material.wrap);
  std::optional<FinerTexels> colors;
  if (images.color != nullptr) colors.emplace(*images.color, size, patches, material.wrap);
  Texture joined{size.x, size.y, {}};
  joined.texels.resize(static_cast<size_t>(size.x) * static_cast<size_t>(size.y));
  oneapi::tbb::parallel_for(int64_t{0}, joined.height, [&](int64_t y) {
    for (int64_t x = 0; x < joined.width; ++x) {
      const uint32_t chart = charts.owner(x, y);
      glm::vec4 light = colors ? colors->light(x, y, chart) : glm::vec4(1);
      light.a *= opacities.light(x, y, chart).a;
      joined.texels[static_cast<size_t>(y * joined.width + x)] = texel_of(light);
    }
  });
  return joined;
}

}  // namespace surfcast::mesh
