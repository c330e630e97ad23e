#include "reference/transparent_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <random>

#include "base/contract.h"
#include "reference/gaussian_downsample.h"
#include "reference/sampling.h"
#include "reference/texture.h"
#include "surfel/normalization_weights.h"

namespace surfcast::reference {
namespace {

constexpr int kTransparentSize = 256;   ///< pixels
constexpr int kSide = 128;              ///< samples along a side of a square
constexpr int kSphereSamples = 40'000;  ///< of a sphere
constexpr int kPixelFilterReach = 4;    ///< of the pixel filter, pixels

/// A sheet in coordinates of its own, in which it is the square or the unit sphere about the origin.
struct Sheet {
  bool ball = false;
  int side = kSide;  ///< samples along a side of a square
  glm::dvec3 centre{0};
  glm::dmat3 axes{1};  ///< columns: orthogonal, of equal length
  Texture color;
  std::function<double(const glm::dvec2& uv)> opacity;
  double noise = 0;           ///< of samples along the normal, in radii of the surfels
  bool normal_noise = false;  ///< `noise` is the deviation of a normal distribution, not the largest distance

  [[nodiscard]] double scale() const { return glm::length(axes[0]); }
  [[nodiscard]] glm::dvec3 to_own(const glm::dvec3& v) const { return glm::transpose(axes) * v / (scale() * scale()); }
};

std::function<double(const glm::dvec2&)> constant(double opacity) {
  return [opacity](const glm::dvec2&) { return opacity; };
}

Texture palette(size_t i) {
  constexpr std::array<glm::u8vec3, 8> kColors{{{230, 60, 50},
                                                {60, 160, 230},
                                                {240, 210, 70},
                                                {70, 190, 90},
                                                {180, 80, 200},
                                                {240, 140, 40},
                                                {90, 220, 210},
                                                {240, 240, 240}}};
  const glm::dvec3 color = linear_from_srgb8(glm::dvec3(kColors[i % kColors.size()]));
  return [color, pattern = sines()](const glm::dvec2& uv) { return color * (0.6 + 0.4 * pattern(uv)); };
}

/// A square of this half side whose normal makes an angle (degrees) with the view along +y.
Sheet slanted(const glm::dvec3& centre, double half, double angle, size_t color, double opacity) {
  const double a = glm::radians(angle);
  const glm::dvec3 normal{0, -std::cos(a), std::sin(a)};
  const glm::dvec3 along{1, 0, 0};
  Sheet sheet;
  sheet.centre = centre;
  sheet.axes = glm::dmat3(half * along, half * glm::cross(normal, along), half * normal);
  sheet.color = palette(color);
  sheet.opacity = constant(opacity);
  return sheet;
}

Sheet sphere(double radius, size_t color, double opacity) {
  Sheet sheet;
  sheet.ball = true;
  sheet.axes = glm::dmat3(radius);
  sheet.color = palette(color);
  sheet.opacity = constant(opacity);
  return sheet;
}

void append(const Sheet& sheet, uint32_t seed, TransparentScene& scene) {
  const std::vector<SurfacePoint> points =
      sheet.ball ? jittered_sphere(kSphereSamples, 0.25, seed) : jittered_square(sheet.side, 0.25, seed);
  const surfel::SurfelCloud own = surfels_at(points);
  const surfel::ColorAttribute colors = sampled_colors(points, sheet.color);
  std::mt19937 random(seed + 100);
  std::uniform_real_distribution<double> even(-1, 1);
  std::normal_distribution<double> normal;
  for (size_t i = 0; i < points.size(); ++i) {
    const glm::dvec3 n = glm::normalize(sheet.axes * glm::dvec3(own.normals[i]));
    const double radius = own.radii[i] * sheet.scale();
    double off = 0;
    if (sheet.noise > 0) off = sheet.noise * radius * (sheet.normal_noise ? normal(random) : even(random));
    scene.cloud.positions.push_back(sheet.centre + sheet.axes * points[i].position + off * n);
    scene.cloud.normals.emplace_back(n);
    scene.cloud.radii.push_back(static_cast<float>(radius));
    scene.cloud.colors->values.push_back(colors.values[i]);
    scene.opacities.push_back(sheet.opacity(points[i].uv));
  }
}

/// Adds the layers of a sheet along a ray.
void add_layers(const Sheet& sheet, int number, const glm::dvec3& origin, const glm::dvec3& direction,
                std::vector<Layer>& layers) {
  const glm::dvec3 o = sheet.to_own(origin - sheet.centre);
  const glm::dvec3 d = sheet.to_own(direction);
  const auto add = [&](double t, const SurfacePoint& point) {
    if (t > 0) layers.push_back({t, sheet.color(point.uv), sheet.opacity(point.uv), number});
  };
  if (!sheet.ball) {
    if (const auto point = square()(o, d)) add(glm::dot(point->position - o, d) / glm::dot(d, d), *point);
    return;
  }
  const double along = -glm::dot(o, d) / glm::dot(d, d);
  const glm::dvec3 nearest = o + along * d;
  const double square = 1 - glm::dot(nearest, nearest);
  if (square < 0) return;
  const double half = std::sqrt(square / glm::dot(d, d));
  add(along - half, sphere_point(o + (along - half) * d));
  add(along + half, sphere_point(o + (along + half) * d));
}

TransparentScene scene_of(const std::vector<Sheet>& sheets, double distance, double view_angle) {
  TransparentScene scene;
  scene.cloud.colors = surfel::ColorAttribute{8, {}};
  scene.cloud.oriented = true;
  for (size_t i = 0; i < sheets.size(); ++i) append(sheets[i], static_cast<uint32_t>(i) + 1, scene);
  scene.cloud.sources = {{"scene", 0, scene.cloud.size(), std::nullopt}};
  scene.cloud.weights = surfel::normalization_weights(scene.cloud);
  scene.layers = [sheets](const glm::dvec3& origin, const glm::dvec3& direction) {
    std::vector<Layer> layers;
    for (size_t i = 0; i < sheets.size(); ++i) {
      add_layers(sheets[i], static_cast<int>(i), origin, direction, layers);
    }
    std::sort(layers.begin(), layers.end(), [](const Layer& a, const Layer& b) { return a.depth < b.depth; });
    return layers;
  };
  geometry::Camera camera;
  camera.position = {0, -distance, 0};
  camera.view_up = {0, 0, 1};
  camera.view_angle = view_angle;
  scene.request.camera = camera;
  scene.request.width = kTransparentSize;
  scene.request.height = kTransparentSize;
  scene.request.background = {255, 255, 255};
  return scene;
}

TransparentScene planes(double noise, bool normal = false) {
  std::vector<Sheet> sheets;
  for (size_t i = 0; i < 8; ++i) {
    sheets.push_back(slanted({0, 0.25 * (static_cast<double>(i) - 3.5), 0}, 1, 70, i, 0.25));
    sheets.back().noise = noise;
    sheets.back().normal_noise = normal;
  }
  return scene_of(sheets, 4, 30);
}

TransparentScene spheres(double noise, bool normal = false) {
  std::vector<Sheet> sheets{sphere(1, 0, 0.3), sphere(0.7, 1, 0.3), sphere(0.4, 2, 0.3)};
  for (Sheet& sheet : sheets) {
    sheet.noise = noise;
    sheet.normal_noise = normal;
  }
  return scene_of(sheets, 4, 35);
}

/// Radius of a surfel of a square of half side 1.
constexpr double kRadius = 1.09 * 2 / kSide;

TransparentScene two_sheets(double radii) {
  const double a = glm::radians(40.0);
  const glm::dvec3 step = radii * kRadius * glm::dvec3(0, std::cos(a), -std::sin(a));
  return scene_of({slanted(glm::dvec3(0), 1, 40, 0, 0.4), slanted(step, 1, 40, 1, 0.4)}, 4, 30);
}

TransparentScene crossing_planes() {
  return scene_of({slanted(glm::dvec3(0), 1, 50, 0, 0.4), slanted(glm::dvec3(0), 1, 10, 1, 0.4),
                   slanted(glm::dvec3(0), 1, -40, 2, 0.4)},
                  4, 35);
}

TransparentScene alpha_texture() {
  Sheet front = slanted(glm::dvec3(0), 1, 30, 0, 1);
  front.opacity = [](const glm::dvec2& uv) {
    const bool odd = (static_cast<int>(std::floor(uv.x * 8)) + static_cast<int>(std::floor(uv.y * 8))) % 2 != 0;
    return odd ? 0.9 : 0.1;
  };
  Sheet behind = slanted({0, 0.5, 0}, 1, 30, 1, 1);
  return scene_of({front, behind}, 4, 30);
}

/// A shell of glass in front of an opaque checker.
TransparentScene glass_shell() {
  Sheet wall = slanted({0, 1.5, 0}, 2, 0, 0, 1);
  wall.side = 2 * kSide;
  wall.color = checker(8, 8, linear_from_srgb8({220, 205, 180}), linear_from_srgb8({75, 85, 115}));
  return scene_of({sphere(0.8, 1, 0.3), wall}, 4, 20);
}

struct NamedTransparentScene {
  const char* name;
  TransparentScene (*make)();
};

constexpr NamedTransparentScene kTransparentScenes[] = {
    {"planes", [] { return planes(0); }},
    {"planes_noise_quarter", [] { return planes(0.25); }},
    {"planes_noise_half", [] { return planes(0.5); }},
    {"planes_normal_noise", [] { return planes(0.5, true); }},
    {"spheres", [] { return spheres(0); }},
    {"spheres_noise_half", [] { return spheres(0.5); }},
    {"spheres_normal_noise", [] { return spheres(0.5, true); }},
    {"sheets_two_radii", [] { return two_sheets(2); }},
    {"sheets_one_radius", [] { return two_sheets(1); }},
    {"crossing_planes", [] { return crossing_planes(); }},
    {"alpha_texture", [] { return alpha_texture(); }},
    {"glass_shell", [] { return glass_shell(); }},
};

/// Calls visit(origin, direction) for a ray of the scene's camera.
template <typename Visit>
auto along_ray(const geometry::CameraFrame& frame, const glm::dvec2& pixel, const Visit& visit) {
  const glm::dvec3 ray = frame.ray(pixel);
  return visit(frame.eye, frame.right * ray.x + frame.up * ray.y + frame.forward * ray.z);
}

}  // namespace

std::vector<std::string> transparent_scene_names() {
  std::vector<std::string> names;
  for (const NamedTransparentScene& scene : kTransparentScenes) names.emplace_back(scene.name);
  return names;
}

TransparentScene make_transparent_scene(const std::string& name) {
  const auto* found = std::find_if(std::begin(kTransparentScenes), std::end(kTransparentScenes),
                                   [&](const auto& s) { return s.name == name; });
  SURFCAST_EXPECTS(found != std::end(kTransparentScenes));
  TransparentScene scene = found->make();
  scene.name = name;
  return scene;
}

LinearPicture ideal_picture(const TransparentScene& scene) {
  const auto frame = geometry::make_camera_frame(*scene.request.camera, scene.request.width, scene.request.height);
  SURFCAST_EXPECTS(frame.has_value());
  const glm::dvec3 background = linear_from_srgb8(glm::dvec3(scene.request.background));
  return filtered_picture(frame->width, frame->height, [&](const glm::dvec2& pixel) {
    glm::dvec3 light{0};
    double transmittance = 1;
    for (const Layer& layer : along_ray(*frame, pixel, scene.layers)) {
      light += transmittance * layer.opacity * layer.color;
      transmittance *= 1 - layer.opacity;
    }
    return light + transmittance * background;
  });
}

std::vector<bool> inside(const TransparentScene& scene) {
  const auto frame = geometry::make_camera_frame(*scene.request.camera, scene.request.width, scene.request.height);
  SURFCAST_EXPECTS(frame.has_value());
  const auto sheets_at = [&](const glm::dvec2& pixel) {
    std::vector<int> sheets;
    for (const Layer& layer : along_ray(*frame, pixel, scene.layers)) sheets.push_back(layer.sheet);
    return sheets;
  };
  std::vector<bool> mask;
  for (int y = 0; y < frame->height; ++y) {
    for (int x = 0; x < frame->width; ++x) {
      const std::vector<int> here = sheets_at({x + 0.5, y + 0.5});
      bool same = !here.empty();
      for (int v = -kPixelFilterReach; same && v <= kPixelFilterReach; ++v) {
        for (int u = -kPixelFilterReach; same && u <= kPixelFilterReach; ++u)
          same = sheets_at({x + u + 0.5, y + v + 0.5}) == here;
      }
      mask.push_back(same);
    }
  }
  return mask;
}

double masked_psnr(const SrgbPicture& a, const SrgbPicture& b, const std::vector<bool>& mask) {
  double sum = 0;
  size_t count = 0;
  for (size_t i = 0; i < mask.size(); ++i) {
    if (!mask[i]) continue;
    const glm::dvec3 d = glm::dvec3(a.pixels[i]) - glm::dvec3(b.pixels[i]);
    sum += glm::dot(d, d);
    count += 3;
  }
  SURFCAST_EXPECTS(count > 0);
  return sum == 0 ? std::numeric_limits<double>::infinity()
                  : 10 * std::log10(255.0 * 255.0 * static_cast<double>(count) / sum);
}

}  // namespace surfcast::reference
