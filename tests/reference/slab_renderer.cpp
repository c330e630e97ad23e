#include "reference/slab_renderer.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>
#include <mutex>
#include <numbers>

#include <tbb/parallel_for.h>

#include "reference/affine_kernel.h"
#include "reference/headlight.h"
#include "reference/ray_kernel.h"

namespace surfcast::reference {
namespace {

constexpr int kBand = 4;            ///< rows of pixels that are drawn together
constexpr int kNeighbourhood = 2;   ///< spacings over which a kernel and the slabs that it is in reach
constexpr double kMinWeight = 0.5;  ///< of a slab at which its scalar is known

/// A kernel of the grid.
struct GridKernel {
  RayKernel shape;
  std::optional<AffineKernel> affine;
  double distance;  ///< of the centre from the eye, world units; negative behind it
  double value;     ///< c - f0
  glm::dvec3 gradient;
  int first_row;  ///< rows of pixels that it may touch
  int last_row;
  int first_column;
  int last_column;
};

/// Spheres about the eye. The scalar is known at their radii and linear between them.
struct Slabs {
  double thickness = 0;  ///< world units
  double first = 0;      ///< distance of the first from the eye, world units; at most 0
  int count = 0;

  [[nodiscard]] double place(double distance) const { return (distance - first) / thickness; }
  [[nodiscard]] double distance(double place) const { return first + place * thickness; }
};

bool within(const glm::dvec3& p, const glm::dvec3& low, const glm::dvec3& high) {
  return glm::all(glm::greaterThanEqual(p, low)) && glm::all(glm::lessThanEqual(p, high));
}

double farthest_corner(const VolumeGrid& grid, const glm::dvec3& eye) {
  double farthest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::bvec3 high{(corner & 1) != 0, (corner & 2) != 0, (corner & 4) != 0};
    farthest = std::max(farthest, glm::distance(eye, grid.place(glm::mix(grid.low, grid.high, high))));
  }
  return farthest;
}

Slabs slabs_of(const VolumeGrid& grid, const glm::dvec3& eye, const SlabParameters& parameters) {
  const glm::dvec3 to_centre = grid.centre() - eye;
  const double distance = glm::length(to_centre);
  const glm::dvec3 along = distance > 0 ? to_centre / distance : glm::dvec3(0, 0, 1);
  const bool inside = within(glm::inverse(grid.axes) * (eye - grid.origin), grid.low, grid.high);
  Slabs slabs;
  slabs.thickness = parameters.thickness * grid.spacing_along(along);
  const bool anchored = parameters.anchored && !inside;
  slabs.first = (anchored ? std::fmod(distance, slabs.thickness) : 0) - slabs.thickness;
  slabs.count = static_cast<int>(std::ceil(slabs.place(farthest_corner(grid, eye)))) + 2;
  return slabs;
}

/// The sums of one pixel: of the scalar, of the kernels' weights, which are about 1, and, if shaded, of the gradient.
struct SlabSum {
  double value = 0;
  double weight = 0;
  glm::dvec3 gradient{0};
};

class SlabPass {
 public:
  SlabPass(const VolumeGrid& samples, double outside, const TransferFunction& transfer,
           const geometry::CameraFrame& frame, const SlabParameters& parameters)
      : samples_(samples),
        outside_(outside),
        transfer_(transfer),
        frame_(frame),
        parameters_(parameters),
        slabs_(slabs_of(samples, frame.eye, parameters)),
        coefficients_(corrected(samples, parameters.sigma, parameters.corrections)),
        factor_(parameters.sigma * glm::dmat3(frame.rotate(samples.axes[0]), frame.rotate(samples.axes[1]),
                                              frame.rotate(samples.axes[2]))) {
    if (parameters.shaded) gradients_ = sample_gradients(samples);
    add_kernels();
  }

  LightPicture draw(const SurfaceLayers& layers, const std::optional<ClipBox>& clip) {
    LightPicture picture(frame_.width, frame_.height);
    tbb::parallel_for(0, (frame_.height + kBand - 1) / kBand, [&](int band) {
      const int first = band * kBand;
      const int last = std::min(first + kBand, frame_.height) - 1;
      const std::vector<SlabSum> sums = accumulate(first, last);
      for (int y = first; y <= last; ++y) {
        for (int x = 0; x < frame_.width; ++x) {
          const size_t place = (static_cast<size_t>(y - first) * frame_.width + x) * slabs_.count;
          picture.pixels[picture.index(x, y)] = integrate(&sums[place], {x + 0.5, y + 0.5}, layers, clip);
        }
      }
    });
    return picture;
  }

  [[nodiscard]] uint64_t kernels() const { return kernels_.size(); }
  [[nodiscard]] uint64_t fragments() const { return fragments_; }
  [[nodiscard]] double largest_sum() const { return largest_; }

 private:
  /// The samples at the faces are repeated as far as kernels and tents of slabs reach into the volume.
  void add_kernels() {
    const int margin =
        static_cast<int>(std::ceil(std::sqrt(parameters_.cutoff) * parameters_.sigma + parameters_.thickness));
    for (int z = -margin; z < samples_.size.z + margin; ++z) {
      for (int y = -margin; y < samples_.size.y + margin; ++y) {
        for (int x = -margin; x < samples_.size.x + margin; ++x) add_kernel({x, y, z});
      }
    }
  }

  void add_kernel(const glm::ivec3& i) {
    const double value = coefficients_.at(i) - outside_;
    if (parameters_.leave_out && !can_show(i)) return;
    const glm::dvec3 centre = frame_.to_camera(samples_.place(glm::dvec3(i)));
    const RayKernel shape(centre, factor_, frame_.eta, parameters_.prefilter);
    if (shape.behind(parameters_.cutoff)) return;
    const double distance = std::copysign(glm::length(centre), centre.z);
    GridKernel kernel{shape, {}, distance, value, gradient_at(i), 0, frame_.height - 1, 0, frame_.width - 1};
    const auto bounds = shape.bounds(parameters_.cutoff);
    if (parameters_.affine && bounds) {
      kernel.affine = AffineKernel(centre, factor_, frame_.eta, parameters_.prefilter * parameters_.prefilter);
    }
    if (bounds) {
      const auto column = [&](double x) {
        return std::clamp(0.5 * frame_.width + frame_.eta * x, -1.0, frame_.width + 1.0);
      };
      const auto row = [&](double y) {
        return std::clamp(0.5 * frame_.height - frame_.eta * y, -1.0, frame_.height + 1.0);
      };
      kernel.first_column = std::max(0, static_cast<int>(std::floor(column(bounds->min.x))));
      kernel.last_column = std::min(frame_.width - 1, static_cast<int>(std::floor(column(bounds->max.x))));
      kernel.first_row = std::max(0, static_cast<int>(std::floor(row(bounds->max.y))));
      kernel.last_row = std::min(frame_.height - 1, static_cast<int>(std::floor(row(bounds->min.y))));
    }
    if (kernel.first_row <= kernel.last_row && kernel.first_column <= kernel.last_column) kernels_.push_back(kernel);
  }

  [[nodiscard]] glm::dvec3 gradient_at(const glm::ivec3& i) const {
    if (gradients_.empty()) return glm::dvec3(0);
    const glm::ivec3 k = glm::clamp(i, glm::ivec3(0), samples_.size - 1);
    return gradients_[(static_cast<size_t>(k.z) * samples_.size.y + k.y) * samples_.size.x + k.x];
  }

  /// Whether the transfer function shows anything between the samples about a kernel.
  ///
  /// Without the weights f0 is among them: where some kernels are left out and others are not, sums lie between the
  /// scalar and f0.
  [[nodiscard]] bool can_show(const glm::ivec3& i) const {
    double low = parameters_.normalized ? samples_.at(i) : outside_;
    double high = low;
    for (int z = -kNeighbourhood; z <= kNeighbourhood; ++z) {
      for (int y = -kNeighbourhood; y <= kNeighbourhood; ++y) {
        for (int x = -kNeighbourhood; x <= kNeighbourhood; ++x) {
          const double value = samples_.at(i + glm::ivec3(x, y, z));
          low = std::min(low, value);
          high = std::max(high, value);
        }
      }
    }
    return transfer_.visible_within(low, high);
  }

  /// The sums of the rows from first to last, slab by slab within a pixel.
  std::vector<SlabSum> accumulate(int first, int last) {
    std::vector<SlabSum> sums(static_cast<size_t>(last - first + 1) * frame_.width * slabs_.count);
    uint64_t fragments = 0;
    for (const GridKernel& kernel : kernels_) {
      for (int y = std::max(first, kernel.first_row); y <= std::min(last, kernel.last_row); ++y) {
        for (int x = kernel.first_column; x <= kernel.last_column; ++x) {
          SlabSum* pixel = &sums[(static_cast<size_t>(y - first) * frame_.width + x) * slabs_.count];
          if (add(kernel, frame_.ray({x + 0.5, y + 0.5}), pixel)) ++fragments;
        }
      }
    }
    note(fragments, sums);
    if (parameters_.normalized) normalize(sums);
    return sums;
  }

  /// Adds a fragment to the two nearest slabs, with shares that are linear in its distance from the eye.
  bool add(const GridKernel& kernel, const glm::dvec3& d, SlabSum* pixel) const {
    const KernelOnRay seen = fragment(kernel, d);
    if (!(seen.r2 <= parameters_.cutoff)) return false;
    const double place = slabs_.place(parameters_.by_centre ? kernel.distance : seen.depth * glm::length(d));
    const double slab = std::floor(place);
    const double t = peak() * seen.length / slabs_.thickness;
    for (int i = 0; i < 2; ++i) {
      const int at = static_cast<int>(slab) + i;
      if (at < 0 || at >= slabs_.count) continue;
      const double share = i == 0 ? slab + 1 - place : place - slab;
      pixel[at].value += rounded(share * t * kernel.value);
      pixel[at].weight += rounded(share * t);
      pixel[at].gradient += share * t * kernel.gradient;
    }
    return true;
  }

  static KernelOnRay fragment(const GridKernel& kernel, const glm::dvec3& d) {
    KernelOnRay seen = kernel.shape.on_ray(d);
    if (!kernel.affine) return seen;
    seen.r2 = kernel.affine->r2(d);
    seen.length = kernel.affine->length(d);
    return seen;
  }
  [[nodiscard]] double rounded(double value) const {
    return parameters_.unit > 0 ? parameters_.unit * std::round(value / parameters_.unit) : value;
  }

  /// The kernels' peak: they are a partition of unity, also with what the cutoff takes from every line integral.
  [[nodiscard]] double peak() const {
    const double sigma2 = parameters_.sigma * parameters_.sigma;
    return std::pow(2 * std::numbers::pi * sigma2, -1.5) / (1 - std::exp(-0.5 * parameters_.cutoff));
  }

  /// The kernels' places along a ray are points, and the tents of slabs over them no partition of unity: across the
  /// planes of the lattice that the ray meets head-on, sums ripple by up to a seventh. So do the weights.
  static void normalize(std::vector<SlabSum>& sums) {
    for (SlabSum& sum : sums) {
      if (sum.weight >= kMinWeight) sum.value /= sum.weight;
    }
  }
  /// Whether the scalar is known on both sides. Where it is not, kernels are left out because they cannot show.
  [[nodiscard]] bool known(const SlabSum& a, const SlabSum& b) const {
    return !parameters_.normalized || std::min(a.weight, b.weight) >= kMinWeight;
  }

  void note(uint64_t fragments, const std::vector<SlabSum>& sums) {
    const std::lock_guard lock(mutex_);
    fragments_ += fragments;
    for (const SlabSum& sum : sums) largest_ = std::max(largest_, std::abs(sum.value));
  }

  glm::dvec4 integrate(const SlabSum* sums, const glm::dvec2& pixel, const SurfaceLayers& layers,
                       const std::optional<ClipBox>& clip) const {
    const glm::dvec3 direction = ray_direction(frame_, pixel);
    const RayInterval part = visible_interval(samples_, clip, frame_.eye, direction);
    RayLight ray;
    double from = part.begin;
    if (layers) {
      for (const SurfaceLayer& layer : layers(direction)) {
        add_stretch(sums, direction, {from, std::min(part.end, layer.distance)}, ray);
        ray.add_surface(layer.color, layer.coverage);
        from = std::max(from, layer.distance);
      }
    }
    add_stretch(sums, direction, {from, part.end}, ray);
    return ray.premultiplied();
  }

  /// Adds a part of the ray, from slab centre to slab centre.
  void add_stretch(const SlabSum* sums, const glm::dvec3& direction, const RayInterval& part, RayLight& ray) const {
    if (!(part.end > part.begin)) return;
    const double last = std::min(slabs_.place(part.end), slabs_.count - 1.0);
    double place = std::max(0.0, slabs_.place(part.begin));
    while (place < last && ray.transmittance > parameters_.clear) {
      const double slab = std::floor(place);
      const double next = std::min(last, slab + 1);
      add_between(sums[static_cast<int>(slab)], sums[static_cast<int>(slab) + 1], {place - slab, next - slab},
                  direction, ray);
      place = next;
    }
  }

  /// Integrates the transfer function over the linear scalar between two slab centres, from and to in slabs behind the
  /// first of them.
  void add_between(const SlabSum& a, const SlabSum& b, const RayInterval& part, const glm::dvec3& direction,
                   RayLight& ray) const {
    if (!known(a, b)) return;
    const int steps = std::max(1, parameters_.steps);
    const double width = (part.end - part.begin) / steps;
    for (int i = 0; i < steps; ++i) {
      const double at = parameters_.steps == 0 ? 0 : part.begin + (i + 0.5) * width;
      const Classified seen = transfer_.at(outside_ + std::lerp(a.value, b.value, at));
      if (seen.extinction == 0) continue;
      const double shade = parameters_.shaded ? headlight(glm::mix(a.gradient, b.gradient, at), direction) : 1;
      ray.add(shade * seen.color, seen.extinction, width * slabs_.thickness);
    }
  }

  const VolumeGrid& samples_;
  double outside_;
  const TransferFunction& transfer_;
  const geometry::CameraFrame& frame_;
  SlabParameters parameters_;
  Slabs slabs_;
  VolumeGrid coefficients_;
  glm::dmat3 factor_;
  std::vector<glm::dvec3> gradients_;
  std::vector<GridKernel> kernels_;
  std::mutex mutex_;
  uint64_t fragments_ = 0;
  double largest_ = 0;
};

/// The same camera with a border about the picture, from which the filter takes what lies outside.
geometry::CameraFrame widened(geometry::CameraFrame frame, int pixels) {
  frame.width += 2 * pixels;
  frame.height += 2 * pixels;
  return frame;
}

}  // namespace

SlabDrawing draw_slabs(const VolumeGrid& samples, double outside, const TransferFunction& transfer,
                       const geometry::CameraFrame& frame, const SlabParameters& parameters,
                       const SurfaceLayers& layers, const std::optional<ClipBox>& clip) {
  const geometry::CameraFrame drawn = parameters.filter ? widened(frame, kFilterReach) : frame;
  SlabPass pass(samples, outside, transfer, drawn, parameters);
  LightPicture picture = pass.draw(layers, clip);
  if (parameters.filter) picture = inner_part(filtered(picture), kFilterReach);
  return {std::move(picture), pass.kernels(), pass.fragments(), pass.largest_sum()};
}

}  // namespace surfcast::reference
