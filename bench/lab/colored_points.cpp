#include "lab/colored_points.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "lab/witness.h"
#include "reference/linear_picture.h"
#include "render/color_maps.h"

namespace surfcast::lab {
namespace {

/// The colours of the topographic map, from the second to the 98th percentile of the elevation.
std::vector<glm::u8vec3> elevation_colors(const LabPoints& points) {
  std::vector<double> heights;
  for (const glm::dvec3& p : points.positions) heights.push_back(points.z_up ? p.z : p.y);
  std::vector<double> sorted = heights;
  std::ranges::sort(sorted);
  const double low = sorted[sorted.size() / 50];
  const double high = sorted[sorted.size() - 1 - sorted.size() / 50];
  std::vector<glm::u8vec3> colors;
  for (const double height : heights) {
    const double share = low < high ? std::clamp((height - low) / (high - low), 0.0, 1.0) : 0.5;
    colors.emplace_back(255.0 * render::map_color(picture::ColorMap::kTerrain, share) + 0.5);
  }
  return colors;
}

/// A colour in the light that falls on a surface with the normal `n`, of either sign.
glm::u8vec3 lit(const glm::u8vec3& color, const glm::dvec3& n, bool z_up) {
  constexpr double kAmbient = 0.15;
  const glm::dvec3 light = glm::normalize(z_up ? glm::dvec3(0.4, -0.5, 0.8) : glm::dvec3(0.4, 0.8, 0.5));
  const double share = kAmbient + (1 - kAmbient) * std::abs(glm::dot(n, light));
  return reference::srgb8_from_linear(share * reference::linear_from_srgb8(glm::dvec3(color)));
}

}  // namespace

std::vector<glm::u8vec3> colors_for(const LabPoints& points) {
  std::vector<glm::u8vec3> colors = intensity_levels(points.intensities);
  if (colors.empty()) colors = elevation_colors(points);
  const std::vector<WitnessPoint> witness = make_witness(points.positions);
  for (size_t i = 0; i < colors.size(); ++i) colors[i] = lit(colors[i], witness[i].normal, points.z_up);
  return colors;
}

}  // namespace surfcast::lab
