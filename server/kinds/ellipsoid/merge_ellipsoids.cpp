#include "ellipsoid/merge_ellipsoids.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <tuple>
#include <utility>

#include "base/contract.h"
#include "ellipsoid/tensor.h"
#include "surfel/srgb.h"

namespace surfcast::ellipsoid {
namespace {

constexpr double kMinReduction = 0.3;
/// Merged glyphs leave gaps where those that they stand for were seen through each other.
constexpr double kFilled = 1.25;

/// Members that stay, and groups that become one.
struct Grouping {
  std::vector<uint32_t> kept;
  std::vector<uint32_t> members;  ///< group after group
  std::vector<size_t> ends;       ///< of the groups

  [[nodiscard]] size_t size() const { return kept.size() + ends.size(); }
};

/// On this level all samples are in one cube.
constexpr int kTopLevel = 31;

using Cube = std::tuple<uint32_t, uint32_t, uint32_t>;

Cube cube_of(const glm::u32vec3& sample, int level) {
  return {sample.z >> level, sample.y >> level, sample.x >> level};
}

Grouping group_by_cube(const Ellipsoids& ellipsoids, const MergeRule& rule, int level) {
  Grouping grouping;
  std::vector<std::pair<Cube, uint32_t>> order;
  const double side = std::ldexp(rule.step, level);
  for (uint32_t i = 0; i < ellipsoids.size(); ++i) {
    const double semi_axis = rule.scale * double{ellipsoids.factors[i]} * ellipsoids.values[i].x;
    const bool large = !rule.on_grid && level < kTopLevel && semi_axis > side;
    if (large) grouping.kept.push_back(i);
    if (!large) order.emplace_back(cube_of(ellipsoids.samples[i], level), i);
  }
  std::sort(order.begin(), order.end());
  for (size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && order[i].first != order[i - 1].first) grouping.ends.push_back(i);
    grouping.members.push_back(order[i].second);
  }
  if (!order.empty()) grouping.ends.push_back(order.size());
  return grouping;
}

std::vector<float> as_floats(const surfel::ScalarValues& values) {
  return std::visit(
      [](const auto& typed) {
        std::vector<float> floats;
        floats.reserve(typed.size());
        for (const auto value : typed) floats.push_back(static_cast<float>(value));
        return floats;
      },
      values);
}

float factor_of(double count, const MergeRule& rule, int level) {
  if (!rule.on_grid) return static_cast<float>(largest_factor(count));
  return static_cast<float>(std::max(1.0, kFilled * std::sqrt(std::ldexp(count, -level))));
}

/// Weighted means over groups of ellipsoids, which become one each.
class Merger {
 public:
  Merger(const Ellipsoids& from, const MergeRule& rule, int level, Ellipsoids& to)
      : from_(from), rule_(rule), level_(level), to_(to) {
    for (const surfel::ScalarAttribute& scalar : from.scalars) {
      scalars_.push_back(as_floats(scalar.values));
      to.scalars.push_back({scalar.name, std::vector<float>()});
    }
  }

  void keep(uint32_t i) {
    to_.positions.push_back(from_.positions[i]);
    to_.values.push_back(from_.values[i]);
    to_.rotations.push_back(from_.rotations[i]);
    to_.samples.push_back(from_.samples[i]);
    to_.counts.push_back(from_.counts[i]);
    to_.factors.push_back(from_.factors[i]);
    if (!from_.colors.empty()) to_.colors.push_back(from_.colors[i]);
    for (size_t s = 0; s < scalars_.size(); ++s) floats(s).push_back(scalars_[s][i]);
  }

  void merge(std::span<const uint32_t> group) {
    if (group.size() == 1) return keep(group.front());
    double count = 0;
    for (const uint32_t i : group) count += double{from_.counts[i]};
    const glm::dvec3 origin = from_.positions[group.front()];
    const auto offset = [&](uint32_t i) { return from_.positions[i] - origin; };
    to_.positions.push_back(origin + mean(group, count, glm::dvec3(0), offset));
    append_tensor(group, count);
    to_.samples.push_back(from_.samples[group.front()]);
    to_.counts.push_back(static_cast<float>(count));
    to_.factors.push_back(factor_of(count, rule_, level_));
    if (!from_.colors.empty()) append_color(group, count);
    for (size_t s = 0; s < scalars_.size(); ++s) {
      const auto scalar = [&](uint32_t i) { return double{scalars_[s][i]}; };
      floats(s).push_back(static_cast<float>(mean(group, count, 0.0, scalar)));
    }
  }

 private:
  std::vector<float>& floats(size_t scalar) { return std::get<std::vector<float>>(to_.scalars[scalar].values); }

  template <typename Value>
  Value mean(std::span<const uint32_t> group, double count, Value sum, const auto& value) const {
    for (const uint32_t i : group) sum += double{from_.counts[i]} / count * value(i);
    return sum;
  }

  void append_tensor(std::span<const uint32_t> group, double count) {
    const auto tensor = [&](uint32_t i) {
      return tensor_of(from_.values[i], glm::mat3_cast(from_.rotations[i])).matrix();
    };
    const EigenSystem system = eigen_system(symmetric_part(mean(group, count, glm::dmat3(0), tensor)));
    to_.values.push_back(glm::max(system.values, glm::dvec3(0)));
    to_.rotations.push_back(glm::normalize(glm::quat_cast(system.axes)));
  }

  void append_color(std::span<const uint32_t> group, double count) {
    const auto light = [&](uint32_t i) { return glm::dvec3(surfel::to_linear(glm::u16vec3(from_.colors[i]), 8)); };
    to_.colors.emplace_back(surfel::from_linear(glm::vec3(mean(group, count, glm::dvec3(0), light)), 8));
  }

  const Ellipsoids& from_;
  const MergeRule& rule_;
  int level_;
  Ellipsoids& to_;
  std::vector<std::vector<float>> scalars_;
};

template <typename T>
void append_column(const std::vector<T>& from, std::vector<T>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

void append_scalar(const surfel::ScalarValues& from, surfel::ScalarValues& to) {
  if (from.index() != to.index()) {
    std::vector<float> floats = as_floats(to);
    append_column(as_floats(from), floats);
    to = std::move(floats);
    return;
  }
  std::visit([&](const auto& values) { append_column(values, std::get<std::decay_t<decltype(values)>>(to)); }, from);
}

}  // namespace

MergedEllipsoids merge_ellipsoids(const Ellipsoids& ellipsoids, const MergeRule& rule) {
  const auto wanted = static_cast<size_t>(kMinReduction * static_cast<double>(ellipsoids.size()));
  int level = std::max(rule.first_level, ellipsoids.level + 1);
  Grouping grouping = group_by_cube(ellipsoids, rule, level);
  while (grouping.size() > rule.most || (grouping.size() > wanted && level < rule.widest_level)) {
    grouping = group_by_cube(ellipsoids, rule, ++level);
  }
  MergedEllipsoids merged{{}, std::ldexp(rule.step, level)};
  merged.ellipsoids.level = level;
  Merger merger(ellipsoids, rule, level, merged.ellipsoids);
  for (const uint32_t i : grouping.kept) merger.keep(i);
  for (size_t g = 0, first = 0; g < grouping.ends.size(); first = grouping.ends[g++]) {
    merger.merge(std::span(grouping.members).subspan(first, grouping.ends[g] - first));
  }
  return merged;
}

/// A cube of a grid that holds `count` of them has a level of log8(count) at least.
double largest_factor(double count) {
  return std::max(1.0, kFilled * std::cbrt(count));
}

void append_all(const Ellipsoids& from, Ellipsoids& to) {
  if (to.size() == 0) {
    to = from;
    return;
  }
  SURFCAST_EXPECTS(from.scalars.size() == to.scalars.size());
  append_column(from.positions, to.positions);
  append_column(from.values, to.values);
  append_column(from.rotations, to.rotations);
  append_column(from.samples, to.samples);
  append_column(from.counts, to.counts);
  append_column(from.factors, to.factors);
  append_column(from.colors, to.colors);
  for (size_t s = 0; s < from.scalars.size(); ++s) append_scalar(from.scalars[s].values, to.scalars[s].values);
  to.level = std::max(to.level, from.level);
}

}  // namespace surfcast::ellipsoid
