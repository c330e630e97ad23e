#include "render/region.h"

#include <algorithm>
#include <cmath>

#include "shared/kernel.h"
#include "surfel/even_sampling.h"
#include "surfel/srgb.h"

namespace surfcast::render {
namespace {

/// Variance of the prefilter, pixels squared. Of a larger one, 1 would be left after the cut at r^2 = 5. Even samplings
/// get that; uneven ones are nearer to the ideal without (docs/laboratory.md, "The prefilter's variance").
constexpr double kPrefilter = 1;
constexpr double kEvenPrefilter = 1.288;
/// Variance that replaces the prefilter if only the kernel is drawn, pixels squared. It keeps the inverse finite.
constexpr double kNoPrefilter = 1e-4;

float light_of(uint8_t value) {
  return static_cast<float>(surfel::decode_srgb(value / 255.0));
}

}  // namespace

std::vector<Region> cut_into_regions(int width, int height, int margin, int side) {
  const auto side_of = [=](int size) { return size <= side ? size : side - 2 * margin; };
  const int across = side_of(width);
  const int down = side_of(height);
  std::vector<Region> regions;
  for (int y = 0; y < height; y += down) {
    for (int x = 0; x < width; x += across) {
      regions.push_back({x, y, std::min(across, width - x), std::min(down, height - y)});
    }
  }
  return regions;
}

std::vector<Region> halves_of(const Region& region) {
  const int across = tiles_across(region);
  const int down = tiles_down(region);
  if (across * down <= 1) return {};
  Region first = region;
  Region second = region;
  if (across >= down) {
    first.width = across / 2 * SURFCAST_TILE_WIDTH;
    second.x += first.width;
    second.width -= first.width;
  } else {
    first.height = down / 2 * SURFCAST_TILE_HEIGHT;
    second.y += first.height;
    second.height -= first.height;
  }
  return {first, second};
}

Region with_margin(const Region& region, int margin, int width, int height) {
  const int x = std::max(region.x - margin, 0);
  const int y = std::max(region.y - margin, 0);
  return {x, y, std::min(region.x + region.width + margin, width) - x,
          std::min(region.y + region.height + margin, height) - y};
}

int tiles_across(const Region& region) {
  return (region.width + SURFCAST_TILE_WIDTH - 1) / SURFCAST_TILE_WIDTH;
}
int tiles_down(const Region& region) {
  return (region.height + SURFCAST_TILE_HEIGHT - 1) / SURFCAST_TILE_HEIGHT;
}

layout::FrameConstants frame_constants(const geometry::CameraFrame& frame, const Region& region,
                                       const picture::PictureRequest& request, const SurfelFacts& surfels) {
  layout::FrameConstants c;
  c.right = glm::vec4(glm::vec3(frame.right), static_cast<float>(frame.eta));
  c.up = glm::vec4(glm::vec3(frame.up), 0.5F * static_cast<float>(frame.width));
  c.forward = glm::vec4(glm::vec3(frame.forward), 0.5F * static_cast<float>(frame.height));
  c.region = {region.x, region.y, region.width, region.height};
  c.tiles = {tiles_across(region), tiles_down(region), tiles_across(region) * tiles_down(region), 0};
  const double whole = surfels.even ? kEvenPrefilter : kPrefilter;
  const double prefilter = request.filter == picture::Filter::kEwa ? whole : kNoPrefilter;
  // The depth of a medium is the amount of surfels, whatever their overlaps.
  const bool per_surfel =
      request.normalization == picture::Normalization::kSurfel || request.xray == picture::XRay::kDensity;
  const double weight_scale = per_surfel ? surfel::per_surfel_scale(SURFCAST_KERNEL_SIGMA)
                                         : surfel::even_sampling_weight(SURFCAST_KERNEL_SIGMA);
  c.filter_ = {prefilter, SURFCAST_VISIBILITY_PIXELS * SURFCAST_VISIBILITY_PIXELS, weight_scale,
               static_cast<float>(surfel::kRadiusOverSpacing * request.spacing / frame.eta)};
  c.background = {light_of(request.background.r), light_of(request.background.g), light_of(request.background.b),
                  static_cast<float>(request.opacity)};
  c.flags = {surfels.oriented ? 1 : 0, per_surfel ? 1 : 0, surfels.even ? 1 : 0, 0};
  return c;
}

}  // namespace surfcast::render
