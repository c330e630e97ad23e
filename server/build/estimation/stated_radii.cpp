#include "estimation/stated_radii.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <spdlog/fmt/fmt.h>
#include <tbb/parallel_for.h>

#include "base/contract.h"
#include "estimation/spacing.h"
#include "surfel/even_sampling.h"

namespace surfcast::estimation {
namespace {

constexpr size_t kComparedNeighbours = 6;

// Authors mean a share of the spacing or a multiple of it. Radii in other units are far off, and radii that do not
// follow the sampling spread. docs/kernel.md has the spread of conventions and of unrelated radii.
constexpr double kMinSpacings = 0.4;
constexpr double kMaxSpacings = 3;
constexpr double kMaxSpread = 2.5;
constexpr double kTail = 0.05;
constexpr uint64_t kFewest = 64;

/// The radius that is stated at a site by the first of its points that has one.
struct StatedSite {
  double radius = 0;  ///< 0: none
  size_t input = 0;
};

/// Calls `use(point, input)` for every surfel.
template <typename Use>
void for_each_point(const surfel::SurfelCloud& cloud, std::span<const size_t> inputs, const Use& use) {
  for (size_t s = 0; s < cloud.sources.size(); ++s) {
    const surfel::SourceRange& source = cloud.sources[s];
    for (size_t i = source.first; i < source.first + source.count; ++i) use(i, inputs[s]);
  }
}

/// The same on all threads.
template <typename Use>
void for_each_point_parallel(const surfel::SurfelCloud& cloud, std::span<const size_t> inputs, const Use& use) {
  for (size_t s = 0; s < cloud.sources.size(); ++s) {
    const surfel::SourceRange& source = cloud.sources[s];
    tbb::parallel_for(source.first, source.first + source.count, [&, s](size_t i) { use(i, inputs[s]); });
  }
}

std::vector<StatedSite> find_stated(const surfel::SurfelCloud& cloud, std::span<const size_t> inputs,
                                    const Sites& sites) {
  std::vector<StatedSite> stated(sites.size());
  for_each_point(cloud, inputs, [&](size_t i, size_t input) {
    StatedSite& site = stated[sites.of_point[i]];
    if (site.radius == 0 && is_radius(cloud.radii[i])) site = {double{cloud.radii[i]}, input};
  });
  return stated;
}

/// Stated to needed radius around a point of that site, by area.
double ratio_at(size_t site, const StatedSite& point, const std::vector<StatedSite>& stated,
                std::span<const float> needed, const NeighbourGraph& graph) {
  double stated_area = point.radius * point.radius;
  double needed_area = double{needed[site]} * double{needed[site]};
  for (const uint32_t j : graph.of(site).first(std::min(kComparedNeighbours, graph.degree))) {
    if (stated[j].radius == 0 || stated[j].input != point.input) continue;
    stated_area += stated[j].radius * stated[j].radius;
    needed_area += double{needed[j]} * double{needed[j]};
  }
  return std::sqrt(stated_area / needed_area);
}

bool follow_the_sampling(const RadiiInSpacings& radii) {
  return radii.median >= kMinSpacings && radii.median <= kMaxSpacings && radii.most <= kMaxSpread * radii.least;
}

/// A radius is neither 0 nor infinite.
float scaled(float radius, float factor) {
  using Limits = std::numeric_limits<float>;
  return factor == 1 ? radius : std::clamp(factor * radius, Limits::min(), Limits::max());
}

/// `around`: the radius of the surfaces around.
float estimated_radius(const Estimates& estimates, size_t i, double around) {
  return to_radius(limited_radius(estimates.kinds[i], double{estimates.radii[i]}, around));
}

/// The radius of the surfaces around every surfel as far as it limits an estimated radius; nothing if none is
/// estimated.
std::vector<float> radii_around(const surfel::SurfelCloud& cloud, std::span<const RadiusDecision> decisions,
                                const Estimates& estimates, const SurfaceSpacing& spacing) {
  const bool any_estimated =
      std::any_of(decisions.begin(), decisions.end(), [](const auto& decision) { return decision.estimated() > 0; });
  if (!any_estimated) return {};
  return spacing.at_all(cloud.positions, [&estimates](size_t i, double least) {
    return estimated_radius(estimates, i, least) == estimates.radii[i];  // larger surfaces do not limit it either
  });
}

}  // namespace

bool is_radius(float number) {
  return std::isfinite(number) && number > 0;
}

void RadiusComparison::add_stated(uint64_t points, uint64_t scatter) {
  stated_ += points;
  stated_scatter_ += scatter;
}

void RadiusComparison::add_missing(uint64_t points, uint64_t scatter) {
  missing_ += points;
  missing_scatter_ += scatter;
}

void RadiusComparison::add_ratio(double ratio) {
  constexpr double kEnd = kOctaves * kSteps;
  histogram_.resize(2 * kOctaves * kSteps + 1);
  const double step = std::clamp(std::round(kSteps * std::log2(ratio)), -kEnd, kEnd);
  ++histogram_[static_cast<size_t>(step + kEnd)];
}

void RadiusComparison::add(const RadiusComparison& part) {
  add_stated(part.stated_, part.stated_scatter_);
  add_missing(part.missing_, part.missing_scatter_);
  histogram_.resize(std::max(histogram_.size(), part.histogram_.size()));
  std::transform(part.histogram_.begin(), part.histogram_.end(), histogram_.begin(), histogram_.begin(), std::plus<>());
}

std::vector<uint64_t> RadiusComparison::numbers() const {
  std::vector<uint64_t> numbers{stated_, missing_, stated_scatter_, missing_scatter_};
  numbers.insert(numbers.end(), histogram_.begin(), histogram_.end());
  return numbers;
}

std::optional<RadiusComparison> RadiusComparison::of_numbers(std::span<const uint64_t> numbers) {
  constexpr size_t kTotals = 4;
  if (numbers.size() != kTotals && numbers.size() != kTotals + 2 * kOctaves * kSteps + 1) return std::nullopt;
  RadiusComparison comparison;
  comparison.add_stated(numbers[0], numbers[2]);
  comparison.add_missing(numbers[1], numbers[3]);
  comparison.histogram_.assign(numbers.begin() + kTotals, numbers.end());
  return comparison;
}

uint64_t RadiusComparison::ratios() const {
  return std::accumulate(histogram_.begin(), histogram_.end(), uint64_t{0});
}

double RadiusComparison::quantile(double share) const {
  const uint64_t count = ratios();
  SURFCAST_EXPECTS(count > 0 && share >= 0 && share <= 1);
  auto below = static_cast<uint64_t>(share * static_cast<double>(count - 1));
  size_t step = 0;
  while (histogram_[step] <= below) below -= histogram_[step++];
  return std::exp2(static_cast<double>(step) / kSteps - kOctaves);
}

std::vector<RadiusComparison> compare_radii(const surfel::SurfelCloud& cloud, std::span<const size_t> inputs,
                                            const Sites& sites, const NeighbourGraph& graph,
                                            std::span<const SitePlace> places, std::span<const PointKind> kinds,
                                            std::span<const float> needed) {
  std::vector<RadiusComparison> comparisons;
  for_each_point(cloud, inputs, [&](size_t i, size_t input) {
    comparisons.resize(std::max(comparisons.size(), input + 1));
    const uint32_t site = sites.of_point[i];
    if (!places[site].own) return;
    const bool stated = !cloud.radii.empty() && is_radius(cloud.radii[i]);
    const uint64_t scatter = is_scatter(kinds[i]) ? 1 : 0;
    if (stated) comparisons[input].add_stated(1, scatter);
    if (!stated) comparisons[input].add_missing(1, scatter);
  });
  if (cloud.radii.empty() || needed.empty()) return comparisons;
  const std::vector<StatedSite> stated = find_stated(cloud, inputs, sites);
  for_each_point(cloud, inputs, [&](size_t i, size_t input) {
    const uint32_t site = sites.of_point[i];
    if (!places[site].own || !is_radius(cloud.radii[i])) return;
    comparisons[input].add_ratio(ratio_at(site, {double{cloud.radii[i]}, input}, stated, needed, graph));
  });
  return comparisons;
}

RadiusDecision decide_radii(const RadiusComparison& comparison, RadiusPolicy policy) {
  RadiusDecision decision;
  decision.stated = comparison.stated();
  decision.missing = comparison.missing();
  decision.stated_scatter = comparison.stated_scatter();
  decision.missing_scatter = comparison.missing_scatter();
  if (decision.stated == 0 || policy == RadiusPolicy::kEstimate) return decision;
  decision.outcome = RadiusOutcome::kKept;
  if (policy == RadiusPolicy::kKeep || comparison.ratios() < kFewest) return decision;
  const auto in_spacings = [&](double share) { return surfel::kRadiusOverSpacing * comparison.quantile(share); };
  decision.stating = RadiiInSpacings{in_spacings(0.5), in_spacings(kTail), in_spacings(1 - kTail)};
  if (follow_the_sampling(*decision.stating)) {
    decision.outcome = RadiusOutcome::kScaled;
    decision.factor = static_cast<float>(1 / comparison.quantile(0.5));
  } else {
    decision.outcome = RadiusOutcome::kEstimated;
  }
  return decision;
}

std::string describe(const RadiusDecision& decision) {
  if (decision.stated == 0) return "no radius is finite and positive: estimated";
  if (!decision.stating) return decision.outcome == RadiusOutcome::kKept ? "radii kept" : "radii estimated";
  if (decision.outcome == RadiusOutcome::kScaled) {
    return fmt::format("radii of {:.3g} spacings, scaled by {:.3g}", decision.stating->median, decision.factor);
  }
  return fmt::format("radii do not follow the sampling ({:.3g} to {:.3g} spacings): estimated", decision.stating->least,
                     decision.stating->most);
}

void apply_radii(std::span<const RadiusDecision> decisions, std::span<const size_t> inputs, const Estimates& estimates,
                 const SurfaceSpacing& spacing, surfel::SurfelCloud& cloud) {
  SURFCAST_EXPECTS(estimates.radii.size() == cloud.size() && estimates.kinds.size() == cloud.size());
  cloud.estimated_radii = std::all_of(decisions.begin(), decisions.end(), [](const RadiusDecision& decision) {
    return decision.outcome == RadiusOutcome::kEstimated;
  });
  cloud.radii.resize(cloud.size(), 0.0F);
  std::vector<uint8_t> scatter(cloud.size());
  const std::vector<float> around = radii_around(cloud, decisions, estimates, spacing);
  for_each_point_parallel(cloud, inputs, [&](size_t i, size_t input) {
    const RadiusDecision& decision = decisions[input];
    if (decision.outcome != RadiusOutcome::kEstimated && is_radius(cloud.radii[i])) {
      cloud.radii[i] = scaled(cloud.radii[i], decision.factor);
    } else {
      cloud.radii[i] = estimated_radius(estimates, i, double{around[i]});
      scatter[i] = is_scatter(estimates.kinds[i]) ? 1 : 0;
    }
  });
  const bool any = std::find(scatter.begin(), scatter.end(), uint8_t{1}) != scatter.end();
  if (any) cloud.scatter = std::move(scatter);
}

}  // namespace surfcast::estimation
