#include "reference/transparent_renderer.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <tbb/parallel_for.h>

#include "base/contract.h"
#include "reference/headlight.h"
#include "reference/infinity.h"
#include "reference/reference_renderer.h"
#include "surfel/even_sampling.h"

namespace surfcast::reference {
namespace {

constexpr int kTransparentTile = 8;                ///< pixels
constexpr double kMaxOpacity = 1 - 1.0 / 4096;     ///< of a fragment of a medium: its optical depth is finite
constexpr double kLeastTransmittance = 1.0 / 128;  ///< transmittance below which nothing is visible

struct SeenSurfel {
  Splat splat;
  glm::dvec3 color{0};   ///< linear light
  glm::dvec3 normal{0};  ///< camera frame
  double opacity = 0;
  double depth = 0;         ///< along its normal
  double weight = 0;        ///< factor of the kernel, for coverage
  double count_weight = 0;  ///< factor of the kernel, for the sum that tells a surface from several
};

/// What a surfel contributes to a pixel.
struct PixelFragment {
  double depth = 0;
  double coverage = 0;  ///< 1: the surface covers the pixel
  double count = 0;     ///< 1: a whole surface
  double opacity = 0;
  glm::dvec3 color{0};
  glm::dvec3 normal{0};
};

/// An opaque disc where a pixel's ray meets it: the interval that its surface takes up.
struct PixelDisc {
  double depth = 0;  ///< of the fragment
  double begin = 0;
  double end = 0;
};

/// Fragments that belong together.
struct Surface {
  double coverage = 0;
  double count = 0;
  double opacity = 0;  ///< sum over the fragments, weighted by their counts
  glm::dvec3 light{0};
  glm::dvec3 normal{0};
  double end = 0;
  bool last = false;  ///< no disc: all that is left

  void add(const PixelFragment& f) {
    coverage += f.coverage;
    count += f.count;
    opacity += f.count * f.opacity;
    light += f.count * f.opacity * f.color;
    normal += f.count * f.opacity * f.normal;
  }
  void add(const Surface& other) {
    coverage += other.coverage;
    count += other.count;
    opacity += other.opacity;
    light += other.light;
    normal += other.normal;
    end = other.end;
    last = other.last;
  }
};

/// The surfaces along the ray of one pixel.
class Ray {
 public:
  Ray(const std::vector<SeenSurfel>& surfels, const std::vector<uint32_t>& tile, const glm::dvec3& d, bool lit,
      const KernelParameters& kernel, const TransparencyParameters& parameters)
      : d_(d), lit_(lit), kernel_(kernel), parameters_(parameters) {
    for (const uint32_t i : tile) add(surfels[i]);
  }

  void draw_surfaces() {
    Surface waiting;
    double limit = 0;
    int drawn = 0;
    for (int find = 0; find < parameters_.finds && drawn < parameters_.in_order && is_open(waiting); ++find) {
      double begin = 0;
      const Surface next = next_surface(limit, begin);
      if (find > 0 && joins(waiting, next, begin)) {
        waiting.add(next);
      } else {
        drawn += composite(waiting) ? 1 : 0;
        waiting = next;
      }
      limit = next.end;
      if (next.last) break;
    }
    composite(waiting);
    if (transmittance_ > kLeastTransmittance) draw_medium(limit);
  }

  /// Everything behind `limit`, without order.
  void draw_medium(double limit) {
    Surface all;
    double optical_depth = 0;
    for (const PixelFragment& f : fragments_) {
      if (f.depth <= limit) continue;
      all.add(f);
      optical_depth -= f.count * std::log1p(-std::min(f.opacity, kMaxOpacity));
    }
    blend(all, -std::expm1(-optical_depth));
  }

  [[nodiscard]] glm::dvec3 light() const { return light_; }
  [[nodiscard]] double transmittance() const { return transmittance_; }

 private:
  void add(const SeenSurfel& s) {
    const Fragment f = s.splat.fragment(d_);
    const double depth = s.splat.fragment_depth(d_);
    if (!s.splat.cut(f.r2)) {
      const double w = f.gain * s.splat.kernel(f.r2);
      fragments_.push_back(
          {depth, s.weight * w / saturation(f.gain, kernel_), s.count_weight * w, s.opacity, s.color, s.normal});
    }
    if (!s.splat.opaque(d_)) return;
    const double length = glm::length(d_);
    const double cosine = std::max(std::abs(glm::dot(s.normal, d_)) / length, parameters_.least_cosine);
    const double begin = s.splat.disc_depth(d_).unpushed;
    discs_.push_back({depth, begin, begin + s.depth / (cosine * length)});
  }

  /// The nearest surface behind `limit`. `begin`: nearest depth at which it joins what is in front.
  [[nodiscard]] Surface next_surface(double limit, double& begin) const {
    begin = kInfinity;
    double end = kInfinity;
    for (const PixelDisc& disc : discs_) {
      if (disc.depth <= limit) continue;
      end = std::min(end, disc.end);
      begin = std::min(begin, disc.begin - parameters_.repair * (disc.end - disc.begin));
    }
    Surface surface;
    surface.last = !std::isfinite(end);
    surface.end = end;
    for (const PixelDisc& disc : discs_) {
      if (disc.depth > limit && disc.begin <= end) surface.end = std::max(surface.end, disc.end);
    }
    for (const PixelFragment& f : fragments_) {
      if (f.depth > limit && f.depth <= surface.end) surface.add(f);
    }
    return surface;
  }

  [[nodiscard]] bool joins(const Surface& front, const Surface& next, double begin) const {
    return front.count + next.count <= parameters_.whole && begin <= front.end;
  }

  [[nodiscard]] double opacity_of(const Surface& surface) const {
    if (surface.opacity <= 0) return 0;
    const double sheets = 1 + std::max(0.0, surface.count - parameters_.whole) / parameters_.more;
    const double opacity = std::min(surface.opacity / surface.count, 1.0);
    return std::min(1.0, surface.coverage) * (1 - std::pow(1 - opacity, sheets));
  }

  /// True if something is to be seen behind the surface that waits.
  [[nodiscard]] bool is_open(const Surface& waiting) const {
    return transmittance_ * (1 - opacity_of(waiting)) > kLeastTransmittance;
  }

  /// False if there is nothing to be seen.
  bool composite(const Surface& surface) {
    blend(surface, opacity_of(surface));
    return surface.opacity > 0;
  }

  void blend(const Surface& surface, double opacity) {
    if (surface.opacity <= 0) return;
    const double shade = lit_ ? headlight(surface.normal, d_) : 1;
    light_ += transmittance_ * opacity * shade / surface.opacity * surface.light;
    transmittance_ *= 1 - opacity;
  }

  glm::dvec3 d_;
  bool lit_;
  const KernelParameters& kernel_;
  const TransparencyParameters& parameters_;
  std::vector<PixelFragment> fragments_;
  std::vector<PixelDisc> discs_;
  glm::dvec3 light_{0};
  double transmittance_ = 1;
};

glm::dvec3 linear_color(const surfel::SurfelCloud& cloud, size_t i) {
  if (!cloud.colors) return glm::dvec3(kAlbedo);
  const double top = cloud.colors->bits == 16 ? 65535.0 : 255.0;
  return linear_from_srgb8(glm::dvec3(cloud.colors->values[i]) * (255.0 / top));
}

/// The surfels of each tile.
class Scene {
 public:
  Scene(const surfel::SurfelCloud& cloud, const std::vector<double>& opacities, const geometry::CameraFrame& frame,
        bool per_surfel, const KernelParameters& kernel, const TransparencyParameters& parameters)
      : frame_(frame),
        columns_((frame.width + kTransparentTile - 1) / kTransparentTile),
        rows_((frame.height + kTransparentTile - 1) / kTransparentTile) {
    SURFCAST_EXPECTS(opacities.size() == cloud.size());
    tiles_.resize(static_cast<size_t>(columns_) * rows_);
    for (size_t i = 0; i < cloud.size(); ++i) {
      if (opacities[i] > 0) add(cloud, i, opacities[i], per_surfel, kernel, parameters);
    }
  }

  [[nodiscard]] const std::vector<SeenSurfel>& surfels() const { return surfels_; }
  [[nodiscard]] const std::vector<uint32_t>& tile_of(int x, int y) const {
    return tiles_[static_cast<size_t>(y / kTransparentTile) * columns_ + x / kTransparentTile];
  }

 private:
  void add(const surfel::SurfelCloud& cloud, size_t i, double opacity, bool per_surfel, const KernelParameters& kernel,
           const TransparencyParameters& parameters) {
    const glm::dvec3 o = frame_.to_camera(cloud.positions[i]);
    const glm::dvec3 stated = frame_.rotate(glm::dvec3(cloud.normals[i]));
    const bool scatter = cloud.is_scatter(i);
    const glm::dvec3 n = scatter ? -glm::normalize(o) : stated;
    const auto splat = Splat::make(o, n, cloud.radii[i], frame_.eta, 1, kernel);
    if (!splat) return;
    const double minified = 1 - splat->gain(o / o.z, 1);
    const double area = scatter ? 1 + (kernel.scatter_minified - 1) * std::pow(minified, kernel.scatter_power) : 1;
    const double weight = area * (per_surfel ? surfel::per_surfel_scale(kernel.sigma) * cloud.weights[i]
                                             : surfel::even_sampling_weight(kernel.sigma));
    const double own = per_surfel ? weight / parameters.sum : weight;
    surfels_.push_back({*splat, linear_color(cloud, i), glm::dot(stated, o) > 0 ? -stated : stated, opacity,
                        parameters.depth * cloud.radii[i], weight, own});
    bin(splat->bounds());
  }

  void bin(const Splat::Bounds& b) {
    const auto tile = [](double pixel, int count) {
      return static_cast<int>(std::clamp(std::floor(pixel / kTransparentTile), 0.0, count - 1.0));
    };
    const auto column = [&](double x) { return 0.5 * frame_.width + frame_.eta * x; };
    const auto row = [&](double y) { return 0.5 * frame_.height - frame_.eta * y; };
    for (int y = tile(row(b.max.y) - 1, rows_); y <= tile(row(b.min.y) + 1, rows_); ++y) {
      for (int x = tile(column(b.min.x) - 1, columns_); x <= tile(column(b.max.x) + 1, columns_); ++x) {
        tiles_[static_cast<size_t>(y) * columns_ + x].push_back(static_cast<uint32_t>(surfels_.size() - 1));
      }
    }
  }

  const geometry::CameraFrame& frame_;
  int columns_;
  int rows_;
  std::vector<SeenSurfel> surfels_;
  std::vector<std::vector<uint32_t>> tiles_;
};

template <typename Draw>
TransparentPicture render_rays(const surfel::SurfelCloud& cloud, const std::vector<double>& opacities,
                               const picture::PictureRequest& request, bool per_surfel, const KernelParameters& kernel,
                               const TransparencyParameters& parameters, const Draw& draw) {
  SURFCAST_EXPECTS(request.camera.has_value());
  const auto frame = geometry::make_camera_frame(*request.camera, request.width, request.height);
  SURFCAST_EXPECTS(frame.has_value());
  const Scene scene(cloud, opacities, *frame, per_surfel, kernel, parameters);
  const bool lit =
      request.shading == picture::Shading::kLit || (request.shading == picture::Shading::kAuto && !cloud.colors);
  const glm::dvec3 background = linear_from_srgb8(glm::dvec3(request.background));
  TransparentPicture result{LinearPicture(frame->width, frame->height), {}};
  result.opacity.resize(result.picture.pixels.size());
  tbb::parallel_for(0, frame->height, [&](int y) {
    for (int x = 0; x < frame->width; ++x) {
      Ray ray(scene.surfels(), scene.tile_of(x, y), frame->ray({x + 0.5, y + 0.5}), lit, kernel, parameters);
      draw(ray);
      const size_t place = result.picture.index(x, y);
      result.picture.pixels[place] = ray.light() + ray.transmittance() * background;
      result.opacity[place] = 1 - ray.transmittance();
    }
  });
  return result;
}

}  // namespace

TransparentPicture render_transparent(const surfel::SurfelCloud& cloud, const std::vector<double>& opacities,
                                      const picture::PictureRequest& request, const KernelParameters& kernel,
                                      const TransparencyParameters& parameters) {
  const bool per_surfel = request.normalization == picture::Normalization::kSurfel;
  return render_rays(cloud, opacities, request, per_surfel, kernel, parameters, [](Ray& ray) { ray.draw_surfaces(); });
}

TransparentPicture render_density(const surfel::SurfelCloud& cloud, const std::vector<double>& opacities,
                                  const picture::PictureRequest& request, const KernelParameters& kernel,
                                  const TransparencyParameters& parameters) {
  return render_rays(cloud, opacities, request, true, kernel, parameters, [](Ray& ray) { ray.draw_medium(0); });
}

}  // namespace surfcast::reference
