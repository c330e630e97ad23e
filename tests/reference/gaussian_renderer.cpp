#include "reference/gaussian_renderer.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>

#include "reference/affine_kernel.h"
#include "reference/infinity.h"
#include "reference/ray_kernel.h"
#include "reference/transfer_function.h"

namespace surfcast::reference {
namespace {

constexpr int kTrainedTile = 16;    ///< pixels
constexpr int kGaussianTile = 8;    ///< of exact pictures, pixels
constexpr int kBorder = 5;          ///< pixels about an exact picture in which there may be rays
constexpr double kMinSpread = 0.1;  ///< square pixels, of the larger axis' squared distance from the mean
constexpr double kReach = 3;        ///< of a splat as trained, deviations
constexpr double kDiscScreen = 2;   ///< inverse variance of a disc's smallest footprint (Huang 2024), 1 / px^2

struct GaussianFragment {
  double depth = 0;
  double alpha = 0;
  glm::dvec3 color{0};
};

/// Tiles of the picture that a splat touches: [x0, x1) x [y0, y1).
struct TileRect {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;
};

/// Lists of splats by tile, in the order in which they were added.
class TileLists {
 public:
  TileLists(int width, int height, int tile)
      : tile_(tile), columns_((width + tile - 1) / tile), rows_((height + tile - 1) / tile) {
    lists_.resize(static_cast<size_t>(columns_) * rows_);
  }
  void add(const TileRect& rect, size_t splat) {
    for (int y = std::max(0, rect.y0); y < std::min(rows_, rect.y1); ++y) {
      for (int x = std::max(0, rect.x0); x < std::min(columns_, rect.x1); ++x) {
        lists_[static_cast<size_t>(y) * columns_ + x].push_back(splat);
      }
    }
  }
  [[nodiscard]] const std::vector<size_t>& at(const glm::dvec2& pixel) const {
    const int x = std::clamp(static_cast<int>(pixel.x) / tile_, 0, columns_ - 1);
    const int y = std::clamp(static_cast<int>(pixel.y) / tile_, 0, rows_ - 1);
    return lists_[static_cast<size_t>(y) * columns_ + x];
  }
  [[nodiscard]] TileRect everywhere() const { return {0, 0, columns_, rows_}; }

 private:
  int tile_;
  int columns_;
  int rows_;
  std::vector<std::vector<size_t>> lists_;
};

/// The factor in the camera frame.
glm::dmat3 in_camera(const glm::dmat3& factor, const geometry::CameraFrame& frame) {
  return {frame.rotate(factor[0]), frame.rotate(factor[1]), frame.rotate(factor[2])};
}

struct TrainedSplat {
  double depth;
  glm::dvec2 pixel;  ///< of the centre
  double opacity;
  glm::dvec3 color;
  AffineKernel footprint;
  RayKernel disc;
};

class TrainedScene {
 public:
  TrainedScene(const GaussianModel& model, const geometry::CameraFrame& frame, GaussianConvention convention,
               const TrainedRules& rules)
      : frame_(frame), convention_(convention), rules_(rules), lists_(frame.width, frame.height, kTrainedTile) {
    for (const GaussianSplat& splat : model.splats) add(splat, model.degree);
    std::stable_sort(splats_.begin(), splats_.end(), [](const auto& a, const auto& b) { return a.depth < b.depth; });
    for (size_t i = 0; i < splats_.size(); ++i) lists_.add(tiles_of(splats_[i]), i);
  }

  [[nodiscard]] glm::dvec4 light(const glm::dvec2& pixel) const {
    RayLight ray;
    for (const size_t i : lists_.at(pixel)) {
      const double alpha = opacity_at(splats_[i], pixel);
      if (alpha < rules_.least) continue;
      if (ray.transmittance * (1 - alpha) < rules_.clear) break;
      ray.add_surface(splats_[i].color, alpha);
    }
    return ray.premultiplied();
  }

 private:
  void add(const GaussianSplat& splat, int degree) {
    const auto factor = splat_factor(splat);
    const glm::dvec3 o = frame_.to_camera(splat.position);
    if (!factor || !(o.z > rules_.near)) return;
    const glm::dmat3 shape = in_camera(*factor, frame_);
    const glm::dvec2 half_view = 0.5 * glm::dvec2(frame_.width, frame_.height) / frame_.eta;
    const AffineKernel footprint(o, shape, frame_.eta, rules_.dilation, rules_.clamp * half_view);
    const bool antialiased = convention_ == GaussianConvention::kAntialiased;
    const double opacity = splat_opacity(splat) * (antialiased ? footprint.compensation() : 1);
    const glm::dmat3 flat{shape[0], shape[1], glm::dvec3(0)};
    splats_.push_back({o.z, frame_.project(o), opacity, splat_color(splat, degree, frame_.eye), footprint,
                       RayKernel(o, flat, frame_.eta, 0)});
  }

  [[nodiscard]] double opacity_at(const TrainedSplat& splat, const glm::dvec2& pixel) const {
    const glm::dvec3 d = frame_.ray(pixel);
    return std::min(rules_.most, splat.opacity * std::exp(-0.5 * (convention_ == GaussianConvention::kFlat
                                                                      ? flat_r2(splat, pixel, d)
                                                                      : splat.footprint.r2(d))));
  }

  /// The disc where the ray hits it, but at least a Gaussian on the screen.
  [[nodiscard]] double flat_r2(const TrainedSplat& splat, const glm::dvec2& pixel, const glm::dvec3& d) const {
    const KernelOnRay hit = splat.disc.on_ray(d);
    const glm::dvec2 v = pixel - splat.pixel;
    const double on_screen = kDiscScreen * glm::dot(v, v);
    const double depth = hit.r2 <= on_screen ? hit.depth : splat.depth;
    return depth < rules_.near ? kInfinity : std::min(hit.r2, on_screen);
  }

  [[nodiscard]] TileRect tiles_of(const TrainedSplat& splat) const {
    if (!rules_.tiles || convention_ == GaussianConvention::kFlat) return lists_.everywhere();
    const glm::dvec3 s = splat.footprint.footprint();
    const double middle = 0.5 * (s.x + s.y);
    const double larger = middle + std::sqrt(std::max(kMinSpread, middle * middle - (s.x * s.y - s.z * s.z)));
    const double radius = std::ceil(kReach * std::sqrt(larger));
    // The rasterizer counts pixels from the centre of the first.
    const glm::dvec2 low = (splat.pixel - 0.5 - radius) / static_cast<double>(kTrainedTile);
    const glm::dvec2 high = (splat.pixel - 0.5 + radius + (kTrainedTile - 1.0)) / static_cast<double>(kTrainedTile);
    const auto tile = [](double x) { return static_cast<int>(std::clamp(x, 0.0, 1e6)); };
    return {tile(low.x), tile(low.y), tile(high.x), tile(high.y)};
  }

  const geometry::CameraFrame& frame_;
  GaussianConvention convention_;
  TrainedRules rules_;
  std::vector<TrainedSplat> splats_;
  TileLists lists_;
};

struct ExactSplat {
  RayKernel shape;
  double centre_depth;
  double opacity;
  glm::dvec3 color;
};

class ExactScene {
 public:
  ExactScene(const GaussianModel& model, const geometry::CameraFrame& frame, const ExactRules& rules)
      : frame_(frame), rules_(rules), lists_(frame.width + 2 * kBorder, frame.height + 2 * kBorder, kGaussianTile) {
    for (const GaussianSplat& splat : model.splats) add(splat, model.degree);
  }

  [[nodiscard]] glm::dvec4 light(const glm::dvec2& pixel) const {
    const glm::dvec3 d = frame_.ray(pixel);
    std::vector<GaussianFragment> fragments;
    for (const size_t i : lists_.at(pixel + static_cast<double>(kBorder))) {
      const KernelOnRay seen = splats_[i].shape.on_ray(d);
      if (!(seen.r2 <= rules_.cutoff)) continue;
      const double alpha = splats_[i].opacity * seen.gain * share_between(seen, 0, kInfinity);
      const double depth = rules_.order_by_pixel ? seen.depth : splats_[i].centre_depth;
      fragments.push_back({depth, alpha, splats_[i].color});
    }
    std::stable_sort(fragments.begin(), fragments.end(),
                     [](const GaussianFragment& a, const GaussianFragment& b) { return a.depth < b.depth; });
    RayLight ray;
    for (const GaussianFragment& fragment : fragments) ray.add_surface(fragment.color, fragment.alpha);
    return ray.premultiplied();
  }

 private:
  void add(const GaussianSplat& splat, int degree) {
    const auto factor = splat_factor(splat);
    if (!factor) return;
    const glm::dvec3 o = frame_.to_camera(splat.position);
    const RayKernel shape(o, in_camera(*factor, frame_), frame_.eta, rules_.prefilter);
    if (shape.behind(rules_.cutoff)) return;
    lists_.add(tiles_of(shape), splats_.size());
    splats_.push_back({shape, o.z, splat_opacity(splat), splat_color(splat, degree, frame_.eye)});
  }

  [[nodiscard]] TileRect tiles_of(const RayKernel& shape) const {
    const auto bounds = shape.bounds(rules_.cutoff);
    if (!bounds) return lists_.everywhere();
    const auto tile = [](double pixel) {
      return static_cast<int>(std::floor(std::clamp((pixel + kBorder) / kGaussianTile, -1.0, 1e6)));
    };
    return {tile(0.5 * frame_.width + frame_.eta * bounds->min.x),
            tile(0.5 * frame_.height - frame_.eta * bounds->max.y),
            tile(0.5 * frame_.width + frame_.eta * bounds->max.x) + 1,
            tile(0.5 * frame_.height - frame_.eta * bounds->min.y) + 1};
  }

  const geometry::CameraFrame& frame_;
  ExactRules rules_;
  std::vector<ExactSplat> splats_;
  TileLists lists_;
};

}  // namespace

LightPicture draw_as_trained(const GaussianModel& model, const geometry::CameraFrame& frame,
                             GaussianConvention convention, const TrainedRules& rules) {
  const TrainedScene scene(model, frame, convention, rules);
  return sampled_picture(frame.width, frame.height, [&](const glm::dvec2& pixel) { return scene.light(pixel); });
}

LightPicture draw_exactly(const GaussianModel& model, const geometry::CameraFrame& frame, const ExactRules& rules) {
  const ExactScene scene(model, frame, rules);
  return sampled_picture(frame.width, frame.height, [&](const glm::dvec2& pixel) { return scene.light(pixel); });
}

LightPicture ideal_picture(const GaussianModel& model, const geometry::CameraFrame& frame, int samples) {
  ExactRules rules;
  rules.prefilter = 0;
  const ExactScene scene(model, frame, rules);
  return prefiltered_picture(frame.width, frame.height, samples,
                             [&](const glm::dvec2& pixel) { return scene.light(pixel); });
}

}  // namespace surfcast::reference
