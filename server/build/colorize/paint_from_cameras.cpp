#include "colorize/paint_from_cameras.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <string>
#include <utility>

#include "mesh/texel_color.h"
#include "mesh/texture.h"
#include "surfel/srgb.h"

namespace surfcast::colorize {
namespace {

/// More than the pictures show, because distortion moves their borders.
constexpr double kMargin = 1.15;
/// Pixels of a front surface, at most.
constexpr double kMaxPixels = 1 << 20;
/// Share of a picture's shorter side over which its weight grows from nothing at the border.
constexpr double kFeather = 0.05;
constexpr size_t kBest = 3;

/// The camera without distortion, its principal point in the middle.
geometry::CameraFrame frame_of(const PhotoCamera& camera, const mesh::Texture& texture) {
  const glm::dvec2 size(texture.width, texture.height);
  const glm::dvec2 reach = kMargin * glm::max(camera.principal, size - camera.principal) / camera.focal;
  const double fitting = std::sqrt(kMaxPixels / (4 * reach.x * reach.y));
  geometry::CameraFrame frame;
  frame.eye = camera.position;
  const glm::dmat3 to_world = glm::transpose(camera.to_camera);
  frame.right = to_world[0];
  frame.up = -to_world[1];
  frame.forward = to_world[2];
  frame.eta = std::min(fitting, std::max(camera.focal.x, camera.focal.y));
  frame.width = std::max(1, static_cast<int>(2 * reach.x * frame.eta));
  frame.height = std::max(1, static_cast<int>(2 * reach.y * frame.eta));
  return frame;
}

/// What a picture has to say of a point.
struct Vote {
  double weight = 0;
  glm::vec3 light{0};
};

struct Sight {
  bool inside = false;
  Vote vote;
};

/// From 0 at the border to 1.
double feather(const mesh::Texture& texture, const glm::dvec2& pixel) {
  const glm::dvec2 size(texture.width, texture.height);
  const glm::dvec2 nearest = glm::min(pixel, size - pixel);
  return std::clamp(std::min(nearest.x, nearest.y) / (kFeather * std::min(size.x, size.y)), 0.0, 1.0);
}

/// The pixel of the front surface that shows the point; null beside it.
const pick::FrontPixel* front_at(const Photo& photo, const glm::dvec3& p) {
  const glm::dvec3 local = photo.frame.to_camera(p);
  const glm::dvec2 pixel = glm::floor(photo.frame.project(local));
  const bool inside = pixel.x >= 0 && pixel.y >= 0 && pixel.x < photo.frame.width && pixel.y < photo.frame.height;
  if (!inside) return nullptr;
  return &photo.front[static_cast<size_t>(pixel.y) * static_cast<size_t>(photo.frame.width) +
                      static_cast<size_t>(pixel.x)];
}

Sight look(const Photo& photo, const glm::dvec3& p, double tolerance) {
  const std::optional<PhotoCamera::Seen> seen = photo.camera.project(p);
  if (!seen) return {};
  const double border = feather(photo.texture, seen->pixel);
  const pick::FrontPixel* front = border > 0 ? front_at(photo, p) : nullptr;
  if (front == nullptr) return {};
  Sight sight{true, {}};
  if (seen->local.z > front->depth + tolerance) return sight;
  const glm::dvec3 ray = p - photo.camera.position;
  const double distance = glm::length(ray);
  const double facing = std::abs(glm::dot(glm::dvec3(front->normal), ray)) / distance;
  sight.vote.weight = border * std::pow(facing * photo.camera.focal.x / distance, 2);
  const glm::vec4 light = mesh::mean_light(photo.texture, {seen->pixel, glm::dvec2(0)},
                                           {mesh::Wrap::kClamp, mesh::Wrap::kClamp}, true, nullptr, 0);
  sight.vote.light = glm::vec3(light);
  return sight;
}

Paint paint(const std::vector<Photo>& photos, double tolerance, const glm::dvec3& p, glm::u8vec3& color) {
  std::vector<Vote> votes;
  bool inside = false;
  for (const Photo& photo : photos) {
    const Sight sight = look(photo, p, tolerance);
    inside = inside || sight.inside;
    if (sight.vote.weight > 0) votes.push_back(sight.vote);
  }
  if (votes.empty()) return inside ? Paint::kHidden : Paint::kOutside;
  const size_t best = std::min(kBest, votes.size());
  std::partial_sort(votes.begin(), votes.begin() + static_cast<std::ptrdiff_t>(best), votes.end(),
                    [](const Vote& a, const Vote& b) { return a.weight > b.weight; });
  glm::dvec3 sum(0);
  double weights = 0;
  for (size_t i = 0; i < best; ++i) {
    sum += votes[i].weight * glm::dvec3(votes[i].light);
    weights += votes[i].weight;
  }
  color = glm::u8vec3(surfel::from_linear(glm::vec3(sum / weights), 8));
  return Paint::kPainted;
}

}  // namespace

Result<std::vector<Photo>> take_photos(std::span<const PhotoCamera> cameras, const model::ModelFile& model,
                                       const scan::DecodingLimit& limit) {
  constexpr size_t kBlockBytes = size_t{256} << 20;
  pick::SourceBlocks blocks(kBlockBytes);
  const std::atomic<bool> never{false};
  std::vector<Photo> photos;
  uint64_t bytes = 0;
  for (const PhotoCamera& camera : cameras) {
    const std::string name = camera.image.string();
    Result<mesh::Texture> texture = mesh::read_texture({name, camera.image, {}, {}}, limit);
    if (!texture) return fail_about(name, texture);
    Photo photo{camera, std::move(*texture), {}, {}};
    photo.frame = frame_of(camera, photo.texture);
    kinds::PickQuery query;
    query.frame = photo.frame;
    Result<std::vector<pick::FrontPixel>> front = pick::find_front_surface(model, query, blocks, never);
    if (!front) return fail(front);
    photo.front = std::move(*front);
    bytes += photo.texture.texels.size() * 4 + photo.front.size() * sizeof(pick::FrontPixel);
    if (Status status = limit.check(bytes); !status) return fail_about(name, status);
    photos.push_back(std::move(photo));
  }
  return photos;
}

Painter painter_of(const std::vector<Photo>& photos, double tolerance) {
  return [&photos, tolerance](const glm::dvec3& p, glm::u8vec3& color) { return paint(photos, tolerance, p, color); };
}

}  // namespace surfcast::colorize
