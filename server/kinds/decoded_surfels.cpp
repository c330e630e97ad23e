#include "kinds/decoded_surfels.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>
#include <variant>

#include "kinds/opaque_disc.h"
#include "surfel/drawn_radius.h"

namespace surfcast::kinds {
namespace {

template <typename T>
size_t bytes_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

double value_at(const surfel::ScalarValues& values, size_t i) {
  return std::visit([i](const auto& column) { return static_cast<double>(column[i]); }, values);
}

}  // namespace

DecodedSurfels::DecodedSurfels(model::DecodedBlock block, const model::ModelInfo& info)
    : block_(std::move(block)), oriented_(info.oriented), color_bits_(info.color_bits) {}

size_t DecodedSurfels::bytes() const {
  size_t bytes = bytes_of(block_.indices) + bytes_of(block_.normals) + bytes_of(block_.radii) +
                 bytes_of(block_.weights) + bytes_of(block_.scatter) + bytes_of(block_.colors);
  for (const surfel::ScalarAttribute& scalar : block_.scalars) {
    bytes += std::visit([](const auto& values) { return bytes_of(values); }, scalar.values);
  }
  return bytes;
}

std::optional<uint8_t> DecodedSurfels::class_of(size_t surfel) const {
  for (const surfel::ScalarAttribute& scalar : block_.scalars) {
    if (scalar.name != "classification") continue;
    const double code = value_at(scalar.values, surfel);
    return static_cast<uint8_t>(std::isnan(code) ? 0 : std::clamp(std::round(code), 0.0, 255.0));
  }
  return std::nullopt;
}

bool DecodedSurfels::hidden(const PickQuery& query, size_t surfel) const {
  if (!query.clip.shows(block_.position(surfel))) return true;
  if (query.hidden_classes.none()) return false;
  const std::optional<uint8_t> code = class_of(surfel);
  return code && query.hidden_classes[*code];
}

/// The disc of a surfel as it is drawn, in the camera frame; none if its back is seen.
std::optional<DecodedSurfels::DrawnDisc> DecodedSurfels::disc_of(const geometry::CameraFrame& frame, size_t surfel,
                                                                 float widest) const {
  const glm::dvec3 o = frame.to_camera(block_.position(surfel));
  if (block_.is_scatter(surfel)) return DrawnDisc{o, facing_eye(o), double{block_.radii[surfel]}};
  const glm::dvec3 n = frame.rotate(glm::dvec3(block_.normals[surfel]));
  if (oriented_ && glm::dot(n, o) >= 0) return std::nullopt;
  return DrawnDisc{o, n, double{std::min(block_.radii[surfel], widest)}};
}

void DecodedSurfels::hit(const PickQuery& query, std::vector<PickHit>& hits) const {
  const geometry::CameraFrame& frame = query.frame;
  const glm::dvec3 ray = frame.ray(query.pixel);
  const float widest = surfel::largest_drawn_radius(block_.radii, block_.scatter);
  for (size_t i = 0; i < block_.size(); ++i) {
    const auto drawn = disc_of(frame, i, widest);
    if (!drawn) continue;
    const auto disc = hit_disc(drawn->o, drawn->n, drawn->radius, ray, frame.eta);
    if (!disc || hidden(query, i)) continue;
    hits.push_back({static_cast<uint32_t>(i), disc->form, disc->surface, disc->occluder});
  }
}

/// The discs of hit(), each in the pixels that it may cover.
void DecodedSurfels::cover(const PickQuery& query, PixelHits& pixels) const {
  const geometry::CameraFrame& frame = query.frame;
  const float widest = surfel::largest_drawn_radius(block_.radii, block_.scatter);
  for (size_t i = 0; i < block_.size(); ++i) {
    const auto drawn = disc_of(frame, i, widest);
    if (!drawn) continue;
    const auto& [o, n, radius] = *drawn;
    const auto range = disc_pixels(o, n, radius, frame, pixels.range());
    if (!range || hidden(query, i)) continue;
    const ItemLook look = look_of(query, i);
    const double nearest = nearest_depth(o, radius);
    pixels.for_each_shown(*range, nearest, [&](const glm::ivec2& pixel) {
      const auto disc = hit_disc(drawn->o, drawn->n, drawn->radius, frame.ray(glm::dvec2(pixel) + 0.5), frame.eta);
      if (disc) pixels.add(pixel, {static_cast<uint32_t>(i), disc->form, disc->surface, disc->occluder}, look);
    });
  }
}

/// Unit; turned towards the eye if the model is not oriented.
glm::dvec3 DecodedSurfels::normal_of(const PickQuery& query, size_t surfel) const {
  const glm::dvec3 normal = glm::normalize(glm::dvec3(block_.normals[surfel]));
  const bool turned = !oriented_ && glm::dot(normal, block_.position(surfel) - query.frame.eye) > 0;
  return turned ? -normal : normal;
}

ItemLook DecodedSurfels::look_of(const PickQuery& query, size_t surfel) const {
  const std::optional<uint8_t> code = class_of(surfel);
  return {glm::vec3(normal_of(query, surfel)), code ? static_cast<float>(*code) : kNoClass};
}

glm::u8vec3 DecodedSurfels::color_of(size_t surfel) const {
  const glm::u16vec3 color = block_.colors[surfel];
  if (color_bits_ == 8) return {color.r, color.g, color.b};
  const auto level = [](uint32_t value) { return static_cast<uint8_t>((value * 255 + 32767) / 65535); };
  return {level(color.r), level(color.g), level(color.b)};
}

PickedSurfel DecodedSurfels::describe(const PickQuery& query, uint32_t surfel) const {
  PickedSurfel picked;
  picked.position = block_.position(surfel);
  picked.normal = normal_of(query, surfel);
  if (!block_.colors.empty()) picked.color = color_of(surfel);
  picked.radius = double{block_.radii[surfel]};
  picked.distance = glm::length(picked.position - query.frame.eye);
  for (const surfel::ScalarAttribute& scalar : block_.scalars) {
    picked.values.push_back({scalar.name, value_at(scalar.values, surfel)});
  }
  return picked;
}

}  // namespace surfcast::kinds
