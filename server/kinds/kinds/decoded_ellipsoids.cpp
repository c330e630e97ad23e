#include "kinds/decoded_ellipsoids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <string>
#include <utility>

#include "ellipsoid/tensor.h"

namespace surfcast::kinds {
namespace {

constexpr const char* kAxisNames[] = {"x", "y", "z"};
constexpr const char* kIndexNames[] = {"i", "j", "k"};

double scalar_at(const surfel::ScalarAttribute& scalar, size_t i) {
  return std::visit([i](const auto& values) { return static_cast<double>(values[i]); }, scalar.values);
}

/// Of a tensor without a colour: sRGB (1 - w) / 2 + w |v1|, w = (l1 - l2) / l1.
glm::u8vec3 direction_color(const glm::dvec3& values, const glm::dvec3& axis) {
  const double w = (values.x - values.y) / values.x;
  const glm::dvec3 code = 255.0 * ((1 - w) / 2 + w * glm::abs(axis));
  return glm::u8vec3(glm::round(glm::clamp(code, glm::dvec3(0), glm::dvec3(255))));
}

/// A direction in the camera frame.
glm::dvec3 to_world(const geometry::CameraFrame& frame, const glm::dvec3& v) {
  return v.x * frame.right + v.y * frame.up + v.z * frame.forward;
}

using Values = std::vector<PickedValue>;

void add_triple(Values& values, const std::string& name, const char* const (&endings)[3], const glm::dvec3& v) {
  for (int i = 0; i < 3; ++i) values.push_back({name + "_" + endings[i], v[i]});
}

void add_tensor(Values& values, const glm::dvec3& eigenvalues, const glm::dmat3& axes) {
  const ellipsoid::SymmetricTensor t = ellipsoid::tensor_of(eigenvalues, axes);
  for (const auto& [name, value] :
       {std::pair{"xx", t.xx}, {"xy", t.xy}, {"xz", t.xz}, {"yy", t.yy}, {"yz", t.yz}, {"zz", t.zz}}) {
    values.push_back({std::string("tensor_") + name, value});
  }
}

}  // namespace

glm::dvec3 GlyphSight::semi_axes(const glm::dvec3& values) const {
  switch (measure) {
    case GlyphMeasure::kRoot:
      return scale * glm::sqrt(values);
    case GlyphMeasure::kUnit:
      return scale / values.x * values;
    case GlyphMeasure::kEigenvalue:
      break;
  }
  return scale * values;
}

DecodedEllipsoids::DecodedEllipsoids(ellipsoid::EllipsoidBlock block, model::EllipsoidSource source)
    : block_(std::move(block)), source_(std::move(source)) {}

size_t DecodedEllipsoids::bytes() const {
  constexpr size_t kEach =
      sizeof(glm::uvec3) + sizeof(glm::vec3) + sizeof(glm::quat) + sizeof(float) + sizeof(glm::u8vec3);
  return block_.size() * (kEach + block_.scalars.size() * sizeof(double));
}

/// As the picture has it, or by default.
GlyphSight DecodedEllipsoids::sight(const PickQuery& query) const {
  if (query.glyphs && block_.source < query.glyphs->size()) return (*query.glyphs)[block_.source];
  GlyphSight sight;
  sight.scale = source_.scale();
  return sight;
}

double DecodedEllipsoids::attribute(int number, size_t i) const {
  const glm::dvec3 values(block_.values[i]);
  if (number == 0) return ellipsoid::fractional_anisotropy(values);
  if (number == 1) return ellipsoid::mode_of(values);
  if (number == 2) return ellipsoid::mean_value(values);
  return scalar_at(block_.scalars[static_cast<size_t>(number) - model::kDerivedAttributes], i);
}

bool DecodedEllipsoids::shown(const PickQuery& query, const GlyphSight& sight, size_t i) const {
  const glm::dvec3 position = block_.position(i);
  if (!query.clip.shows(position)) return false;
  const auto in_layer = [&](const GlyphSight::Layer& layer) {
    return std::abs(glm::dot(layer.normal, position - layer.point)) <= 0.5;
  };
  if (!sight.layers.empty() && std::none_of(sight.layers.begin(), sight.layers.end(), in_layer)) return false;
  return std::all_of(sight.ranges.begin(), sight.ranges.end(), [&](const GlyphSight::Range& range) {
    if (range.attribute < 0) return false;
    const double value = attribute(range.attribute, i);
    return value >= range.smallest && value <= range.largest;
  });
}

EllipsoidOnRays DecodedEllipsoids::on_rays(const PickQuery& query, const GlyphSight& sight, size_t i) const {
  const glm::dmat3 axes = glm::mat3_cast(glm::dquat(block_.rotations[i]));
  const glm::dmat3 turned{query.frame.rotate(axes[0]), query.frame.rotate(axes[1]), query.frame.rotate(axes[2])};
  const glm::dvec3 semi_axes = double{block_.factors[i]} * sight.semi_axes(glm::dvec3(block_.values[i]));
  return {query.frame.to_camera(block_.position(i)), turned, semi_axes};
}

void DecodedEllipsoids::hit(const PickQuery& query, std::vector<PickHit>& hits) const {
  const GlyphSight seen = sight(query);
  const glm::dvec3 ray = query.frame.ray(query.pixel);
  const glm::dvec3 unit = glm::normalize(ray);
  for (size_t i = 0; i < block_.size(); ++i) {
    const glm::dvec3 centre = query.frame.to_camera(block_.position(i));
    const double reach = double{block_.factors[i]} * seen.semi_axes(glm::dvec3(block_.values[i])).x;
    const glm::dvec3 beside = glm::cross(unit, centre);
    if (glm::dot(beside, beside) > reach * reach * (1 + 1e-9) || !shown(query, seen, i)) continue;
    const std::optional<EllipsoidHit> found = on_rays(query, seen, i).on_ray(ray);
    if (found) hits.push_back({static_cast<uint32_t>(i), found->form, found->depth, found->depth, query.opacity});
  }
}

void DecodedEllipsoids::cover(const PickQuery& query, PixelHits& pixels) const {
  const GlyphSight seen = sight(query);
  for (size_t i = 0; i < block_.size(); ++i) {
    if (!shown(query, seen, i)) continue;
    const EllipsoidOnRays shape = on_rays(query, seen, i);
    pixels.for_each_shown(shape.pixels(query.frame, pixels.range()), shape.nearest_depth(), [&](const glm::ivec2& at) {
      const glm::dvec3 ray = query.frame.ray(glm::dvec2(at) + 0.5);
      const std::optional<EllipsoidHit> found = shape.on_ray(ray);
      if (!found) return;
      const glm::dvec3 world = to_world(query.frame, found->normal);
      const PickHit hit{static_cast<uint32_t>(i), found->form, found->depth, found->depth, query.opacity};
      pixels.add(at, hit, {glm::vec3(world), kNoClass});
    });
  }
}

/// The indices of an ellipsoid's sample in the grid, from its stored position.
glm::uvec3 DecodedEllipsoids::sample(size_t i) const {
  const glm::dmat3 steps(source_.index_to_world);
  const glm::dvec3 index = glm::inverse(steps) * (block_.position(i) - source_.index_to_world[3]);
  return glm::uvec3(glm::clamp(glm::round(index), glm::dvec3(0), glm::dvec3(source_.size) - 1.0));
}

PickedSurfel DecodedEllipsoids::describe(const PickQuery& query, uint32_t item) const {
  const GlyphSight seen = sight(query);
  const glm::dvec3 values(block_.values[item]);
  const glm::dmat3 axes = glm::mat3_cast(glm::dquat(block_.rotations[item]));
  const std::optional<EllipsoidHit> found = on_rays(query, seen, item).on_ray(query.frame.ray(query.pixel));
  PickedSurfel picked;
  picked.position = block_.position(item);
  if (source_.on_grid()) picked.position = source_.index_to_world * glm::dvec4(glm::dvec3(sample(item)), 1);
  if (found) picked.normal = to_world(query.frame, found->normal);
  if (!block_.colors.empty()) picked.color = block_.colors[item];
  if (block_.colors.empty() && source_.tensors) picked.color = direction_color(values, axes[0]);
  picked.radius = double{block_.factors[item]} * seen.semi_axes(values).x;
  picked.distance = glm::length(picked.position - query.frame.eye);
  for (int i = 0; i < 3; ++i) {
    picked.values.push_back({source_.attributes[static_cast<size_t>(i)].name, attribute(i, item)});
  }
  add_triple(picked.values, source_.tensors ? "eigenvalue" : "semi_axis", {"1", "2", "3"}, values);
  for (int i = 0; i < 3; ++i) {
    add_triple(picked.values, (source_.tensors ? "eigenvector_" : "axis_") + std::to_string(i + 1), kAxisNames,
               axes[i]);
  }
  if (source_.tensors) add_tensor(picked.values, values, axes);
  for (int axis = 0; source_.on_grid() && axis < 3; ++axis) {
    picked.values.push_back({kIndexNames[axis], static_cast<double>(sample(item)[axis])});
  }
  for (const surfel::ScalarAttribute& scalar : block_.scalars) {
    picked.values.push_back({scalar.name, scalar_at(scalar, item)});
  }
  return picked;
}

}  // namespace surfcast::kinds
