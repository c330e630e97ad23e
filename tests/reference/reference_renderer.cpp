#include "reference/reference_renderer.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include "base/contract.h"
#include "reference/headlight.h"
#include "reference/infinity.h"
#include "reference/silhouettes.h"
#include "surfel/even_sampling.h"

namespace surfcast::reference {
namespace {

constexpr int kTile = 16;  ///< pixels
constexpr int kMaxLayers = 8;
constexpr double kOpaque = 1.0 / 128;  ///< transmittance below which no further layer is drawn
constexpr double kNoPrefilter = 0.01;  ///< pixels; a negligible blur that keeps r2 finite for edge-on surfels

/// A surfel prepared for drawing: its splat and its contribution.
struct DrawnSurfel {
  Splat splat;
  glm::dvec3 color;   ///< linear light
  glm::dvec3 normal;  ///< towards the eye
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

bool is_empty(const PixelRect& rect) {
  return rect.x0 >= rect.x1 || rect.y0 >= rect.y1;
}

PixelRect grown(const PixelRect& rect, int pixels) {
  return {rect.x0 - pixels, rect.y0 - pixels, rect.x1 + pixels, rect.y1 + pixels};
}

PixelRect pixel_bounds(const Splat& splat, const geometry::CameraFrame& frame) {
  const Splat::Bounds b = splat.bounds();
  const auto column = [&](double x) { return std::clamp(0.5 * frame.width + frame.eta * x, -1.0, frame.width + 1.0); };
  const auto row = [&](double y) { return std::clamp(0.5 * frame.height - frame.eta * y, -1.0, frame.height + 1.0); };
  return intersect({static_cast<int>(std::floor(column(b.min.x))), static_cast<int>(std::floor(row(b.max.y))),
                    static_cast<int>(std::ceil(column(b.max.x))), static_cast<int>(std::ceil(row(b.min.y)))},
                   {0, 0, frame.width, frame.height});
}

glm::dvec3 linear_color(const surfel::ColorAttribute& colors, size_t i) {
  const double top = colors.bits == 16 ? 65535.0 : 255.0;
  return linear_from_srgb8(glm::dvec3(colors.values[i]) * (255.0 / top));
}

/// The prefilters and the position of samples.
struct Sampling {
  double whole_prefilter = 1;  ///< standard deviation for a pixel, pixels
  double prefilter = 1;        ///< standard deviation for a sample of a pixel, pixels
  int reach = 0;               ///< largest distance of a sample from the centre of its pixel, pixels
};

/// The scene in camera coordinates, with the surfels that touch each tile in their order in the cloud.
class TiledScene {
 public:
  TiledScene(const surfel::SurfelCloud& cloud, const picture::PictureRequest& request,
             const geometry::CameraFrame& frame, const KernelParameters& kernel, const PixelRect& window,
             const Sampling& sampling)
      : frame_(frame),
        sampling_(sampling),
        window_(window),
        columns_((window.x1 - window.x0 + kTile - 1) / kTile),
        rows_((window.y1 - window.y0 + kTile - 1) / kTile) {
    tiles_.resize(static_cast<size_t>(columns_) * rows_);
    lit_ = request.shading == picture::Shading::kLit || (request.shading == picture::Shading::kAuto && !cloud.colors);
    for (size_t i = 0; i < cloud.size(); ++i) add(cloud, i, request, kernel);
  }

  [[nodiscard]] bool lit() const { return lit_; }
  [[nodiscard]] const Sampling& sampling() const { return sampling_; }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] const PixelRect& window() const { return window_; }
  [[nodiscard]] PixelRect rect(int column, int row) const {
    const int x = window_.x0 + column * kTile;
    const int y = window_.y0 + row * kTile;
    return intersect({x, y, x + kTile, y + kTile}, window_);
  }
  /// Calls visit(surfel, pixels) for every surfel of a tile, with those of the given pixels of the tile that it may
  /// touch.
  template <typename Visit>
  void for_each_surfel(int column, int row, const PixelRect& pixels, const Visit& visit) const {
    for (const uint32_t i : tiles_[static_cast<size_t>(row) * columns_ + column]) {
      visit(surfels_[i], intersect(bounds_[i], pixels));
    }
  }

 private:
  void add(const surfel::SurfelCloud& cloud, size_t i, const picture::PictureRequest& request,
           const KernelParameters& kernel) {
    const glm::dvec3 o = frame_.to_camera(cloud.positions[i]);
    const glm::dvec3 n = frame_.rotate(glm::dvec3(cloud.normals[i]));
    const bool scatter = cloud.is_scatter(i);
    if (cloud.oriented && !scatter && glm::dot(n, o) > 0) return;
    const glm::dvec3 drawn_n = scatter ? -glm::normalize(o) : n;
    const auto splat = Splat::make(o, drawn_n, cloud.radii[i], frame_.eta, sampling_.prefilter, kernel);
    if (!splat) return;
    const PixelRect bounds = intersect(grown(pixel_bounds(*splat, frame_), sampling_.reach), window_);
    if (is_empty(bounds)) return;
    const glm::dvec3 facing = glm::dot(n, o) > 0 ? -n : n;
    const glm::dvec3 color = cloud.colors ? linear_color(*cloud.colors, i) : glm::dvec3(kAlbedo);
    const bool per_surfel = request.normalization == picture::Normalization::kSurfel;
    const double minified = 1 - splat->gain(o / o.z, sampling_.whole_prefilter);
    const double area = scatter ? 1 + (kernel.scatter_minified - 1) * std::pow(minified, kernel.scatter_power) : 1;
    surfels_.push_back({*splat, color, facing,
                        area * (per_surfel ? surfel::per_surfel_scale(kernel.sigma) * cloud.weights[i]
                                           : surfel::even_sampling_weight(kernel.sigma))});
    bounds_.push_back(bounds);
    bin(static_cast<uint32_t>(surfels_.size() - 1), bounds);
  }

  void bin(uint32_t surfel, const PixelRect& bounds) {
    const auto row_of = [this](int y) { return (y - window_.y0) / kTile; };
    const auto column_of = [this](int x) { return (x - window_.x0) / kTile; };
    for (int row = row_of(bounds.y0); row <= row_of(bounds.y1 - 1); ++row) {
      for (int column = column_of(bounds.x0); column <= column_of(bounds.x1 - 1); ++column) {
        tiles_[static_cast<size_t>(row) * columns_ + column].push_back(surfel);
      }
    }
  }

  const geometry::CameraFrame& frame_;
  Sampling sampling_;
  PixelRect window_;
  int columns_;
  int rows_;
  bool lit_ = false;
  std::vector<DrawnSurfel> surfels_;
  std::vector<PixelRect> bounds_;
  std::vector<std::vector<uint32_t>> tiles_;
};

/// A picture, and the inverse depths of its front surfaces.
struct Drawing : ReferencePicture {
  std::vector<double> fronts;
};

/// State of one pixel during drawing: the sums of the current layer, and the light of the layers in front of it.
struct PixelState {
  double limit = 0;  ///< depth of the previous layer; nearer fragments are not drawn again
  double surface = kInfinity;
  double weight = 0;
  glm::dvec3 color{0};
  glm::dvec3 normal{0};
  glm::dvec3 light{0};
  double transmittance = 1;
  double front_weight = 0;
  double front = kInfinity;  ///< depth of the first surface
  bool done = false;
  bool left_out = false;  ///< not drawn, because it is not in the mask
};

/// Visibility and accumulation over one tile, for up to kMaxLayers surfaces behind one another. Where a surface covers
/// part of a pixel, the surfaces behind it are visible.
class TilePass {
 public:
  TilePass(const TiledScene& scene, const geometry::CameraFrame& frame, const KernelParameters& kernel,
           const glm::dvec2& sample, int column, int row)
      : scene_(scene), kernel_(kernel), column_(column), row_(row), rect_(scene.rect(column, row)) {
    for (int y = rect_.y0; y < rect_.y1; ++y) {
      for (int x = rect_.x0; x < rect_.x1; ++x) rays_[index(x, y)] = frame.ray(glm::dvec2(x + 0.5, y + 0.5) + sample);
    }
  }

  /// Restricts drawing to the pixels marked in `mask`, which has the rows of the window.
  void leave_out_unless(const std::vector<bool>& mask) {
    for_each_pixel(rect_, [&](PixelState& p, const glm::dvec3&, size_t place) { p.left_out = p.done = !mask[place]; });
  }

  void draw() {
    for (int layer = 0; layer < kMaxLayers; ++layer) {
      const PixelRect open = bounds_of_open();
      if (is_empty(open)) return;
      scene_.for_each_surfel(column_, row_, open, [&](const DrawnSurfel& s, const PixelRect& r) { see(s, r); });
      scene_.for_each_surfel(column_, row_, open, [&](const DrawnSurfel& s, const PixelRect& r) { accumulate(s, r); });
      for_each_pixel(open, [&](PixelState& p, const glm::dvec3& d, size_t) { composite(p, d, layer == 0); });
    }
  }
  void resolve(const picture::PictureRequest& request, Drawing& out) {
    const glm::dvec3 background = linear_from_srgb8(glm::dvec3(request.background));
    for_each_pixel(rect_, [&](const PixelState& p, const glm::dvec3&, size_t place) {
      if (p.left_out) return;
      out.fronts[place] = 1 / p.front;
      out.weights[place] = p.front_weight;
      out.coverage[place] = 1 - p.transmittance;
      out.picture.pixels[place] = p.light + p.transmittance * background;
    });
  }
  [[nodiscard]] uint64_t fragments() const { return fragments_; }

 private:
  [[nodiscard]] size_t index(int x, int y) const { return static_cast<size_t>(y - rect_.y0) * kTile + (x - rect_.x0); }

  template <typename Visit>
  void for_each_pixel(const PixelRect& rect, const Visit& visit) {
    for (int y = rect.y0; y < rect.y1; ++y) {
      for (int x = rect.x0; x < rect.x1; ++x) {
        const PixelRect& window = scene_.window();
        const size_t place = static_cast<size_t>(y - window.y0) * (window.x1 - window.x0) + (x - window.x0);
        visit(pixels_[index(x, y)], rays_[index(x, y)], place);
      }
    }
  }

  /// Bounds of the pixels that are not finished.
  [[nodiscard]] PixelRect bounds_of_open() const {
    PixelRect bounds{rect_.x1, rect_.y1, rect_.x0, rect_.y0};
    for (int y = rect_.y0; y < rect_.y1; ++y) {
      for (int x = rect_.x0; x < rect_.x1; ++x) {
        if (pixels_[index(x, y)].done) continue;
        bounds = {std::min(bounds.x0, x), std::min(bounds.y0, y), std::max(bounds.x1, x + 1),
                  std::max(bounds.y1, y + 1)};
      }
    }
    return bounds;
  }

  void see(const DrawnSurfel& surfel, const PixelRect& rect) {
    for_each_pixel(rect, [&](PixelState& p, const glm::dvec3& d, size_t) {
      if (p.done || !surfel.splat.opaque(d)) return;
      const Splat::DiscDepth depth = surfel.splat.disc_depth(d);
      if (depth.unpushed > p.limit) p.surface = std::min(p.surface, depth.pushed);
    });
  }

  void accumulate(const DrawnSurfel& surfel, const PixelRect& rect) {
    for_each_pixel(rect, [&](PixelState& p, const glm::dvec3& d, size_t) {
      if (p.done) return;
      const Fragment f = surfel.splat.fragment(d);
      if (surfel.splat.cut(f.r2)) return;
      ++fragments_;
      const double depth = surfel.splat.fragment_depth(d);
      if (depth > p.surface || depth <= p.limit) return;
      const double saturated = saturation(coverage_gain(surfel.splat, f, d), kernel_);
      const double w = surfel.multiplier / saturated * f.gain * surfel.splat.kernel(f.r2);
      p.weight += w;
      p.color += w * surfel.color;
      p.normal += w * surfel.normal;
    });
  }

  /// The gain that determines the coverage of a fragment.
  [[nodiscard]] double coverage_gain(const Splat& splat, const Fragment& f, const glm::dvec3& d) const {
    const Sampling& sampling = scene_.sampling();
    if (sampling.prefilter == sampling.whole_prefilter) return f.gain;
    return glm::mix(f.gain, splat.gain(d, sampling.whole_prefilter), kernel_.silhouette_coverage);
  }

  /// Composites the layer behind those in front of it, and resets the sums for the next layer.
  void composite(PixelState& p, const glm::dvec3& d, bool front) const {
    if (p.done) return;
    if (front) {
      p.front_weight = p.weight;
      p.front = p.surface;
    }
    const double coverage = std::min(1.0, p.weight);
    const double shade = scene_.lit() ? headlight(p.normal, d) : 1;
    if (p.weight > 0) p.light += p.transmittance * coverage * shade / p.weight * p.color;
    p.transmittance *= 1 - coverage;
    p.done = !std::isfinite(p.surface) || p.transmittance <= kOpaque;
    p.limit = p.surface;
    p.surface = kInfinity;
    p.weight = 0;
    p.color = p.normal = glm::dvec3(0);
  }

  const TiledScene& scene_;
  const KernelParameters& kernel_;
  int column_;
  int row_;
  PixelRect rect_;
  uint64_t fragments_ = 0;
  std::array<PixelState, kTile * kTile> pixels_{};
  std::array<glm::dvec3, kTile * kTile> rays_{};  ///< of the pixels' samples
};

/// Draws the pixels of the scene's window that are marked in `mask`, or all pixels if it is null. `sample` is the
/// offset of the sample from the centre of a pixel.
void draw_tiles(const TiledScene& scene, const geometry::CameraFrame& frame, const KernelParameters& kernel,
                const picture::PictureRequest& request, const glm::dvec2& sample, const std::vector<bool>* mask,
                Drawing& out) {
  std::atomic<uint64_t> fragments = 0;
  tbb::parallel_for(tbb::blocked_range2d<int>(0, scene.rows(), 0, scene.columns()), [&](const auto& range) {
    for (int row = range.rows().begin(); row < range.rows().end(); ++row) {
      for (int column = range.cols().begin(); column < range.cols().end(); ++column) {
        TilePass pass(scene, frame, kernel, sample, column, row);
        if (mask != nullptr) pass.leave_out_unless(*mask);
        pass.draw();
        pass.resolve(request, out);
        fragments += pass.fragments();
      }
    }
  });
  out.fragments += fragments;
}

/// Adds the marked pixels of a sample, multiplied by `share`.
void add_marked(const Drawing& sample, const std::vector<bool>& mask, double share, Drawing& sum) {
  for (size_t i = 0; i < mask.size(); ++i) {
    if (!mask[i]) continue;
    sum.picture.pixels[i] += share * sample.picture.pixels[i];
    sum.coverage[i] += share * sample.coverage[i];
    sum.weights[i] += share * sample.weights[i];
  }
}

/// Draws the marked pixels again, as the mean of several samples.
void supersample(const surfel::SurfelCloud& cloud, const picture::PictureRequest& request,
                 const KernelParameters& kernel, const geometry::CameraFrame& frame, const PixelRect& rect,
                 const std::vector<bool>& mask, Drawing& out) {
  const double narrowed = std::sqrt(1 - kernel.silhouette_variance);
  KernelParameters narrow = kernel;
  narrow.visibility_pixels *= narrowed;
  const TiledScene scene(cloud, request, frame, narrow, rect, {1, narrowed, 1});
  Drawing sample = out;
  for (size_t i = 0; i < mask.size(); ++i) {
    if (!mask[i]) continue;
    out.picture.pixels[i] = glm::dvec3(0);
    out.coverage[i] = out.weights[i] = 0;
  }
  const auto places = silhouette_samples(kernel);
  for (const glm::dvec2& place : places) {
    sample.fragments = 0;
    draw_tiles(scene, frame, narrow, request, place, &mask, sample);
    add_marked(sample, mask, 1.0 / places.size(), out);
    out.fragments += sample.fragments;
  }
}

Drawing draw(const surfel::SurfelCloud& cloud, const picture::PictureRequest& request, const KernelParameters& kernel,
             const geometry::CameraFrame& frame, const PixelRect& rect) {
  const int width = rect.x1 - rect.x0;
  const int height = rect.y1 - rect.y0;
  const size_t pixels = static_cast<size_t>(width) * height;
  Drawing out{{{width, height}, std::vector<double>(pixels), std::vector<double>(pixels), 0},
              std::vector<double>(pixels)};
  const double prefilter = request.filter == picture::Filter::kEwa ? 1.0 : kNoPrefilter;
  const TiledScene scene(cloud, request, frame, kernel, rect, {prefilter, prefilter, 0});
  draw_tiles(scene, frame, kernel, request, glm::dvec2(0), nullptr, out);
  if (request.silhouettes && request.filter == picture::Filter::kEwa &&
      request.normalization == picture::Normalization::kPixel) {
    supersample(cloud, request, kernel, frame, rect, silhouettes(out.fronts, width, frame.eta, kernel), out);
  }
  return out;
}

/// The part `to` of a drawing of the part `from`.
ReferencePicture cut_out(const Drawing& drawn, const PixelRect& from, const PixelRect& to) {
  ReferencePicture out{{to.x1 - to.x0, to.y1 - to.y0}, {}, {}, drawn.fragments};
  out.picture.pixels.clear();
  for (int y = to.y0; y < to.y1; ++y) {
    for (int x = to.x0; x < to.x1; ++x) {
      const size_t place = drawn.picture.index(x - from.x0, y - from.y0);
      out.picture.pixels.push_back(drawn.picture.pixels[place]);
      out.weights.push_back(drawn.weights[place]);
      out.coverage.push_back(drawn.coverage[place]);
    }
  }
  return out;
}

}  // namespace

double saturation(double gain, const KernelParameters& kernel) {
  return kernel.coverage_minified * std::pow(kernel.coverage_magnified / kernel.coverage_minified, gain);
}

ReferencePicture render(const surfel::SurfelCloud& cloud, const picture::PictureRequest& request,
                        const KernelParameters& kernel, const std::optional<Window>& window) {
  SURFCAST_EXPECTS(request.camera.has_value());
  const auto frame = geometry::make_camera_frame(*request.camera, request.width, request.height);
  SURFCAST_EXPECTS(frame.has_value());
  const PixelRect picture{0, 0, request.width, request.height};
  const Window part = window.value_or(Window{0, 0, request.width, request.height});
  const PixelRect rect{part.x, part.y, part.x + part.width, part.y + part.height};
  // The detection of silhouettes needs the neighbouring pixels.
  const int margin = kernel.silhouette_reach + 1;
  const PixelRect drawn = intersect({rect.x0 - margin, rect.y0 - margin, rect.x1 + margin, rect.y1 + margin}, picture);
  return cut_out(draw(cloud, request, kernel, *frame, drawn), drawn, rect);
}

}  // namespace surfcast::reference
