#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <optional>

#include "reference/headlight.h"
#include "reference/volume_ray_caster.h"

namespace surfcast::reference {
namespace {

constexpr int kSearchSteps = 64;  ///< of a segment in which a crossing is looked for

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
  for (int row = 0; row < 16; ++row) {
    const int y = row % 4;
    const int z = row / 4;
    double value = 0;
    double slope = 0;
    for (int x = 0; x < 4; ++x) {
      const double sample = grid.at(glm::ivec3(base) + glm::ivec3(x, y, z) - 1);
      value += w[0].value[x] * sample;
      slope += w[0].slope[x] * sample;
    }
    const double weight = w[1].value[y] * w[2].value[z];
    result.value += weight * value;
    result.gradient +=
        glm::dvec3(weight * slope, w[1].slope[y] * w[2].value[z] * value, w[1].value[y] * w[2].slope[z] * value);
  }
  return result;
}

/// A place on a ray.
struct Place {
  double t = 0;  ///< distance from the eye
  double scalar = 0;
  double slope = 0;        ///< along the ray, per world unit
  glm::dvec3 gradient{0};  ///< world axes
};

/// The scalar between two places, x from 0 to 1.
double scalar_between(const Place& a, const Place& b, double x) {
  const double span = b.t - a.t;
  const double x2 = x * x;
  const double x3 = x2 * x;
  return (2 * x3 - 3 * x2 + 1) * a.scalar + (x3 - 2 * x2 + x) * span * a.slope + (3 * x2 - 2 * x3) * b.scalar +
         (x3 - x2) * span * b.slope;
}

/// Where the scalar leaves the side of a value on which it begins; none if it stays.
std::optional<double> leaves_side(const Place& a, const Place& b, double value, bool above) {
  const auto stays = [&](double x) { return (scalar_between(a, b, x) >= value) == above; };
  for (int i = 1; i <= kSearchSteps; ++i) {
    if (stays(static_cast<double>(i) / kSearchSteps)) continue;
    double low = static_cast<double>(i - 1) / kSearchSteps;
    double high = static_cast<double>(i) / kSearchSteps;
    for (int halving = 0; halving < 50; ++halving) {
      const double middle = 0.5 * (low + high);
      (stays(middle) ? low : high) = middle;
    }
    return a.t + high * (b.t - a.t);
  }
  return std::nullopt;
}

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
    std::vector<SurfaceLayer> layers =
        parameters_.layers ? parameters_.layers(direction_) : std::vector<SurfaceLayer>();
    add_slices(whole, layers);
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
  void add_slices(const RayInterval& whole, std::vector<SurfaceLayer>& layers) const {
    for (const SlicePlane& slice : parameters_.slices) {
      const double t = glm::dot(slice.normal, slice.point - eye_) / glm::dot(slice.normal, direction_);
      if (!(t > whole.begin && t < whole.end) || !shown(t)) continue;
      layers.push_back({t, transfer_.at(place_at(t).scalar).color, slice.opacity});
    }
    std::ranges::sort(layers, {}, &SurfaceLayer::distance);
  }
  void add_stretch(double begin, double end) {
    Place last = place_at(begin);
    Place from = last;  // for the search of crossings
    std::vector<bool> above;
    for (const ValueSurface& iso : parameters_.isos) above.push_back(last.scalar >= iso.value);
    while (last.t < end && ray_.transmittance > parameters_.clear) {
      const double number = std::floor((last.t - anchor_) / step_ + 1e-9) + 1;
      Place next = place_at(std::min(anchor_ + number * step_, end));
      const std::optional<size_t> iso = move_to_crossing(from, next, above);
      add_segment(last, next);
      if (iso) add_iso(parameters_.isos[*iso], next);
      from = last = next;
      if (iso) from.scalar = parameters_.isos[*iso].value;  // but for the error of the cubic
    }
  }
  /// Moves the end of a segment to the first iso-surface that it crosses, and tells which.
  std::optional<size_t> move_to_crossing(const Place& last, Place& next, std::vector<bool>& above) const {
    std::optional<size_t> first;
    double nearest = 0;
    for (size_t i = 0; i < above.size(); ++i) {
      const std::optional<double> t = leaves_side(last, next, parameters_.isos[i].value, above[i]);
      if (!t || (first && *t >= nearest)) continue;
      first = i;
      nearest = *t;
    }
    if (!first) return first;
    above[*first] = !above[*first];
    next = place_at(nearest);
    return first;
  }
  void add_iso(const ValueSurface& iso, const Place& place) {
    ray_.add_surface(headlight(place.gradient, direction_) * iso.color, iso.opacity);
  }
  void add_segment(const Place& a, const Place& b) {
    if (!parameters_.medium) return;
    const double span = b.t - a.t;
    double before = a.scalar;
    for (int i = 1; i <= parameters_.parts; ++i) {
      const double x = static_cast<double>(i) / parameters_.parts;
      const double after = scalar_between(a, b, x);
      const Classified seen = transfer_.mean(before, after);
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
