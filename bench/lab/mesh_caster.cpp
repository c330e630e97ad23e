#include "lab/mesh_caster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "base/contract.h"
#include "mesh/chart_map.h"
#include "mesh/placed_triangle.h"
#include "mesh/texture.h"

namespace surfcast::lab {
namespace {

using mesh::ChartMap;
using mesh::Mesh;
using mesh::Patch;
using mesh::PlacedTriangle;
using mesh::Texture;
using reference::LightPicture;

/// Where a ray meets a triangle.
struct Hit {
  double t = std::numeric_limits<double>::infinity();
  size_t triangle = 0;
  glm::dvec3 weights{0};
};

/// A triangle with what it takes to colour it.
struct CastTriangle {
  PlacedTriangle placed;
  size_t patch = 0;
  uint32_t chart = 0;
};

/// Möller and Trumbore 1997, from both sides.
void intersect(const glm::dvec3& origin, const glm::dvec3& ray, const PlacedTriangle& triangle, size_t number,
               Hit& hit) {
  const glm::dvec3 a = triangle.positions[1] - triangle.positions[0];
  const glm::dvec3 b = triangle.positions[2] - triangle.positions[0];
  const glm::dvec3 p = glm::cross(ray, b);
  const double determinant = glm::dot(a, p);
  if (determinant == 0) return;
  const glm::dvec3 from = origin - triangle.positions[0];
  const double u = glm::dot(from, p) / determinant;
  const glm::dvec3 q = glm::cross(from, a);
  const double v = glm::dot(ray, q) / determinant;
  const double t = glm::dot(b, q) / determinant;
  if (u < 0 || v < 0 || u + v > 1 || t <= 0 || t >= hit.t) return;
  hit = {t, number, {1 - u - v, u, v}};
}

/// A binary tree of boxes, split at the median of the longest axis.
class Tree {
 public:
  explicit Tree(const std::vector<CastTriangle>& triangles) : triangles_(triangles), order_(triangles.size()) {
    std::iota(order_.begin(), order_.end(), size_t{0});
    build(0, order_.size());
  }

  [[nodiscard]] Hit first_hit(const glm::dvec3& origin, const glm::dvec3& ray) const {
    Hit hit;
    std::array<size_t, 128> open{};
    size_t count = 1;
    while (count > 0) {
      const Node& node = nodes_[open[--count]];
      if (!meets(node.box, origin, ray, hit.t)) continue;
      if (node.right == 0) {
        for (size_t i = node.first; i < node.end; ++i) {
          intersect(origin, ray, triangles_[order_[i]].placed, order_[i], hit);
        }
      } else {
        open[count++] = node.right;
        open[count++] = static_cast<size_t>(&node - nodes_.data()) + 1;
      }
    }
    return hit;
  }

 private:
  struct Node {
    geometry::Box box;
    size_t first = 0;
    size_t end = 0;
    size_t right = 0;
  };

  static bool meets(const geometry::Box& box, const glm::dvec3& origin, const glm::dvec3& ray, double most) {
    double near = 0;
    double far = most;
    for (int axis = 0; axis < 3; ++axis) {
      const double a = (box.min[axis] - origin[axis]) / ray[axis];
      const double b = (box.max[axis] - origin[axis]) / ray[axis];
      near = std::max(near, std::min(a, b));
      far = std::min(far, std::max(a, b));
    }
    return near <= far * (1 + 1e-9) + 1e-12;
  }

  size_t build(size_t first, size_t end) {
    const size_t own = nodes_.size();
    nodes_.push_back({});
    geometry::Box box;
    for (size_t i = first; i < end; ++i) {
      for (const glm::dvec3& p : triangles_[order_[i]].placed.positions) box.include(p);
    }
    nodes_[own] = {box, first, end, 0};
    if (end - first <= 4) return own;
    const glm::dvec3 size = box.size();
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const size_t middle = (first + end) / 2;
    const auto key = [&](size_t i) {
      const auto& p = triangles_[i].placed.positions;
      return p[0][axis] + p[1][axis] + p[2][axis];
    };
    std::nth_element(
        order_.begin() + static_cast<std::ptrdiff_t>(first), order_.begin() + static_cast<std::ptrdiff_t>(middle),
        order_.begin() + static_cast<std::ptrdiff_t>(end), [&](size_t a, size_t b) { return key(a) < key(b); });
    build(first, middle);
    nodes_[own].right = build(middle, end);
    return own;
  }

  const std::vector<CastTriangle>& triangles_;
  std::vector<size_t> order_;
  std::vector<Node> nodes_;
};

/// Mean square error in dB of the pixels that `counts` takes.
template <typename Counts>
double decibels_of(const LightPicture& ideal, const reference::SrgbPicture& picture, const Counts& counts) {
  const reference::SrgbPicture codes = encode(ideal);
  double sum = 0;
  size_t count = 0;
  for (size_t i = 0; i < codes.pixels.size(); ++i) {
    if (!counts(ideal.pixels[i])) continue;
    const glm::dvec3 d = glm::dvec3(codes.pixels[i]) - glm::dvec3(picture.pixels[i]);
    sum += glm::dot(d, d);
    count += 3;
  }
  return 10 * std::log10(255.0 * 255.0 * static_cast<double>(count) / sum);
}

}  // namespace

/// A mesh with its textures decoded.
class CastScene {
 public:
  explicit CastScene(const Mesh& mesh) : mesh_(mesh) {
    std::map<size_t, std::vector<const Patch*>> by_material;
    for (const Patch& patch : mesh.patches) by_material[patch.material].push_back(&patch);
    for (const auto& [number, patches] : by_material) add(number, patches);
    tree_ = std::make_unique<Tree>(triangles_);
  }

  /// Premultiplied light along a ray.
  [[nodiscard]] glm::dvec4 light(const glm::dvec3& origin, const glm::dvec3& ray) const {
    const Hit hit = tree_->first_hit(origin, ray);
    if (!std::isfinite(hit.t)) return glm::dvec4(0);
    return {color_at(hit), 1};
  }

 private:
  void add(size_t number, const std::vector<const Patch*>& patches) {
    const mesh::Material& material = mesh_.materials[number];
    const Texture* texture = nullptr;
    if (material.image) {
      if (Result<Texture> decoded = mesh::read_texture(mesh_.images[*material.image], {})) {
        texture = (textures_[number] = std::make_unique<Texture>(std::move(*decoded))).get();
        charts_[number] = std::make_unique<ChartMap>(patches, texture->size(), material.wrap);
      }
    }
    for (size_t p = 0; p < patches.size(); ++p) {
      for (size_t t = 0; t < patches[p]->triangles->size(); ++t) {
        const uint32_t chart = texture != nullptr ? charts_[number]->chart(p, t) : 0;
        triangles_.push_back({place(*patches[p], (*patches[p]->triangles)[t], false), number, chart});
      }
    }
  }

  [[nodiscard]] glm::dvec3 color_at(const Hit& hit) const {
    const CastTriangle& triangle = triangles_[hit.triangle];
    const mesh::Material& material = mesh_.materials[triangle.patch];
    glm::dvec3 color(material.color);
    const auto mixed = [&](const auto& corners) {
      return hit.weights.x * glm::dvec3(corners[0]) + hit.weights.y * glm::dvec3(corners[1]) +
             hit.weights.z * glm::dvec3(corners[2]);
    };
    if (triangle.placed.colors) color *= mixed(*triangle.placed.colors);
    const auto texture = textures_.find(triangle.patch);
    if (texture == textures_.end() || !triangle.placed.uvs) return color;
    const auto& uvs = *triangle.placed.uvs;
    const glm::dvec2 uv = hit.weights.x * uvs[0] + hit.weights.y * uvs[1] + hit.weights.z * uvs[2];
    return color * bilinear(*texture->second, *charts_.at(triangle.patch), triangle.chart, material.wrap, uv);
  }

  static glm::dvec3 bilinear(const Texture& texture, const ChartMap& charts, uint32_t chart,
                             const std::array<mesh::Wrap, 2>& wrap, const glm::dvec2& uv) {
    const glm::dvec2 at = uv * glm::dvec2(texture.width, texture.height) - 0.5;
    const glm::dvec2 first = glm::floor(at);
    glm::dvec3 sum(0);
    double weights = 0;
    for (int tap = 0; tap < 4; ++tap) {
      const glm::dvec2 texel = first + glm::dvec2(tap % 2, tap / 2);
      const glm::dvec2 near = 1.0 - glm::abs(at - texel);
      const int64_t x = mesh::wrapped(static_cast<int64_t>(texel.x), texture.width, wrap[0]);
      const int64_t y = mesh::wrapped(static_cast<int64_t>(texel.y), texture.height, wrap[1]);
      if (!charts.holds(x, y, chart)) continue;
      const auto& code = texture.at(x, y);
      const double weight = near.x * near.y + 1e-12;
      sum += weight * reference::linear_from_srgb8({code[0], code[1], code[2]});
      weights += weight;
    }
    return weights > 0 ? sum / weights : glm::dvec3(0);
  }

  const Mesh& mesh_;
  std::map<size_t, std::unique_ptr<Texture>> textures_;
  std::map<size_t, std::unique_ptr<ChartMap>> charts_;
  std::vector<CastTriangle> triangles_;
  std::unique_ptr<Tree> tree_;
};

MeshCaster::MeshCaster(const Mesh& mesh) : scene_(std::make_unique<CastScene>(mesh)) {}

MeshCaster::~MeshCaster() = default;

LightPicture MeshCaster::picture(const geometry::CameraFrame& frame) const {
  constexpr int kRays = 8;
  return reference::prefiltered_picture(frame.width, frame.height, kRays, [&](const glm::dvec2& pixel) {
    const glm::dvec3 ray = frame.ray(pixel);
    return scene_->light(frame.eye, ray.x * frame.right + ray.y * frame.up + ray.z * frame.forward);
  });
}

MeshError error_of(const LightPicture& ideal, const reference::SrgbPicture& picture) {
  SURFCAST_EXPECTS(ideal.width == picture.width && ideal.height == picture.height);
  return {decibels_of(ideal, picture, [](const glm::dvec4&) { return true; }),
          decibels_of(ideal, picture, [](const glm::dvec4& light) { return light.a >= 1 - 1e-9; })};
}

}  // namespace surfcast::lab
