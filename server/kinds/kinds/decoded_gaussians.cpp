#include "kinds/decoded_gaussians.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "shared/gaussian_layout.h"

namespace surfcast::kinds {
namespace {

/// The columns are the axes times their deviations, world units.
glm::dmat3 factor_of(const gaussian::Gaussians& shapes, size_t i) {
  const glm::dmat3 axes = glm::mat3_cast(glm::dquat(shapes.rotations[i]));
  const glm::dvec3 s(shapes.scales[i]);
  return {s.x * axes[0], s.y * axes[1], s.z * axes[2]};
}

uint8_t level_of(double code) {
  return static_cast<uint8_t>(std::lround(255 * std::clamp(code, 0.0, 1.0)));
}

}  // namespace

DecodedGaussians::DecodedGaussians(gaussian::GaussianBlock block)
    : block_(std::move(block)), shapes_(gaussian::decode_shapes(block_.codes)) {}

size_t DecodedGaussians::bytes() const {
  constexpr size_t kCodes =
      sizeof(glm::uvec3) + sizeof(glm::u16vec3) + sizeof(gaussian::RotationCode) + 1 + sizeof(glm::u16vec3);
  constexpr size_t kShapes = sizeof(glm::vec3) + sizeof(glm::quat) + sizeof(float);
  return block_.codes.size() * (kCodes + kShapes) + block_.codes.harmonics.size() +
         shapes_.harmonics.size() * sizeof(float);
}

/// None if it is clipped, too near or not seen at all.
std::optional<GaussianOnRays> DecodedGaussians::drawn(const PickQuery& query, size_t i) const {
  const glm::dvec3 position = block_.position(i);
  const glm::dvec3 o = query.frame.to_camera(position);
  const double opacity = double{shapes_.opacities[i]} * query.opacity;
  const bool clear = block_.codes.opacities[i] == 0 || opacity <= 0;
  if (!(o.z > SURFCAST_TRAINED_NEAR) || clear || !query.clip.shows(position)) return std::nullopt;
  const glm::dmat3 factor = factor_of(shapes_, i);
  const glm::dmat3 turned{query.frame.rotate(factor[0]), query.frame.rotate(factor[1]), query.frame.rotate(factor[2])};
  return GaussianOnRays(o, turned, opacity, query.frame.eta);
}

void DecodedGaussians::hit(const PickQuery& query, std::vector<PickHit>& hits) const {
  const glm::dvec3 ray = query.frame.ray(query.pixel);
  for (size_t i = 0; i < block_.codes.size(); ++i) {
    const std::optional<GaussianOnRays> shape = drawn(query, i);
    const auto seen = shape ? shape->on_ray(ray) : std::nullopt;
    if (seen) hits.push_back({static_cast<uint32_t>(i), seen->r2, seen->depth, seen->depth, seen->opacity});
  }
}

void DecodedGaussians::cover(const PickQuery& query, PixelHits& pixels) const {
  for (size_t i = 0; i < block_.codes.size(); ++i) {
    const std::optional<GaussianOnRays> shape = drawn(query, i);
    if (!shape) continue;
    const ItemLook look{glm::vec3(normal_of(query, i)), kNoClass};
    pixels.for_each_shown(shape->pixels(query.frame, pixels.range()), 0, [&](const glm::ivec2& pixel) {
      const auto seen = shape->on_ray(query.frame.ray(glm::dvec2(pixel) + 0.5));
      if (!seen) return;
      pixels.add(pixel, {static_cast<uint32_t>(i), seen->r2, seen->depth, seen->depth, seen->opacity}, look);
    });
  }
}

/// The shortest axis, towards the eye.
glm::dvec3 DecodedGaussians::normal_of(const PickQuery& query, size_t i) const {
  const glm::vec3& s = shapes_.scales[i];
  const int shortest = s.x < s.y ? (s.x < s.z ? 0 : 2) : (s.y < s.z ? 1 : 2);
  const glm::dvec3 normal = glm::mat3_cast(glm::dquat(shapes_.rotations[i]))[shortest];
  return glm::dot(normal, block_.position(i) - query.frame.eye) > 0 ? -normal : normal;
}

PickedSurfel DecodedGaussians::describe(const PickQuery& query, uint32_t item) const {
  const size_t width = 3 * gaussian::harmonics_of(block_.codes.traits.degree);
  const auto color = [&](size_t channel) {
    return level_of(0.5 + gaussian::kConstantHarmonic * double{shapes_.harmonics[item * width + channel]});
  };
  const glm::vec3& s = shapes_.scales[item];
  PickedSurfel picked;
  picked.position = block_.position(item);
  picked.normal = normal_of(query, item);
  picked.color = glm::u8vec3(color(0), color(1), color(2));
  picked.radius = double{std::max({s.x, s.y, s.z})};
  picked.distance = glm::length(picked.position - query.frame.eye);
  picked.values = {{"opacity", double{shapes_.opacities[item]}}};
  return picked;
}

}  // namespace surfcast::kinds
