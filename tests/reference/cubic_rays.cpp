#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "reference/headlight.h"
#include "reference/volume_ray_caster.h"

namespace surfcast::reference {
namespace {

constexpr int kIntegrationSteps = 48;  ///< of the transfer function over a range of scalars

/// The scalar at a place and its derivatives along i, j and k.
struct Reconstructed {
  double value = 0;
  glm::dvec3 gradient{0};
};

struct AxisWeights {
  std::array<double, 4> value;
  std::array<double, 4> slope;
};

AxisWeights weights_at(double x) {
  const double x2 = x * x;
  const double x3 = x2 * x;
  return {{0.5 * (-x3 + 2 * x2 - x), 0.5 * (3 * x3 - 5 * x2 + 2), 0.5 * (-3 * x3 + 4 * x2 + x), 0.5 * (x3 - x2)},
          {0.5 * (-3 * x2 + 4 * x - 1), 0.5 * (9 * x2 - 10 * x), 0.5 * (-9 * x2 + 8 * x + 1), 0.5 * (3 * x2 - 2 * x)}};
}

Reconstructed reconstruct(const VolumeGrid& grid, const glm::dvec3& index) {
  const glm::dvec3 base = glm::floor(index);
  const std::array<AxisWeights, 3> w{weights_at(index.x - base.x), weights_at(index.y - base.y),
                                     weights_at(index.z - base.z)};
  Reconstructed result;
  for (int n = 0; n < 64; ++n) {
    const glm::ivec3 t(n % 4, n / 4 % 4, n / 16);
    const double sample = grid.at(glm::ivec3(base) + t - 1);
    result.value += w[0].value[t.x] * w[1].value[t.y] * w[2].value[t.z] * sample;
    result.gradient += sample * glm::dvec3(w[0].slope[t.x] * w[1].value[t.y] * w[2].value[t.z],
                                           w[0].value[t.x] * w[1].slope[t.y] * w[2].value[t.z],
                                           w[0].value[t.x] * w[1].value[t.y] * w[2].slope[t.z]);
  }
  return result;
}

/// The mean over the scalars from a to b.
Classified mean_between(const TransferFunction& transfer, double a, double b) {
  Classified mean;
  for (int i = 0; i < kIntegrationSteps; ++i) {
    const Classified seen = transfer.at(std::lerp(a, b, (i + 0.5) / kIntegrationSteps));
    mean.color += seen.extinction / kIntegrationSteps * seen.color;
    mean.extinction += seen.extinction / kIntegrationSteps;
  }
  if (mean.extinction > 0) mean.color /= mean.extinction;
  return mean;
}

/// A place on a ray.
struct Place {
  double t = 0;  ///< distance from the eye
  double scalar = 0;
  double slope = 0;        ///< along the ray, per world unit
  glm::dvec3 gradient{0};  ///< world axes
};

class CubicRay {
 public:
  CubicRay(const VolumeGrid& grid, const TransferFunction& transfer, const CubicRayParameters& parameters,
           const glm::dvec3& eye, const glm::dvec3& direction)
      : grid_(grid),
        transfer_(transfer),
        parameters_(parameters),
        eye_(eye),
        direction_(direction),
        to_index_(glm::inverse(grid.axes)),
        step_(parameters.step * grid.spacing_along(direction)) {
    const glm::dvec3 index = to_index_ * (eye - grid.origin);
    const bool within = glm::clamp(index, grid.low, grid.high) == index;
    anchor_ = within ? 0 : glm::length(grid.centre() - eye);
  }

  glm::dvec4 light() {
    const RayInterval whole = visible_interval(grid_, {}, eye_, direction_);
    std::vector<double> faces{whole.begin, whole.end};
    for (const auto* boxes : {&parameters_.inside, &parameters_.outside}) {
      for (const ClipBox& box : *boxes) {
        const RayInterval part = visible_interval(grid_, box, eye_, direction_);
        if (part.end > part.begin) faces.insert(faces.end(), {part.begin, part.end});
      }
    }
    const std::vector<SurfaceLayer> layers =
        parameters_.layers ? parameters_.layers(direction_) : std::vector<SurfaceLayer>();
    for (const SurfaceLayer& layer : layers) faces.push_back(layer.distance);
    std::ranges::sort(faces);
    auto layer = layers.begin();
    for (size_t i = 0; i < faces.size() && ray_.transmittance > parameters_.clear; ++i) {
      for (; layer != layers.end() && layer->distance <= faces[i]; ++layer)
        ray_.add_surface(layer->color, layer->coverage);
      if (i + 1 == faces.size()) break;
      const double middle = 0.5 * (faces[i] + faces[i + 1]);
      if (middle > whole.begin && middle < whole.end && shown(middle)) add_stretch(faces[i], faces[i + 1]);
    }
    return ray_.premultiplied();
  }

 private:
  [[nodiscard]] bool shown(double t) const {
    const glm::dvec3 place = eye_ + t * direction_;
    const auto holds = [&](const ClipBox& box) { return glm::clamp(place, box.low, box.high) == place; };
    return (parameters_.inside.empty() || std::ranges::any_of(parameters_.inside, holds)) &&
           std::ranges::none_of(parameters_.outside, holds);
  }
  [[nodiscard]] Place place_at(double t) const {
    const Reconstructed found = reconstruct(grid_, to_index_ * (eye_ + t * direction_ - grid_.origin));
    const glm::dvec3 gradient = glm::transpose(to_index_) * found.gradient;
    return {t, found.value, glm::dot(gradient, direction_), gradient};
  }
  void add_stretch(double begin, double end) {
    Place last = place_at(begin);
    auto number = static_cast<long>(std::floor((begin - anchor_) / step_ + 1e-9)) + 1;
    while (last.t < end && ray_.transmittance > parameters_.clear) {
      const Place next = place_at(std::min(anchor_ + static_cast<double>(number++) * step_, end));
      add_segment(last, next);
      last = next;
    }
  }
  void add_segment(const Place& a, const Place& b) {
    const double span = b.t - a.t;
    double before = a.scalar;
    for (int i = 1; i <= parameters_.parts; ++i) {
      const double x = static_cast<double>(i) / parameters_.parts;
      const double x2 = x * x;
      const double x3 = x2 * x;
      const double after = (2 * x3 - 3 * x2 + 1) * a.scalar + (x3 - 2 * x2 + x) * span * a.slope +
                           (3 * x2 - 2 * x3) * b.scalar + (x3 - x2) * span * b.slope;
      const Classified seen = mean_between(transfer_, before, after);
      const double middle = x - 0.5 / parameters_.parts;
      const double shade = parameters_.shaded ? headlight(glm::mix(a.gradient, b.gradient, middle), direction_) : 1;
      ray_.add(shade * seen.color, seen.extinction, span / parameters_.parts);
      before = after;
    }
  }

  const VolumeGrid& grid_;
  const TransferFunction& transfer_;
  const CubicRayParameters& parameters_;
  glm::dvec3 eye_;
  glm::dvec3 direction_;
  glm::dmat3 to_index_;
  double step_;
  double anchor_ = 0;
  RayLight ray_;
};

}  // namespace

LightPicture cast_cubic_rays(const VolumeGrid& grid, const TransferFunction& transfer,
                             const geometry::CameraFrame& frame, const CubicRayParameters& parameters) {
  const auto light = [&](const glm::dvec2& pixel) {
    return CubicRay(grid, transfer, parameters, frame.eye, ray_direction(frame, pixel)).light();
  };
  return parameters.filter ? prefiltered_picture(frame.width, frame.height, 1, light)
                           : sampled_picture(frame.width, frame.height, light);
}

}  // namespace surfcast::reference
