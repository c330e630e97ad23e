#include "kinds/grid_block.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <utility>

#include "base/catmull_rom.h"
#include "volume/packing.h"

namespace surfcast::kinds {
namespace {

constexpr int kParts = 4;          ///< of a stretch between two samples of the field
constexpr double kStretch = 0.02;  ///< opacity of a stretch that becomes one hit
constexpr int kHalvings = 40;      ///< in the search of a crossing

/// Derivatives of catmull_rom_weights.
std::array<double, 4> cubic_slope(double x) {
  return {((4 - 3 * x) * x - 1) / 2, (9 * x - 10) * x / 2, ((8 - 9 * x) * x + 1) / 2, (3 * x - 2) * x / 2};
}

}  // namespace

GridBlock::GridBlock(volume::Brick brick, const model::Volume& volume)
    : brick_(std::move(brick)),
      size_(volume.size),
      origin_(volume.index_to_world[3]),
      axes_(volume.index_to_world[0], volume.index_to_world[1], volume.index_to_world[2]),
      to_index_(glm::inverse(axes_)),
      box_(volume::brick_box(volume.size, brick_.header.level, brick_.header.brick)) {}

glm::dvec3 GridBlock::stored_index(const glm::dvec3& index) const {
  const glm::dvec3 scale(glm::u32vec3(1) << volume::halvings(size_, brick_.header.level));
  const glm::dvec3 first = glm::dvec3(brick_.header.brick) * double{volume::kBrickSamples};
  return (index + 0.5) / scale - 0.5 - first + double{volume::kHaloBefore};
}

GridBlock::Field GridBlock::field_at(const glm::dvec3& index) const {
  const glm::dvec3 at = stored_index(index);
  const glm::u32vec3 stored = volume::stored_size(brick_.header.count);
  const glm::dvec3 cell = glm::clamp(glm::floor(at), glm::dvec3(1), glm::dvec3(stored) - 3.0);
  const glm::u32vec3 first(cell - 1.0);
  std::array<std::array<double, 4>, 3> weights{};
  std::array<std::array<double, 4>, 3> slopes{};
  for (int axis = 0; axis < 3; ++axis) {
    weights.at(axis) = catmull_rom_weights(at[axis] - cell[axis]);
    slopes.at(axis) = cubic_slope(at[axis] - cell[axis]);
  }
  const auto& [wx, wy, wz] = weights;
  const auto& [sx, sy, sz] = slopes;
  Field field;
  for (size_t n = 0; n < 64; ++n) {
    const size_t i = n % 4;
    const size_t j = n / 4 % 4;
    const size_t k = n / 16;
    const uint16_t code = brick_.codes[((first.z + k) * stored.y + first.y + j) * stored.x + first.x + i];
    field.value += wx.at(i) * wy.at(j) * wz.at(k) * code;
    field.gradient +=
        glm::dvec3(sx.at(i) * wy.at(j) * wz.at(k), wx.at(i) * sy.at(j) * wz.at(k), wx.at(i) * wy.at(j) * sz.at(k)) *
        static_cast<double>(code);
  }
  const glm::dvec3 scale(glm::u32vec3(1) << volume::halvings(size_, brick_.header.level));
  return {brick_.header.offset + brick_.header.scale * field.value, brick_.header.scale * field.gradient / scale};
}

uint32_t GridBlock::nearest_sample(const glm::dvec3& index) const {
  const glm::dvec3 own = glm::round(stored_index(index)) - double{volume::kHaloBefore};
  const glm::u32vec3 count = brick_.header.count;
  const glm::u32vec3 at(glm::clamp(own, glm::dvec3(0), glm::dvec3(count - 1U)));
  return (at.z * count.y + at.y) * count.x + at.x;
}

/// Out of the larger values.
glm::dvec3 GridBlock::normal_of(const Field& field) const {
  const glm::dvec3 gradient = glm::transpose(to_index_) * field.gradient;
  const double length = glm::length(gradient);
  return length > 0 ? -gradient / length : glm::dvec3(0);
}

bool GridBlock::may_show(const VolumeSight& sight) const {
  const double margin = volume::kOvershoot * (brick_.header.high - brick_.header.low);
  return !sight.planes.empty() || sight.shows_within(brick_.header.low - margin, brick_.header.high + margin);
}

/// What the ray of a pixel meets in a brick.
class GridBlock::Ray {
 public:
  struct Met {
    PickHit hit;
    ItemLook look;
  };

  Ray(const GridBlock& block, const VolumeSight& sight, const PickQuery& query)
      : block_(block), sight_(sight), query_(query) {
    const glm::dvec3 ray = query.frame.ray(query.pixel);
    direction_ = query.frame.right * ray.x + query.frame.up * ray.y + query.frame.forward;
    start_ = block.to_index_ * (query.frame.eye - block.origin_);
    index_direction_ = block.to_index_ * direction_;
  }

  std::vector<Met> meet() {
    const glm::dvec2 part = passage();
    const double step = 1 / glm::length(index_direction_);
    if (part.x >= part.y) return {};
    for (Place last = place_at(part.x); last.t < part.y;) {
      const double next = (std::floor(last.t / step + 1e-9) + 1) * step;
      const Place place = place_at(std::min(next, part.y));
      add_segment(last, place);
      last = place;
    }
    flush(part.y);
    for (const VolumeSight::Plane& plane : sight_.planes) add_plane(plane, part);
    return std::move(met_);
  }

 private:
  struct Place {
    double t = 0;  ///< camera z
    double value = 0;
    double slope = 0;
  };

  /// Where the ray enters and leaves the brick, from the eye on.
  [[nodiscard]] glm::dvec2 passage() const {
    glm::dvec2 part(0, std::numeric_limits<double>::max());
    for (int axis = 0; axis < 3; ++axis) {
      const double low = block_.box_.low[axis] - start_[axis];
      const double high = block_.box_.high[axis] - start_[axis];
      if (index_direction_[axis] == 0) {
        if (low > 0 || high < 0) return {0, 0};
        continue;
      }
      const double a = low / index_direction_[axis];
      const double b = high / index_direction_[axis];
      part = {std::max(part.x, std::min(a, b)), std::min(part.y, std::max(a, b))};
    }
    return part;
  }

  [[nodiscard]] glm::dvec3 index_at(double t) const { return start_ + t * index_direction_; }

  [[nodiscard]] bool shown(double t) const { return query_.clip.shows(query_.frame.eye + t * direction_); }

  [[nodiscard]] Place place_at(double t) const {
    const Field field = block_.field_at(index_at(t));
    return {t, field.value, glm::dot(field.gradient, index_direction_)};
  }

  /// The cubic between two places.
  [[nodiscard]] static double value_between(const Place& a, const Place& b, double t) {
    const double span = b.t - a.t;
    const double x = (t - a.t) / span;
    const double rise = b.value - a.value;
    const double third = (a.slope + b.slope) * span - 2 * rise;
    return a.value + x * (a.slope * span + x * (rise - a.slope * span - third + x * third));
  }

  void add_segment(const Place& a, const Place& b) {
    double before = a.value;
    for (int i = 1; i <= kParts; ++i) {
      const double from = std::lerp(a.t, b.t, static_cast<double>(i - 1) / kParts);
      const double to = std::lerp(a.t, b.t, static_cast<double>(i) / kParts);
      const double after = i == kParts ? b.value : value_between(a, b, to);
      for (const VolumeSight::Iso& iso : sight_.isos) {
        if ((before >= iso.value) != (after >= iso.value)) add_iso(iso, crossing(a, b, iso.value, from, to));
      }
      if (shown(0.5 * (from + to))) {
        depth_ += sight_.extinction(0.5 * (before + after)) * (to - from) * glm::length(direction_);
      }
      if (-std::expm1(-depth_) >= kStretch) flush(to);
      before = after;
    }
  }

  [[nodiscard]] static double crossing(const Place& a, const Place& b, double value, double from, double to) {
    const bool above = value_between(a, b, from) >= value;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (from + to);
      ((value_between(a, b, middle) >= value) == above ? from : to) = middle;
    }
    return to;
  }

  void add_iso(const VolumeSight::Iso& iso, double t) {
    if (shown(t)) add(t, iso.opacity, block_.normal_of(block_.field_at(index_at(t))));
  }

  void add_plane(const VolumeSight::Plane& plane, const glm::dvec2& part) {
    const double t = glm::dot(plane.normal, plane.point - query_.frame.eye) / glm::dot(plane.normal, direction_);
    if (t >= part.x && t < part.y && shown(t)) add(t, plane.opacity, glm::normalize(plane.normal));
  }

  /// Makes a hit of what the transfer function has shown since the last one.
  void flush(double t) {
    if (depth_ > 0) add(t, -std::expm1(-depth_), block_.normal_of(block_.field_at(index_at(t))));
    depth_ = 0;
  }

  void add(double t, double opacity, const glm::dvec3& normal) {
    met_.push_back({{block_.nearest_sample(index_at(t)), 0, t, t, opacity}, {glm::vec3(normal), kNoClass}});
  }

  const GridBlock& block_;
  const VolumeSight& sight_;
  const PickQuery& query_;
  glm::dvec3 direction_{0};        ///< world, camera z 1
  glm::dvec3 start_{0};            ///< the eye, source indices
  glm::dvec3 index_direction_{0};  ///< source indices
  double depth_ = 0;               ///< optical depth since the last hit
  std::vector<Met> met_;
};

void GridBlock::hit(const PickQuery& query, std::vector<PickHit>& hits) const {
  const VolumeSight* sight = query.sight_of(brick_.header.volume);
  if (sight == nullptr || !may_show(*sight)) return;
  for (const Ray::Met& met : Ray(*this, *sight, query).meet()) hits.push_back(met.hit);
}

/// The pixels that the brick may cover: those of its corners, or all if it reaches the eye's plane.
PixelRange GridBlock::pixels_of(const geometry::CameraFrame& frame, const PixelRange& within) const {
  glm::dvec2 low(std::numeric_limits<double>::max());
  glm::dvec2 high = -low;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::bvec3 upper(corner & 1, corner & 2, corner & 4);
    const glm::dvec3 at = frame.to_camera(origin_ + axes_ * glm::mix(box_.low, box_.high, upper));
    if (at.z <= 0) return within;
    low = glm::min(low, frame.project(at));
    high = glm::max(high, frame.project(at));
  }
  const glm::dvec2 first(within.first);
  const glm::dvec2 last(within.last);
  if (high.x < first.x || high.y < first.y || low.x > last.x + 1 || low.y > last.y + 1) return {};
  return {glm::ivec2(glm::clamp(glm::floor(low), first, last)), glm::ivec2(glm::clamp(glm::ceil(high), first, last))};
}

void GridBlock::cover(const PickQuery& query, PixelHits& pixels) const {
  const VolumeSight* sight = query.sight_of(brick_.header.volume);
  if (sight == nullptr || !may_show(*sight)) return;
  const PixelRange range = pixels_of(query.frame, pixels.range());
  PickQuery there = query;
  for (int y = range.first.y; y <= range.last.y; ++y) {
    for (int x = range.first.x; x <= range.last.x; ++x) {
      there.pixel = glm::dvec2(x, y) + 0.5;
      for (const Ray::Met& met : Ray(*this, *sight, there).meet()) pixels.add({x, y}, met.hit, met.look);
    }
  }
}

PickedSurfel GridBlock::describe(const PickQuery& query, uint32_t /*item*/) const {
  const glm::dvec3 ray = query.frame.ray(query.pixel);
  const glm::dvec3 direction = query.frame.right * ray.x + query.frame.up * ray.y + query.frame.forward;
  PickedSurfel picked;
  picked.position = query.frame.eye + query.depth * direction;
  picked.distance = query.depth * glm::length(direction);
  const glm::dvec3 index = to_index_ * (picked.position - origin_);
  const Field field = field_at(index);
  picked.normal = normal_of(field);
  picked.radius = 0.5 * std::cbrt(std::abs(glm::determinant(axes_)));
  picked.values = {{"value", field.value}, {"i", index.x}, {"j", index.y}, {"k", index.z}};
  return picked;
}

}  // namespace surfcast::kinds
