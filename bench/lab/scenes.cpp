#include "lab/scenes.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <random>

#include "base/contract.h"
#include "lab/torus.h"
#include "reference/sampling.h"

namespace surfcast::lab {
namespace {

using reference::Scene;
using reference::SurfacePoint;

constexpr int kSize = 512;  ///< pixels

Scene scene_of(const std::vector<SurfacePoint>& points, reference::RaySurface surface, reference::Texture texture,
               const geometry::Camera& camera) {
  Scene scene;
  scene.cloud = reference::surfels_at(points);
  scene.cloud.colors = reference::sampled_colors(points, texture);
  scene.surface = std::move(surface);
  scene.texture = std::move(texture);
  scene.request.camera = camera;
  scene.request.width = kSize;
  scene.request.height = kSize;
  return scene;
}

/// The checker plane seen from above its near border at 2 degrees, so that it fills the picture up to the horizon.
Scene checker_horizon() {
  Scene scene = reference::make_scene("checker_oblique");
  scene.request.camera = geometry::Camera{{0, -1, 0.035}, {0, 0, 0}, {0, 0, 1}, 35};
  return scene;
}

Scene noise_torus() {
  const Torus torus;
  return scene_of(uneven_samples(torus, 600, 200, 7), ray_surface(torus), reference::value_noise(96),
                  geometry::Camera{{0, -2.6, 1.9}, {0, 0, 0}, {0, 0, 1}, 35});
}

/// Adds the samples of one scanner station between x0 and x1, with noise in position and colour.
void add_station(Scene& scene, int side, double x0, double x1, uint32_t seed) {
  constexpr double kOffPlane = 0.15;  // spacings
  constexpr double kOffColor = 6;     // levels
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 1);
  for (SurfacePoint point : reference::jittered_square(side, 0.5, seed)) {
    if (point.position.x < x0 || point.position.x > x1) continue;
    const glm::u8vec3 color = reference::srgb8_from_linear(scene.texture(point.uv));
    glm::dvec3 seen{0};
    for (int c = 0; c < 3; ++c) seen[c] = std::clamp(color[c] + kOffColor * noise(random), 0.0, 255.0);
    scene.cloud.positions.push_back(point.position + glm::dvec3(0, 0, kOffPlane * 2 / side * noise(random)));
    scene.cloud.normals.emplace_back(point.normal);
    scene.cloud.colors->values.emplace_back(glm::u16vec3(seen + 0.5));
  }
}

/// Two scans of one surface, which overlap in its middle half; the second has a quarter of the first one's samples.
Scene noisy_stations() {
  Scene scene = reference::make_scene("smooth_oblique");
  const bool oriented = scene.cloud.oriented;
  scene.cloud = {};
  scene.cloud.oriented = oriented;
  scene.cloud.colors.emplace();
  add_station(scene, 256, -1, 0.5, 11);
  add_station(scene, 128, -0.5, 1, 12);
  scene.cloud.sources = {{"stations", 0, scene.cloud.size(), std::nullopt}};
  return scene;
}

struct NamedScene {
  const char* name;
  const char* about;
  Scene (*make)();  ///< null: the scene with this name in tests/reference
};

const NamedScene kScenes[] = {
    {"checker_oblique", "64k surfels, 16 x 16 tiles: Ren's figure 11", nullptr},
    {"checker_grazing", "the same at 2 degrees, from outside", nullptr},
    {"checker_horizon", "the same at 2 degrees, from above its border", checker_horizon},
    {"checker_close", "the same, some 20 pixels to a spacing", nullptr},
    {"checker_far", "the same, ten surfels to a pixel", nullptr},
    {"checker_sphere", "100k surfels moved by up to half a spacing, 64 x 32 tiles", nullptr},
    {"noise_torus", "fine noise, 120k samples several times as dense within as without", noise_torus},
    {"edge_oblique", "a step edge", nullptr},
    {"layers_oblique", "two sheets three spacings apart", nullptr},
    {"layers_grazing", "the same at 10 degrees", nullptr},
    {"smooth_near", "low frequencies, magnified", nullptr},
    {"smooth_oblique", "low frequencies", nullptr},
    {"noise_oblique", "noise of four spacings", nullptr},
    {"random_oblique", "the checker, samples anywhere (a Poisson process)", nullptr},
    {"noisy_stations", "two overlapping scans, one of a quarter of the density, noise in depth and colour",
     noisy_stations},
};

}  // namespace

std::vector<std::string> lab_scene_names() {
  std::vector<std::string> names;
  for (const NamedScene& scene : kScenes) names.emplace_back(scene.name);
  return names;
}

LabScene make_lab_scene(const std::string& name) {
  const auto* found = std::ranges::find_if(kScenes, [&](const NamedScene& s) { return s.name == name; });
  SURFCAST_EXPECTS(found != std::end(kScenes));
  return {found->name, found->about, found->make ? found->make() : reference::make_scene(name), {}};
}

LabScene scan_scene(const PlacedScan& scan) {
  return {scan.path.stem().string(), "a scan against its own supersampled picture", std::nullopt, scan.path,
          scan.place};
}

std::vector<picture::PictureRequest> slow_path(const picture::PictureRequest& request, int side, int frames) {
  constexpr glm::dvec2 kStep{0.37, 0.21};  // pixels at the focal point
  SURFCAST_EXPECTS(request.camera.has_value());
  const auto frame = geometry::make_camera_frame(*request.camera, side, side);
  SURFCAST_EXPECTS(frame.has_value());
  const double pixel = glm::distance(request.camera->position, request.camera->focal_point) / frame->eta;
  std::vector<picture::PictureRequest> path;
  for (int k = 0; k < frames; ++k) {
    picture::PictureRequest step = request;
    step.width = step.height = side;
    const glm::dvec3 moved = k * pixel * (kStep.x * frame->right + kStep.y * frame->up);
    step.camera->position += moved;
    step.camera->focal_point += moved;
    path.push_back(std::move(step));
  }
  return path;
}

}  // namespace surfcast::lab
