#include "reference/volume_scenes.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>

#include "base/contract.h"
#include "reference/linear_picture.h"
#include "reference/volume_ray_caster.h"

namespace surfcast::reference {
namespace {

constexpr int kIdealRays = 3;             ///< per pixel and axis
constexpr double kIdealStep = 2.0 / 320;  ///< a tenth of the spacing of 32 samples

struct NamedField {
  const char* name;
  VolumeField (*make)();
  const char* transfer;
  int samples;  ///< along an axis, of the grid to whose spacing opacities refer
};
constexpr NamedField kFields[] = {{"torus", torus_field, "smooth", 32},
                                  {"ball", ball_field, "edge", 32},
                                  {"blobs", blobs_field, "faint", 32},
                                  {"ml", marschner_lobb, "soft", 41}};

struct NamedView {
  const char* name;
  glm::dvec3 eye;
  glm::dvec3 focal;
  double view_angle;  ///< degrees
};
constexpr NamedView kViews[] = {{"mid", {1.3, 1.1, 3}, {0, 0, 0}, 36},
                                {"low", {2.9, 1.2, 0.5}, {0, 0, 0}, 36},
                                {"wide", {0.55, 0.45, 1.25}, {0, 0, 0}, 110},
                                {"near", {0.6, 0.5, 1.0}, {0, 0, 0}, 50},
                                {"inside", {0.6, 0.08, 0.03}, {0.1, 0.75, 0}, 75},
                                {"far", {5.2, 4.4, 12}, {0, 0, 0}, 36}};

template <typename Named, size_t kCount>
const Named& by_name(const Named (&all)[kCount], const std::string& name) {
  const auto* found = std::find_if(std::begin(all), std::end(all), [&](const Named& n) { return n.name == name; });
  SURFCAST_EXPECTS(found != std::end(all));
  return *found;
}

glm::dvec3 srgb_of(const glm::dvec3& linear) {
  return {srgb_from_linear(linear.x), srgb_from_linear(linear.y), srgb_from_linear(linear.z)};
}

/// Points so close that the opacity is linear in between, too. Colours are mixed in linear light.
std::vector<TransferPoint> with_linear_opacity(const std::vector<TransferPoint>& points) {
  constexpr int kPieces = 32;
  std::vector<TransferPoint> close;
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    const glm::dvec3 below = linear_from_srgb8(255.0 * points[i].srgb);
    const glm::dvec3 above = linear_from_srgb8(255.0 * points[i + 1].srgb);
    for (int piece = 0; piece < kPieces; ++piece) {
      const double part = piece / double{kPieces};
      close.push_back({std::lerp(points[i].value, points[i + 1].value, part), srgb_of(glm::mix(below, above, part)),
                       std::lerp(points[i].opacity, points[i + 1].opacity, part)});
    }
  }
  close.push_back(points.back());
  return close;
}

}  // namespace

std::vector<TransferPoint> transfer_points(const std::string& name) {
  const glm::dvec3 blue{0.25, 0.45, 0.9};
  const glm::dvec3 orange{0.95, 0.6, 0.2};
  const glm::dvec3 white{1, 0.95, 0.9};
  const std::map<std::string, std::vector<TransferPoint>> functions = {
      {"smooth", {{0.15, blue, 0}, {0.5, orange, 0.15}, {0.9, white, 0.35}}},
      {"edge", {{0.33, orange, 0}, {0.67, white, 0.9}}},
      {"faint", {{0.1, blue, 0}, {0.5, orange, 0.1}, {0.9, white, 0.25}}},
      {"soft", {{0.1, blue, 0}, {0.5, orange, 0.1}, {0.9, white, 0.2}}},
      {"shell", {{0.2, blue, 0}, {0.35, blue, 0.12}, {0.5, blue, 0}, {0.6, orange, 0}, {0.8, orange, 0.4}}}};
  SURFCAST_EXPECTS(functions.contains(name));
  return with_linear_opacity(functions.at(name));
}

TransferFunction transfer_by_name(const std::string& name, double spacing) {
  return {transfer_points(name), spacing};
}

geometry::CameraFrame volume_view(const std::string& name, int side, double closer) {
  const NamedView& view = by_name(kViews, name);
  geometry::Camera camera;
  camera.focal_point = view.focal;
  camera.position = view.focal + (view.eye - view.focal) / closer;
  camera.view_angle = view.view_angle;
  const auto frame = geometry::make_camera_frame(camera, side, side);
  SURFCAST_EXPECTS(frame.has_value());
  return *frame;
}

VolumeScene make_volume_scene(const std::string& field, const std::string& view, const glm::ivec3& size, int side) {
  const NamedField& named = by_name(kFields, field);
  VolumeScene scene;
  scene.field = named.make();
  scene.grid = sampled(scene.field, size);
  scene.points = transfer_points(named.transfer);
  scene.spacing = 2.0 / (named.samples - 1);
  scene.transfer = TransferFunction(scene.points, scene.spacing);
  scene.frame = volume_view(view, side);
  return scene;
}

LightPicture ideal_picture(const VolumeScene& scene) {
  RayMedium medium{scene.field.value, {}};
  if (scene.shaded) medium.gradient = [&](const glm::dvec3& place) { return gradient(scene.field, place); };
  return prefiltered_picture(scene.frame.width, scene.frame.height, kIdealRays, [&](const glm::dvec2& pixel) {
    const glm::dvec3 direction = ray_direction(scene.frame, pixel);
    const RayInterval part = visible_interval(scene.grid, {}, scene.frame.eye, direction);
    return cast_ray(medium, scene.transfer, scene.frame.eye, direction, part, kIdealStep);
  });
}

}  // namespace surfcast::reference
