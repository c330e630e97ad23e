#include "render/transfer_function.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "base/contract.h"
#include "shared/volume_layout.h"
#include "surfel/srgb.h"

namespace surfcast::render {
namespace {

constexpr double kOpaqueDepth = 16;    ///< optical depth of one spacing at opacity 1: a transmittance of 1e-7
constexpr double kLargestDepth = 256;  ///< of one spacing
/// Of a sum over all bins. Differences of sums must fit in 31 bits.
constexpr double kLargestSum = 2147480000;

/// Optical depth of one spacing. `opacity`: factor of the opacity of a spacing.
double depth_of(const picture::TransferPoint& point, double spacing, double opacity) {
  if (point.extinction && opacity == 1) return std::min(*point.extinction * spacing, kLargestDepth);
  const double own = point.extinction ? -std::expm1(-*point.extinction * spacing) : std::min(point.opacity, 1.0);
  return std::min(-std::log1p(-opacity * own), kOpaqueDepth);
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

glm::dvec3 linear_from_srgb(const glm::dvec3& color) {
  return {surfel::decode_srgb(color.x), surfel::decode_srgb(color.y), surfel::decode_srgb(color.z)};
}

std::vector<picture::TransferPoint> sorted_points(std::span<const picture::TransferPoint> points) {
  std::vector<picture::TransferPoint> sorted(points.begin(), points.end());
  std::ranges::stable_sort(sorted, {}, &picture::TransferPoint::value);
  return sorted;
}

TransferFunction::TransferFunction(std::span<const picture::TransferPoint> points, double spacing, double opacity) {
  SURFCAST_EXPECTS(spacing > 0 && opacity >= 0 && opacity <= 1);
  points_.reserve(points.size());
  for (const picture::TransferPoint& p : sorted_points(points)) {
    points_.push_back({p.value, {linear_from_srgb(p.color), depth_of(p, spacing, opacity) / spacing}});
  }
}

Classified TransferFunction::at(double value) const {
  if (points_.empty()) return {};
  const auto above = std::ranges::upper_bound(points_, value, {}, &Point::value);
  if (above == points_.begin()) return above->seen;
  const Point& below = *(above - 1);
  if (above == points_.end()) return below.seen;
  const double part = (value - below.value) / (above->value - below.value);
  return {glm::mix(below.seen.color, above->seen.color, part),
          std::lerp(below.seen.extinction, above->seen.extinction, part)};
}

bool TransferFunction::visible_within(double low, double high) const {
  const auto first = std::ranges::lower_bound(points_, low, {}, &Point::value);
  const auto seen = [&](const Point& p) { return p.value <= high && p.seen.extinction > 0; };
  return at(low).extinction > 0 || at(high).extinction > 0 || std::any_of(first, points_.end(), seen);
}

glm::dvec4 TransferFunction::smooth_integral(double low, double high) const {
  // Two places of Gauss and Legendre: exact for colour times extinction, a polynomial of degree 2.
  constexpr double kPlace = 0.57735026918962576;
  const double half = 0.5 * (high - low);
  glm::dvec4 sum(0);
  for (const double side : {-1.0, 1.0}) {
    const Classified seen = at(low + half * (1 + side * kPlace));
    sum += half * glm::dvec4(seen.extinction * seen.color, seen.extinction);
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
  std::vector<glm::dvec4> bins{density(points_.front().seen)};
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
