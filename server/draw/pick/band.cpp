#include "pick/band.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <utility>

#include "pick/leaf_numbers.h"

namespace surfcast::pick {
namespace {

/// A bijection of 64 bits whose order looks random (the finalizer of SplitMix64).
uint64_t shuffled(uint64_t number) {
  uint64_t z = number + 0x9e3779b97f4a7c15U;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31);
}

double value_at(const surfel::ScalarValues& values, size_t i) {
  return std::visit([i](const auto& column) { return static_cast<double>(column[i]); }, values);
}

bool is_surfels(const model::ModelFile& model, const ldc::BlockEntry& block) {
  return model.info().kinds[block.kind].kind == model::kSurfelKind;
}

double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// The points of a band as they are found.
class Collection {
 public:
  Collection(size_t most, size_t attributes) : most_(most), attributes_(attributes) {}

  void add(uint64_t number, const BandPoint& point, const model::DecodedBlock& block, size_t surfel) {
    ++total_;
    const uint64_t order = shuffled(number);
    if (order > largest_) return;
    found_.push_back({order, number, point});
    for (size_t a = 0; a < attributes_; ++a) values_.push_back(value_at(block.scalars[a].values, surfel));
    if (found_.size() >= 2 * std::max<size_t>(most_, 1024)) thin();
  }

  void move_to(Band& band) {
    thin();
    std::vector<size_t> order(found_.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::sort(order.begin(), order.end(), [this](size_t a, size_t b) {
      return std::pair(found_[a].point.place.along, found_[a].number) <
             std::pair(found_[b].point.place.along, found_[b].number);
    });
    take(order);
    band.total = total_;
    band.points.reserve(found_.size());
    for (const Found& found : found_) band.points.push_back(found.point);
    band.values = std::move(values_);
  }

 private:
  struct Found {
    uint64_t order = 0;  ///< the least ones are the sample
    uint64_t number = 0;
    BandPoint point;
  };

  /// Leaves the sample only.
  void thin() {
    if (found_.size() <= most_) return;
    std::vector<size_t> order(found_.size());
    std::iota(order.begin(), order.end(), size_t{0});
    const auto last = order.begin() + static_cast<std::ptrdiff_t>(most_);
    std::nth_element(order.begin(), last, order.end(),
                     [this](size_t a, size_t b) { return found_[a].order < found_[b].order; });
    largest_ = found_[*last].order;
    order.resize(most_);
    take(order);
  }

  /// Rearranges points and values.
  void take(const std::vector<size_t>& order) {
    std::vector<Found> found;
    std::vector<double> values;
    found.reserve(order.size());
    values.reserve(order.size() * attributes_);
    for (const size_t i : order) {
      found.push_back(found_[i]);
      const auto first = values_.begin() + static_cast<std::ptrdiff_t>(i * attributes_);
      values.insert(values.end(), first, first + static_cast<std::ptrdiff_t>(attributes_));
    }
    found_ = std::move(found);
    values_ = std::move(values);
  }

  size_t most_;
  size_t attributes_;
  uint64_t total_ = 0;
  uint64_t largest_ = ~uint64_t{0};  ///< Found::order beyond which no point is in the sample
  std::vector<Found> found_;
  std::vector<double> values_;
};

void add_block(const model::DecodedBlock& block, uint64_t first, const Course& course, double reach,
               Collection& collection) {
  for (size_t i = 0; i < block.size(); ++i) {
    const glm::dvec3 position = block.position(i);
    const std::optional<CoursePlace> place = course.place(position, reach);
    if (!place) continue;
    const glm::u16vec3 color = block.colors.empty() ? glm::u16vec3(0) : block.colors[i];
    collection.add(first + i, {position, *place, color}, block, i);
  }
}

bool finer(const surfel::Grid& a, const surfel::Grid& b) {
  return a.scale.x * a.scale.y * a.scale.z < b.scale.x * b.scale.y * b.scale.z;
}

}  // namespace

glm::dvec2 Course::level(const glm::dvec3& point) const {
  return z_up_ ? glm::dvec2(point.x, point.y) : glm::dvec2(point.z, point.x);
}

Result<Course> Course::of(const std::vector<glm::dvec3>& line, bool z_up) {
  Course course;
  course.z_up_ = z_up;
  for (size_t i = 1; i < line.size(); ++i) {
    const glm::dvec2 from = course.level(line[i - 1]);
    const glm::dvec2 step = course.level(line[i]) - from;
    const double length = std::hypot(step.x, step.y);
    if (!std::isfinite(length)) return fail(ErrorKind::kInvalidInput, "line: coordinates must be finite numbers");
    if (!(length > 0)) continue;
    course.parts_.push_back({from, step / length, length, course.length_});
    course.length_ += length;
  }
  if (course.parts_.empty())
    return fail(ErrorKind::kInvalidInput, "line: two points with different horizontal positions are needed");
  return course;
}

std::optional<CoursePlace> Course::place(const glm::dvec3& point, double reach) const {
  const glm::dvec2 at = level(point);
  std::optional<CoursePlace> nearest;
  double least = reach * reach;
  for (size_t i = 0; i < parts_.size(); ++i) {
    const Part& part = parts_[i];
    const glm::dvec2 offset = at - part.from;
    const double along = glm::dot(offset, part.direction);
    const bool before_start = i == 0 && along < 0;
    const bool after_end = i + 1 == parts_.size() && along > part.length;
    if (before_start || after_end) continue;
    const double clamped = std::clamp(along, 0.0, part.length);
    const glm::dvec2 away = offset - clamped * part.direction;
    const double squared = glm::dot(away, away);
    if (squared > least || (nearest && squared == least)) continue;
    least = squared;
    nearest = {part.before + clamped, std::copysign(std::sqrt(squared), cross(part.direction, offset))};
  }
  return nearest;
}

bool Course::may_reach(const geometry::Box& box, double reach) const {
  const glm::dvec2 centre = level(box.centre());
  const double far = reach + 0.5 * glm::length(level(box.size()));
  return std::any_of(parts_.begin(), parts_.end(), [&](const Part& part) {
    const glm::dvec2 offset = centre - part.from;
    const double along = std::clamp(glm::dot(offset, part.direction), 0.0, part.length);
    return glm::length(offset - along * part.direction) <= far * (1 + 1e-9);
  });
}

Result<Band> find_band(const model::ModelFile& model, const BandQuery& query, const std::atomic<bool>& cancelled) {
  const Result<Course> course = Course::of(query.line, model.info().z_up);
  if (!course) return fail(course);
  const double reach = 0.5 * query.width;
  const std::vector<uint64_t> numbers = leaf_numbers(model);
  Collection collection(query.most, model.info().scalar_names.size());
  Band band;
  band.length = course->length();
  bool first = true;
  for (uint32_t i = 0; i < model.blocks().size(); ++i) {
    const ldc::BlockEntry& entry = model.blocks()[i];
    const bool wanted = model.tree().children(i).count == 0 && is_surfels(model, entry);
    if (!wanted || !course->may_reach(entry.bounds, reach)) continue;
    if (cancelled.load(std::memory_order_relaxed)) return fail(ErrorKind::kCancelled, "cancelled");
    const Result<model::DecodedBlock> block = model.decode(i);
    if (!block) return fail(block);
    if (first || finer(block->grid, band.grid)) band.grid = block->grid;
    first = false;
    add_block(*block, numbers[i], *course, reach, collection);
  }
  collection.move_to(band);
  return band;
}

}  // namespace surfcast::pick
