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

bool DecodedSurfels::hidden(const PickQuery& query, size_t surfel) const {
  if (!query.clip.shows(block_.position(surfel))) return true;
  if (query.hidden_classes.none()) return false;
  for (const surfel::ScalarAttribute& scalar : block_.scalars) {
    if (scalar.name != "classification") continue;
    const double code = value_at(scalar.values, surfel);
    return query.hidden_classes[static_cast<size_t>(std::isnan(code) ? 0 : std::clamp(std::round(code), 0.0, 255.0))];
  }
  return false;
}

void DecodedSurfels::hit(const PickQuery& query, std::vector<PickHit>& hits) const {
  const geometry::CameraFrame& frame = query.frame;
  const glm::dvec3 ray = frame.ray(query.pixel);
  const float widest = surfel::largest_drawn_radius(block_.radii, block_.scatter);
  for (size_t i = 0; i < block_.size(); ++i) {
    const glm::dvec3 o = frame.to_camera(block_.position(i));
    const bool scatter = block_.is_scatter(i);
    const glm::dvec3 n = scatter ? facing_eye(o) : frame.rotate(glm::dvec3(block_.normals[i]));
    if (oriented_ && !scatter && glm::dot(n, o) >= 0) continue;
    const double radius = double{scatter ? block_.radii[i] : std::min(block_.radii[i], widest)};
    const auto disc = hit_disc(o, n, radius, ray, frame.eta);
    if (!disc || hidden(query, i)) continue;
    hits.push_back({static_cast<uint32_t>(i), disc->form, disc->depth, disc->occluder});
  }
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
  picked.normal = glm::normalize(glm::dvec3(block_.normals[surfel]));
  const glm::dvec3 from_eye = picked.position - query.frame.eye;
  if (!oriented_ && glm::dot(picked.normal, from_eye) > 0) picked.normal = -picked.normal;
  if (!block_.colors.empty()) picked.color = color_of(surfel);
  picked.radius = double{block_.radii[surfel]};
  picked.distance = glm::length(from_eye);
  for (const surfel::ScalarAttribute& scalar : block_.scalars) {
    picked.values.push_back({scalar.name, value_at(scalar.values, surfel)});
  }
  return picked;
}

}  // namespace surfcast::kinds
