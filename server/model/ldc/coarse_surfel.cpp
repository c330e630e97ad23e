#include "ldc/coarse_surfel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "ldc/coarse_scalars.h"
#include "surfel/opacity.h"
#include "surfel/srgb.h"

namespace surfcast::ldc {
namespace {

/// Significant binary digits of stored averages. The display shows no more.
constexpr int kDigits = 8;

double round_to_digits(double mean) {
  if (mean == 0 || !std::isfinite(mean)) return mean;
  const int exponent = std::ilogb(mean) + 1 - kDigits;
  return exponent > 0 ? std::ldexp(std::round(std::ldexp(mean, -exponent)), exponent) : mean;
}

/// The opacity in steps of the display, in the unit of the attribute. More digits would cost bytes.
double round_opacity(double opacity, const surfel::ScalarValues& column) {
  constexpr double kSteps = 255;
  return std::round(opacity * kSteps) / kSteps * surfel::full_opacity(column);
}

glm::u16vec3 to_color(const glm::vec3& light, int bits) {
  return surfel::from_linear(light, 8) * static_cast<uint16_t>(bits == 8 ? 1 : 257);
}

/// The nearest value of type T.
template <typename T>
T to_value(double mean) {
  if constexpr (std::is_floating_point_v<T>) {
    return static_cast<T>(mean);
  } else {
    constexpr auto kLargest = static_cast<double>(std::numeric_limits<T>::max());
    const double rounded = std::round(mean);
    if (!(rounded < kLargest)) return std::numeric_limits<T>::max();
    return static_cast<T>(std::max(rounded, static_cast<double>(std::numeric_limits<T>::lowest())));
  }
}

/// Sets the member of a coarse surfel that holds value i of a scalar attribute.
void take(const surfel::ScalarAttribute& scalar, size_t i, CoarseSurfel& surfel) {
  if (scalar.name == surfel::kOpacityAttribute) {
    surfel.opacity = static_cast<float>(surfel::opacity_at(scalar.values, i));
  } else {
    const double value = std::visit([i](const auto& column) { return static_cast<double>(column[i]); }, scalar.values);
    (scalar.name == "intensity" ? surfel.intensity : surfel.classification) = value;
  }
}

/// The value of a scalar attribute to be stored.
double stored_value(const CoarseSurfel& surfel, const surfel::ScalarAttribute& scalar) {
  if (scalar.name == surfel::kOpacityAttribute) return round_opacity(double{surfel.opacity}, scalar.values);
  return scalar.name == "intensity" ? round_to_digits(surfel.intensity) : surfel.classification;
}

surfel::ScalarAttribute without_values(const surfel::ScalarAttribute& scalar) {
  return {scalar.name,
          std::visit([](const auto& values) { return surfel::ScalarValues(std::decay_t<decltype(values)>()); },
                     scalar.values)};
}

}  // namespace

CoarseAttributes coarse_attributes(const surfel::SurfelCloud& cloud) {
  CoarseAttributes attributes{cloud.oriented, cloud.z_up, cloud.colors ? cloud.colors->bits : 0, {}};
  for (const surfel::ScalarAttribute& scalar : cloud.scalars) {
    if (is_coarse_scalar(scalar.name)) attributes.scalars.push_back(without_values(scalar));
  }
  return attributes;
}

std::vector<CoarseSurfel> sample_surfels(const surfel::SurfelCloud& cloud, std::span<const uint32_t> members,
                                         float largest) {
  std::vector<CoarseSurfel> surfels(members.size());
  for (size_t i = 0; i < members.size(); ++i) {
    const uint32_t member = members[i];
    surfels[i].position = cloud.positions[member];
    surfels[i].normal = cloud.normals[member];
    surfels[i].scatter = cloud.is_scatter(member);
    surfels[i].radius = surfels[i].scatter ? cloud.radii[member] : std::min(cloud.radii[member], largest);
    if (cloud.colors) surfels[i].light = surfel::to_linear(cloud.colors->values[member], cloud.colors->bits);
  }
  for (const surfel::ScalarAttribute& scalar : cloud.scalars) {
    if (!is_coarse_scalar(scalar.name)) continue;
    for (size_t i = 0; i < members.size(); ++i) take(scalar, members[i], surfels[i]);
  }
  return surfels;
}

surfel::SurfelCloud make_coarse_cloud(std::span<const CoarseSurfel> surfels, const CoarseAttributes& attributes) {
  surfel::SurfelCloud cloud;
  cloud.estimated_normals = true;
  cloud.estimated_radii = true;
  cloud.oriented = attributes.oriented;
  cloud.z_up = attributes.z_up;
  cloud.scalars = attributes.scalars;
  cloud.sources = {{"", 0, surfels.size(), std::nullopt}};
  if (attributes.color_bits > 0) cloud.colors = surfel::ColorAttribute{attributes.color_bits, {}};
  if (std::any_of(surfels.begin(), surfels.end(), [](const CoarseSurfel& s) { return s.scatter; })) {
    cloud.scatter.reserve(surfels.size());
    for (const CoarseSurfel& s : surfels) cloud.scatter.push_back(s.scatter ? 1 : 0);
  }
  for (const CoarseSurfel& surfel : surfels) {
    cloud.positions.push_back(surfel.position);
    cloud.normals.push_back(surfel.normal);
    cloud.radii.push_back(surfel.radius);
    if (cloud.colors) cloud.colors->values.push_back(to_color(surfel.light, attributes.color_bits));
    for (surfel::ScalarAttribute& scalar : cloud.scalars) {
      const double mean = stored_value(surfel, scalar);
      std::visit(
          [mean](auto& values) {
            values.push_back(to_value<typename std::decay_t<decltype(values)>::value_type>(mean));
          },
          scalar.values);
    }
  }
  return cloud;
}

}  // namespace surfcast::ldc
