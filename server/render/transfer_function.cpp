#include "render/transfer_function.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>

#include "base/contract.h"
#include "shared/volume_layout.h"

namespace surfcast::render {
namespace {

constexpr double kOpaqueDepth = 16;  ///< optical depth of one spacing at opacity 1: a transmittance of 1e-7
/// Of a sum over all bins. Differences of sums must fit in 31 bits.
constexpr double kLargestSum = 2147480000;

double linear_from_srgb(double code) {
  return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
}

glm::dvec3 linear_from_srgb(const glm::dvec3& color) {
  return {linear_from_srgb(color.x), linear_from_srgb(color.y), linear_from_srgb(color.z)};
}

/// The sums of the bins before each bin, and of all, in integers of `units`.
std::vector<glm::uvec4> rounded_sums(const std::vector<glm::dvec4>& bins, const glm::dvec4& units) {
  std::vector<glm::uvec4> sums{glm::uvec4(0)};
  for (const glm::dvec4& bin : bins) {
    glm::uvec4 part(0);
    for (int i = 0; i < 4; ++i) part[i] = units[i] > 0 ? static_cast<uint32_t>(std::lround(bin[i] / units[i])) : 0;
    sums.push_back(sums.back() + part);
  }
  return sums;
}

}  // namespace

TransferFunction::TransferFunction(std::span<const picture::TransferPoint> points, double spacing) : spacing_(spacing) {
  SURFCAST_EXPECTS(spacing > 0);
  for (const picture::TransferPoint& p : points) points_.push_back({p.value, linear_from_srgb(p.color), p.opacity});
  std::ranges::stable_sort(points_, {}, &Point::value);
}

Classified TransferFunction::classified(const glm::dvec3& color, double opacity) const {
  return {color, std::min(-std::log1p(-std::min(opacity, 1.0)), kOpaqueDepth) / spacing_};
}

Classified TransferFunction::at(double value) const {
  if (points_.empty()) return {};
  const auto above = std::ranges::upper_bound(points_, value, {}, &Point::value);
  if (above == points_.begin()) return classified(above->color, above->opacity);
  const Point& below = *(above - 1);
  if (above == points_.end()) return classified(below.color, below.opacity);
  const double part = (value - below.value) / (above->value - below.value);
  return classified(glm::mix(below.color, above->color, part), std::lerp(below.opacity, above->opacity, part));
}

bool TransferFunction::visible_within(double low, double high) const {
  const auto first = std::ranges::lower_bound(points_, low, {}, &Point::value);
  const auto seen = [&](const Point& p) { return p.value <= high && p.opacity > 0; };
  return at(low).extinction > 0 || at(high).extinction > 0 || std::any_of(first, points_.end(), seen);
}

glm::dvec4 TransferFunction::smooth_integral(double low, double high) const {
  // Gauss and Legendre, four places.
  constexpr std::array<double, 2> kPlaces{0.33998104358485626, 0.86113631159405258};
  constexpr std::array<double, 2> kWeights{0.65214515486254614, 0.34785484513745386};
  const double half = 0.5 * (high - low);
  glm::dvec4 sum(0);
  for (size_t i = 0; i < kPlaces.size(); ++i) {
    for (const double side : {-1.0, 1.0}) {
      const Classified seen = at(low + half * (1 + side * kPlaces.at(i)));
      sum += half * kWeights.at(i) * glm::dvec4(seen.extinction * seen.color, seen.extinction);
    }
  }
  return sum;
}

glm::dvec4 TransferFunction::integral(double low, double high) const {
  glm::dvec4 sum(0);
  auto next = std::ranges::upper_bound(points_, low, {}, &Point::value);
  for (double from = low; from < high;) {
    const double to = next == points_.end() ? high : std::min(next->value, high);
    sum += smooth_integral(from, to);
    from = to;
    if (next != points_.end()) ++next;
  }
  return sum;
}

TransferTable TransferFunction::table() const {
  TransferTable table;
  if (points_.empty()) {
    table.sums.assign(3, glm::uvec4(0));
    return table;
  }
  const auto density = [](const Classified& c) { return glm::dvec4(c.extinction * c.color, c.extinction); };
  const double width = points_.back().value - points_.front().value;
  table.first = points_.front().value;
  std::vector<glm::dvec4> bins{density(classified(points_.front().color, points_.front().opacity))};
  if (width > 0) {
    table.bins_per_value = SURFCAST_TRANSFER_BINS / width;
    const auto edge = [&](int bin) { return table.first + width * bin / SURFCAST_TRANSFER_BINS; };
    for (int bin = 0; bin < SURFCAST_TRANSFER_BINS; ++bin) {
      bins.push_back(table.bins_per_value * integral(edge(bin), edge(bin + 1)));
    }
  }
  bins.push_back(density(at(points_.back().value)));
  glm::dvec4 total(0);
  for (const glm::dvec4& bin : bins) total += bin;
  table.extinction_unit = total.w / kLargestSum;
  table.color_unit = std::max({total.x, total.y, total.z}) / kLargestSum;
  table.sums = rounded_sums(bins, glm::dvec4(glm::dvec3(table.color_unit), table.extinction_unit));
  return table;
}

}  // namespace surfcast::render
