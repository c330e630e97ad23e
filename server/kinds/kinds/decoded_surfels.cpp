#include "kinds/decoded_surfels.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <utility>
#include <variant>

#include "kinds/opaque_disc.h"
#include "surfel/drawn_radius.h"
#include "surfel/even_sampling.h"
#include "surfel/opacity.h"

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

DecodedSurfels::DecodedSurfels(model::DecodedBlock block, const model::ModelInfo& info, const model::ModelInfo& own)
    : block_(std::move(block)),
      curvature_(block_.scalars),
      oriented_(block_.oriented),
      color_bits_(info.color_bits),
      colored_(own.color_bits > 0),
      told_(own.scalar_names) {}

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

double DecodedSurfels::opacity_of_scan(size_t surfel) const {
  const auto found = std::ranges::find(block_.scalars, surfel::kOpacityAttribute, &surfel::ScalarAttribute::name);
  return found == block_.scalars.end() ? 1 : surfel::opacity_at(found->values, surfel);
}

/// Discs of an even sampling cover each point of a surface pi r^2 / h^2 times, which together have its opacity.
double DecodedSurfels::opacity_of(const PickQuery& query, size_t surfel) const {
  constexpr double kShare = 1 / (std::numbers::pi * surfel::kRadiusOverSpacing * surfel::kRadiusOverSpacing);
  double opacity = query.transparent ? query.opacity : 1;
  if (query.by_file) opacity *= opacity_of_scan(surfel);
  if (!query.clip.shows(block_.position(surfel))) opacity *= query.ghost;
  if (opacity > 0 && (query.hidden_classes.any() || !query.class_opacities.empty())) {
    const std::optional<uint8_t> code = class_of(surfel);
    if (code && query.hidden_classes[*code]) return 0;
    if (code && !query.class_opacities.empty()) opacity *= query.class_opacities[*code];
  }
  return opacity < 1 ? -std::expm1(kShare * std::log1p(-opacity)) : 1;
}

/// The disc of a surfel as it is drawn, in the camera frame; none if its back is seen.
std::optional<DecodedSurfels::DrawnDisc> DecodedSurfels::disc_of(const PickQuery& query, size_t surfel,
                                                                 float widest) const {
  const geometry::CameraFrame& frame = query.frame;
  const glm::dvec3 o = frame.to_camera(block_.position(surfel));
  if (block_.is_scatter(surfel)) return DrawnDisc{o, facing_eye(o), double{block_.radii[surfel]}};
  const glm::dvec3 world(block_.normals[surfel]);
  const glm::dvec3 n = frame.rotate(world);
  const double radius = double{std::min(block_.radii[surfel], widest)};
  if (!curvature_.empty() && curvature_.at(surfel) != surfel::CurvatureCode{}) {
    const surfel::CurvatureCode code = curvature_.at(surfel);
    const surfel::TangentFrame axes = surfel::tangent_frame(world);
    const surfel::Curvature bend = surfel::decode_curvature(code, double{block_.radii[surfel]});
    return DrawnDisc{o, n, radius, surfel::OsculatingSurface{o, n, {frame.rotate(axes.u), frame.rotate(axes.v)}, bend},
                     surfel::decode_border(code[3])};
  }
  if (oriented_ && !query.transparent && glm::dot(n, o) >= 0) return std::nullopt;
  return DrawnDisc{o, n, radius};
}

std::optional<DiscHit> DecodedSurfels::meet(const DrawnDisc& drawn, const PickQuery& query,
                                            const glm::dvec3& ray) const {
  return drawn.surface ? hit_surface(*drawn.surface, drawn.radius, drawn.border, ray, query.frame.eta,
                                     oriented_ && !query.transparent)
                       : hit_disc(drawn.o, drawn.n, drawn.radius, ray, query.frame.eta);
}

void DecodedSurfels::hit(const PickQuery& query, std::vector<PickHit>& hits) const {
  const geometry::CameraFrame& frame = query.frame;
  const glm::dvec3 ray = frame.ray(query.pixel);
  const float widest = surfel::largest_drawn_radius(block_.radii, block_.scatter);
  for (size_t i = 0; i < block_.size(); ++i) {
    const auto drawn = disc_of(query, i, widest);
    if (!drawn) continue;
    const auto disc = meet(*drawn, query, ray);
    const double opacity = disc ? opacity_of(query, i) : 0;
    if (opacity <= 0) continue;
    hits.push_back({static_cast<uint32_t>(i), disc->form, disc->surface, disc->occluder, opacity});
  }
}

/// The discs of hit(), each in the pixels that it may cover.
void DecodedSurfels::cover(const PickQuery& query, PixelHits& pixels) const {
  const geometry::CameraFrame& frame = query.frame;
  const float widest = surfel::largest_drawn_radius(block_.radii, block_.scatter);
  for (size_t i = 0; i < block_.size(); ++i) {
    const auto drawn = disc_of(query, i, widest);
    if (!drawn) continue;
    const double ball = drawn->surface ? ball_of(*drawn->surface, drawn->radius) : 0;
    const auto range = drawn->surface ? ball_pixels(drawn->o, ball, frame, pixels.range())
                                      : disc_pixels(drawn->o, drawn->n, drawn->radius, frame, pixels.range());
    const double opacity = range ? opacity_of(query, i) : 0;
    if (opacity <= 0) continue;
    const ItemLook look = look_of(query, i);
    const double nearest = drawn->surface ? drawn->o.z - ball : nearest_depth(drawn->o, drawn->radius);
    pixels.for_each_shown(*range, nearest, [&](const glm::ivec2& pixel) {
      const auto disc = meet(*drawn, query, frame.ray(glm::dvec2(pixel) + 0.5));
      if (disc) pixels.add(pixel, {static_cast<uint32_t>(i), disc->form, disc->surface, disc->occluder, opacity}, look);
    });
  }
}

/// Unit; turned towards the eye if its scan is not oriented.
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
  if (colored_) picked.color = color_of(surfel);
  picked.radius = double{block_.radii[surfel]};
  picked.distance = glm::length(picked.position - query.frame.eye);
  for (const surfel::ScalarAttribute& scalar : block_.scalars) {
    const bool told = std::ranges::find(told_, scalar.name) != told_.end();
    if (!told || surfel::is_curvature_column(scalar.name)) continue;  // no attribute of the source
    picked.values.push_back({scalar.name, value_at(scalar.values, surfel)});
  }
  return picked;
}

}  // namespace surfcast::kinds
