#include "reference/scenes.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "base/contract.h"
#include "reference/gaussian_downsample.h"
#include "reference/headlight.h"
#include "reference/sampling.h"

namespace surfcast::reference {
namespace {

constexpr int kSize = 512;       ///< pixels
constexpr int kPlaneSide = 256;  ///< surfels along a side of the square
constexpr int kSphereCount = 100'000;

/// A view of the point `focal` from `distance` away, `elevation` degrees above the plane z = 0, along +y.
geometry::Camera view_down(const glm::dvec3& focal, double distance, double elevation, double view_angle) {
  const double angle = glm::radians(elevation);
  geometry::Camera camera;
  camera.focal_point = focal;
  camera.position = focal + distance * glm::dvec3(0, -std::cos(angle), std::sin(angle));
  camera.view_up = {0, 0, 1};
  camera.view_angle = view_angle;
  return camera;
}

geometry::Camera oblique_view() {
  return view_down({0, 0, 0}, 2, 40, 35);
}
geometry::Camera grazing_view() {
  return view_down({0, 0, 0}, 1.6, 2, 35);
}
geometry::Camera close_view() {
  return view_down({0, 0.25, 0}, 0.02, 40, 50);
}
geometry::Camera near_view() {
  return view_down({0, 0.25, 0}, 0.1, 25, 50);
}
geometry::Camera far_view() {
  return view_down({0, 0, 0}, 24, 50, 35);
}
geometry::Camera sphere_view() {
  return view_down({0, 0, 0}, 3.6, 25, 35);
}

Texture plane_checker() {
  return checker(16, 16, linear_from_srgb8({220, 205, 180}), linear_from_srgb8({75, 85, 115}));
}
Texture sphere_checker() {
  return checker(64, 32, linear_from_srgb8({220, 205, 180}), linear_from_srgb8({75, 85, 115}));
}
Texture single_color() {
  return one_color(linear_from_srgb8({200, 120, 40}));
}
Texture edge() {
  return step_edge(linear_from_srgb8({20, 20, 20}), linear_from_srgb8({240, 240, 240}));
}

Scene scene_of(const std::vector<SurfacePoint>& points, RaySurface surface, Texture texture,
               const geometry::Camera& camera) {
  Scene scene;
  scene.cloud = surfels_at(points);
  if (texture) scene.cloud.colors = sampled_colors(points, texture);
  scene.surface = std::move(surface);
  scene.texture = std::move(texture);
  scene.request.camera = camera;
  scene.request.width = kSize;
  scene.request.height = kSize;
  scene.request.background = {0, 0, 0};
  return scene;
}

/// Moves a point to the lower of two sheets, which is identified by u in [2, 3].
SurfacePoint lowered(SurfacePoint point, double gap) {
  point.position.z -= gap;
  point.uv.x += 2;
  return point;
}

Scene plane_scene(Texture texture, const geometry::Camera& camera) {
  return scene_of(jittered_square(kPlaneSide, 0.25, 1), square(), std::move(texture), camera);
}

Scene random_plane_scene(Texture texture, const geometry::Camera& camera) {
  return scene_of(random_square(kPlaneSide * kPlaneSide, 2), square(), std::move(texture), camera);
}

Scene random_sphere_scene(Texture texture, const geometry::Camera& camera) {
  return scene_of(random_sphere(kSphereCount, 6), unit_sphere(), std::move(texture), camera);
}

Scene sphere_scene(Texture texture, const geometry::Camera& camera) {
  return scene_of(jittered_sphere(kSphereCount, 0.5, 3), unit_sphere(), std::move(texture), camera);
}

/// Two sheets three spacings apart, each with its own samples and colour.
Scene layers_scene(const geometry::Camera& camera) {
  const double gap = 3 * 2.0 / kPlaneSide;
  std::vector<SurfacePoint> points = jittered_square(kPlaneSide, 0.25, 1);
  for (const SurfacePoint& p : jittered_square(kPlaneSide, 0.25, 4)) points.push_back(lowered(p, gap));
  const Texture texture = [](const glm::dvec2& uv) {
    return linear_from_srgb8(uv.x < 1.5 ? glm::dvec3(230, 150, 60) : glm::dvec3(40, 80, 160));
  };
  const RaySurface surface = [gap](const glm::dvec3& origin, const glm::dvec3& direction) {
    const RaySurface sheet = square();
    auto point = sheet(origin, direction);
    if (point) return point;
    point = sheet(origin + glm::dvec3(0, 0, gap), direction);
    if (point) point = lowered(*point, gap);
    return point;
  };
  return scene_of(points, surface, texture, camera);
}

/// A sphere without oriented normals. Its far half must be hidden nevertheless.
Scene two_sided_sphere_scene() {
  Scene scene = sphere_scene(sphere_checker(), sphere_view());
  scene.cloud.oriented = false;
  return scene;
}

struct NamedScene {
  const char* name;
  Scene (*make)();
};

constexpr NamedScene kScenes[] = {
    {"checker_oblique", [] { return plane_scene(plane_checker(), oblique_view()); }},
    {"checker_grazing", [] { return plane_scene(plane_checker(), grazing_view()); }},
    {"checker_close", [] { return plane_scene(plane_checker(), close_view()); }},
    {"checker_far", [] { return plane_scene(plane_checker(), far_view()); }},
    {"checker_sphere", [] { return sphere_scene(sphere_checker(), sphere_view()); }},
    {"color_plane", [] { return plane_scene(single_color(), oblique_view()); }},
    {"color_sphere", [] { return sphere_scene(single_color(), sphere_view()); }},
    {"smooth_oblique", [] { return plane_scene(sines(), oblique_view()); }},
    {"smooth_near", [] { return plane_scene(sines(), near_view()); }},
    {"noise_oblique", [] { return plane_scene(value_noise(kPlaneSide / 4), oblique_view()); }},
    {"noise_near", [] { return plane_scene(value_noise(kPlaneSide / 4), near_view()); }},
    {"edge_oblique", [] { return plane_scene(edge(), oblique_view()); }},
    {"random_oblique", [] { return random_plane_scene(plane_checker(), oblique_view()); }},
    {"random_color_near", [] { return random_plane_scene(single_color(), near_view()); }},
    {"random_sphere", [] { return random_sphere_scene(single_color(), sphere_view()); }},
    {"layers_oblique", [] { return layers_scene(oblique_view()); }},
    {"layers_grazing",
     [] {
       return layers_scene(view_down({0, 0, 0}, 1.6, 10, 35));
     }},
    {"two_sided_sphere", [] { return two_sided_sphere_scene(); }},
    {"lit_sphere", [] { return sphere_scene(nullptr, sphere_view()); }},
};

}  // namespace

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const NamedScene& scene : kScenes) names.emplace_back(scene.name);
  return names;
}

Scene make_scene(const std::string& name) {
  const auto* found =
      std::find_if(std::begin(kScenes), std::end(kScenes), [&](const auto& s) { return s.name == name; });
  SURFCAST_EXPECTS(found != std::end(kScenes));
  Scene scene = found->make();
  scene.name = name;
  return scene;
}

namespace {

/// Filters the ray cast picture of the analytic surface: `color` at hit points, `background` elsewhere.
template <typename Color>
LinearPicture ray_cast(const Scene& scene, const glm::dvec3& background, const Color& color) {
  const auto frame = geometry::make_camera_frame(*scene.request.camera, scene.request.width, scene.request.height);
  SURFCAST_EXPECTS(frame.has_value());
  return filtered_picture(frame->width, frame->height, [&](const glm::dvec2& pixel) {
    const glm::dvec3 ray = frame->ray(pixel);
    const glm::dvec3 direction = frame->right * ray.x + frame->up * ray.y + frame->forward * ray.z;
    const auto point = scene.surface(frame->eye, direction);
    return point ? color(*point, direction) : background;
  });
}

}  // namespace

LinearPicture ideal_picture(const Scene& scene) {
  const glm::dvec3 background = linear_from_srgb8(glm::dvec3(scene.request.background));
  return ray_cast(scene, background, [&](const SurfacePoint& point, const glm::dvec3& direction) {
    if (scene.texture) return scene.texture(point.uv);
    return glm::dvec3(kAlbedo * headlight(point.normal, direction));
  });
}

std::vector<double> ideal_coverage(const Scene& scene) {
  const LinearPicture mask = ray_cast(scene, glm::dvec3(0), [](const auto&, const auto&) { return glm::dvec3(1); });
  std::vector<double> coverage;
  for (const glm::dvec3& p : mask.pixels) coverage.push_back(p.x);
  return coverage;
}

}  // namespace surfcast::reference
