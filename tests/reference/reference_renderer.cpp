#include "reference/reference_renderer.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include "base/contract.h"
#include "reference/headlight.h"

namespace surfcast::reference {
namespace {

constexpr int kTile = 16;              ///< pixels
constexpr double kMeanRadius = 1.08;   ///< stored radius of well spread samples over their spacing h
constexpr double kNoPrefilter = 0.01;  ///< pixels: no blur to speak of, yet r2 stays finite edge-on

/// A surfel ready to be drawn: what it is seen as, and what it adds.
struct DrawnSurfel {
  Splat splat;
  glm::dvec3 value;  ///< linear colour, or the normal towards the eye where the picture is lit
  double multiplier = 1;
};

/// Pixels [x0, x1) x [y0, y1).
struct PixelRect {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;
};

PixelRect intersect(const PixelRect& a, const PixelRect& b) {
  return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

PixelRect pixel_bounds(const Splat& splat, const CameraFrame& frame) {
  const Splat::Bounds b = splat.bounds();
  const auto column = [&](double x) { return std::clamp(0.5 * frame.width + frame.eta * x, -1.0, frame.width + 1.0); };
  const auto row = [&](double y) { return std::clamp(0.5 * frame.height - frame.eta * y, -1.0, frame.height + 1.0); };
  return intersect({static_cast<int>(std::floor(column(b.min.x))), static_cast<int>(std::floor(row(b.max.y))),
                    static_cast<int>(std::ceil(column(b.max.x))), static_cast<int>(std::ceil(row(b.min.y)))},
                   {0, 0, frame.width, frame.height});
}

glm::dvec3 linear_color(const ColorAttribute& colors, size_t i) {
  const double top = colors.bits == 16 ? 65535.0 : 255.0;
  return linear_from_srgb8(glm::dvec3(colors.values[i]) * (255.0 / top));
}

double weight_scale(const KernelParameters& kernel) {
  const double deviation = kernel.sigma * kMeanRadius;
  return 1 / (2 * std::numbers::pi * deviation * deviation);
}

/// The scene in camera coordinates, with the surfels that touch each tile in their order in the cloud.
class TiledScene {
 public:
  TiledScene(const SurfelCloud& cloud, const PictureRequest& request, const CameraFrame& frame,
             const KernelParameters& kernel)
      : frame_(frame), columns_((frame.width + kTile - 1) / kTile), rows_((frame.height + kTile - 1) / kTile) {
    tiles_.resize(static_cast<size_t>(columns_) * rows_);
    lit_ = request.shading == Shading::kLit || (request.shading == Shading::kAuto && !cloud.colors);
    for (size_t i = 0; i < cloud.size(); ++i) add(cloud, i, request, kernel);
  }

  [[nodiscard]] bool lit() const { return lit_; }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] PixelRect rect(int column, int row) const {
    return intersect({column * kTile, row * kTile, (column + 1) * kTile, (row + 1) * kTile},
                     {0, 0, frame_.width, frame_.height});
  }
  /// Calls visit(surfel, pixels) for every surfel of a tile, with the pixels of the tile it may touch.
  template <typename Visit>
  void for_each_surfel(int column, int row, const Visit& visit) const {
    const PixelRect tile = rect(column, row);
    for (const uint32_t i : tiles_[static_cast<size_t>(row) * columns_ + column]) {
      visit(surfels_[i], intersect(bounds_[i], tile));
    }
  }

 private:
  void add(const SurfelCloud& cloud, size_t i, const PictureRequest& request, const KernelParameters& kernel) {
    const glm::dvec3 o = frame_.to_camera(cloud.positions[i]);
    const glm::dvec3 n = frame_.rotate(glm::dvec3(cloud.normals[i]));
    if (cloud.oriented && glm::dot(n, o) > 0) return;
    const double prefilter = request.filter == Filter::kEwa ? 1.0 : kNoPrefilter;
    const auto splat = Splat::make(o, n, cloud.radii[i], frame_.eta, prefilter, kernel);
    if (!splat) return;
    const PixelRect bounds = pixel_bounds(*splat, frame_);
    if (bounds.x0 >= bounds.x1 || bounds.y0 >= bounds.y1) return;
    const glm::dvec3 facing = glm::dot(n, o) > 0 ? -n : n;
    const glm::dvec3 value = lit_ ? facing : cloud.colors ? linear_color(*cloud.colors, i) : glm::dvec3(kAlbedo);
    const bool per_surfel = request.normalization == Normalization::kSurfel;
    surfels_.push_back({*splat, value, per_surfel ? cloud.weights[i] : weight_scale(kernel)});
    bounds_.push_back(bounds);
    bin(static_cast<uint32_t>(surfels_.size() - 1), bounds);
  }

  void bin(uint32_t surfel, const PixelRect& bounds) {
    for (int row = bounds.y0 / kTile; row <= (bounds.y1 - 1) / kTile; ++row) {
      for (int column = bounds.x0 / kTile; column <= (bounds.x1 - 1) / kTile; ++column) {
        tiles_[static_cast<size_t>(row) * columns_ + column].push_back(surfel);
      }
    }
  }

  const CameraFrame& frame_;
  int columns_;
  int rows_;
  bool lit_ = false;
  std::vector<DrawnSurfel> surfels_;
  std::vector<PixelRect> bounds_;
  std::vector<std::vector<uint32_t>> tiles_;
};

/// Both passes over one tile.
class TilePass {
 public:
  TilePass(const TiledScene& scene, const CameraFrame& frame, const KernelParameters& kernel, int column, int row)
      : scene_(scene), frame_(frame), kernel_(kernel), column_(column), row_(row), rect_(scene.rect(column, row)) {}

  void draw() {
    scene_.for_each_surfel(column_, row_, [&](const DrawnSurfel& s, const PixelRect& r) { draw_depth(s, r); });
    scene_.for_each_surfel(column_, row_, [&](const DrawnSurfel& s, const PixelRect& r) { accumulate(s, r); });
  }
  void resolve(const PictureRequest& request, ReferencePicture& out) const {
    const glm::dvec3 background = linear_from_srgb8(glm::dvec3(request.background));
    for_each_pixel(rect_, [&](size_t local, const glm::dvec3& d, size_t global) {
      const double a = weights_[local];
      const double coverage = std::min(1.0, a);
      out.weights[global] = a;
      out.coverage[global] = coverage;
      const glm::dvec3 color = a > 0 ? shade(values_[local] / a, d) : background;
      out.picture.pixels[global] = coverage < 1 ? glm::mix(background, color, coverage) : color;
    });
  }
  [[nodiscard]] uint64_t fragments() const { return fragments_; }

 private:
  template <typename Visit>
  void for_each_pixel(const PixelRect& rect, const Visit& visit) const {
    for (int y = rect.y0; y < rect.y1; ++y) {
      for (int x = rect.x0; x < rect.x1; ++x) {
        const size_t local = static_cast<size_t>(y - rect_.y0) * kTile + (x - rect_.x0);
        visit(local, frame_.ray({x + 0.5, y + 0.5}), static_cast<size_t>(y) * frame_.width + x);
      }
    }
  }

  void draw_depth(const DrawnSurfel& surfel, const PixelRect& rect) {
    for_each_pixel(rect, [&](size_t local, const glm::dvec3& d, size_t) {
      if (!surfel.splat.opaque(d)) return;
      depths_[local] = std::min(depths_[local], surfel.splat.disc_depth(d));
    });
  }

  void accumulate(const DrawnSurfel& surfel, const PixelRect& rect) {
    for_each_pixel(rect, [&](size_t local, const glm::dvec3& d, size_t) {
      const Fragment f = surfel.splat.fragment(d);
      if (surfel.splat.cut(f.r2)) return;
      ++fragments_;
      if (surfel.splat.fragment_depth(d) > depths_[local]) return;
      const double w = surfel.multiplier / saturation(f.gain, kernel_) * f.gain * std::exp(-0.5 * f.r2);
      weights_[local] += w;
      values_[local] += w * surfel.value;
    });
  }

  [[nodiscard]] glm::dvec3 shade(const glm::dvec3& value, const glm::dvec3& d) const {
    return scene_.lit() ? headlight(value, d) : value;
  }

  const TiledScene& scene_;
  const CameraFrame& frame_;
  const KernelParameters& kernel_;
  int column_;
  int row_;
  PixelRect rect_;
  uint64_t fragments_ = 0;
  std::array<double, kTile* kTile> depths_ = filled(std::numeric_limits<double>::infinity());
  std::array<double, kTile* kTile> weights_ = filled(0);
  std::array<glm::dvec3, kTile * kTile> values_{};

  static std::array<double, kTile * kTile> filled(double value) {
    std::array<double, kTile * kTile> a{};
    a.fill(value);
    return a;
  }
};

}  // namespace

double saturation(double gain, const KernelParameters& kernel) {
  return glm::mix(kernel.coverage_minified, kernel.coverage_magnified, gain);
}

ReferencePicture render(const SurfelCloud& cloud, const PictureRequest& request, const KernelParameters& kernel) {
  SURFCAST_EXPECTS(request.camera.has_value());
  const auto frame = make_camera_frame(*request.camera, request.width, request.height);
  SURFCAST_EXPECTS(frame.has_value());
  const TiledScene scene(cloud, request, *frame, kernel);
  const size_t pixels = static_cast<size_t>(request.width) * request.height;
  ReferencePicture out{{request.width, request.height}, std::vector<double>(pixels), std::vector<double>(pixels), 0};
  std::atomic<uint64_t> fragments = 0;
  tbb::parallel_for(tbb::blocked_range2d<int>(0, scene.rows(), 0, scene.columns()), [&](const auto& range) {
    for (int row = range.rows().begin(); row < range.rows().end(); ++row) {
      for (int column = range.cols().begin(); column < range.cols().end(); ++column) {
        TilePass pass(scene, *frame, kernel, column, row);
        pass.draw();
        pass.resolve(request, out);
        fragments += pass.fragments();
      }
    }
  });
  out.fragments = fragments;
  return out;
}

}  // namespace surfcast::reference
