#include "simplify/simplify.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "base/contract.h"
#include "simplify/cover.h"
#include "surfel/srgb.h"

namespace surfcast::simplify {
namespace {

/// Directions among which the nearest border of a surfel is sought, and how far samples are looked for, in its radii.
constexpr size_t kBorderDirections = 64;
constexpr double kBorderReach = 1.3;
/// A model of which parts stay as they are pays from half of the samples on.
constexpr double kMinGain = 2;
/// Neighbours whose mean distance is the radius of a surfel, as in scan/spacing.h.
constexpr size_t kRadiusNeighbours = 6;

/// The mean distance to the nearest centres of other patches.
double mean_distance(const PointTree& tree, const glm::dvec3& centre, double reach, std::vector<Near>& near) {
  for (int i = 0; i < 4; ++i, reach *= 2) {
    tree.within(centre, reach, near);
    if (near.size() > kRadiusNeighbours) break;
  }
  std::sort(near.begin(), near.end(), [](const Near& a, const Near& b) { return a.square < b.square; });
  near.resize(std::min(near.size(), kRadiusNeighbours + 1));
  double sum = 0;
  for (const Near& n : near) sum += std::sqrt(n.square);
  return near.size() > 1 ? sum / static_cast<double>(near.size() - 1) : 0;
}

/// The radius of each patch: the mean distance to its neighbours, where the sizes are even, but at least what its
/// samples need to be covered, and at most its neighbourhood.
std::vector<double> radii_of(const SampledSurface& surface, const Cover& chosen) {
  const std::vector<Patch>& patches = chosen.patches();
  std::vector<double> needed(patches.size(), 0);
  for (uint32_t sample = 0; sample < surface.size(); ++sample) {
    const uint32_t owner = chosen.owners()[sample];
    const double distance = glm::distance(surface.position(sample), patches[owner].surface.centre);
    if (patches[owner].reach > 0) needed[owner] = std::max(needed[owner], distance + 0.5 * surface.radius(sample));
  }
  const std::vector<glm::dvec3> centres = centres_of(surface, patches);
  const PointTree tree(centres);
  std::vector<Near> near;
  std::vector<double> radii;
  for (size_t i = 0; i < patches.size(); ++i) {
    const double own = surface.radius(patches[i].sample);
    const double mean = patches[i].reach > 0 ? mean_distance(tree, centres[i], patches[i].reach, near) : 0;
    radii.push_back(patches[i].reach > 0 ? std::max(std::min(mean, patches[i].reach), needed[i]) : own);
  }
  return radii;
}

/// `least`: samples for each surfel from which on it pays.
SimplifyReport report_of(const SampledSurface& surface, const Cover& chosen, double least) {
  SimplifyReport report;
  report.samples = surface.size();
  report.points = chosen.patches().size();
  size_t paying = 0;
  for (const Patch& p : chosen.patches()) {
    report.curved += p.curved ? 1 : 0;
    report.kept += p.reach == 0 ? 1 : 0;
    paying += p.pays ? 1 : 0;
    report.degrees = std::max(report.degrees, p.residual.angle * 180 / std::numbers::pi);
    report.height = std::max(report.height, p.residual.height);
  }
  if (static_cast<double>(surface.size()) < least * static_cast<double>(report.points)) {
    report.reason = "a surfel would stand for fewer than 20 points on more than half of the surface";
  } else if (2 * paying < report.points - report.kept) {
    report.reason = "curvature would not lower the error of half of the surfels";
  }
  report.pays = report.reason.empty();
  return report;
}

/// Removes the surfels whose `keep` is false.
void keep_rows(const std::vector<bool>& keep, surfel::SurfelCloud& cloud) {
  const auto filter = [&keep](auto& values) {
    size_t next = 0;
    for (size_t i = 0; i < values.size(); ++i) {
      if (keep[i]) values[next++] = values[i];
    }
    values.resize(values.empty() ? 0 : next);
  };
  size_t before = 0;
  for (surfel::SourceRange& source : cloud.sources) {
    const auto first = keep.begin() + static_cast<std::ptrdiff_t>(source.first);
    source.count = static_cast<size_t>(std::count(first, first + static_cast<std::ptrdiff_t>(source.count), true));
    source.first = std::exchange(before, before + source.count);
  }
  filter(cloud.positions);
  filter(cloud.normals);
  filter(cloud.radii);
  filter(cloud.weights);
  filter(cloud.scatter);
  if (cloud.colors) filter(cloud.colors->values);
  for (surfel::ScalarAttribute& scalar : cloud.scalars) std::visit(filter, scalar.values);
}

/// The mean colours of the samples of each patch.
std::vector<glm::vec3> mean_light(const SampledSurface& surface, const Cover& chosen,
                                  const surfel::ColorAttribute& colors) {
  std::vector<glm::dvec3> sums(chosen.patches().size(), glm::dvec3(0));
  std::vector<double> counts(sums.size(), 0);
  for (uint32_t sample = 0; sample < surface.size(); ++sample) {
    const uint32_t owner = chosen.owners()[sample];
    sums[owner] += glm::dvec3(surfel::to_linear(colors.values[surface.row(sample)], colors.bits));
    counts[owner] += 1;
  }
  std::vector<glm::vec3> means;
  for (size_t i = 0; i < sums.size(); ++i) means.emplace_back(sums[i] / std::max(counts[i], 1.0));
  return means;
}

/// Where the samples of a patch end within the reach of its surfel, half a spacing after the last. None if they do not.
std::optional<surfel::Border> border_of(const SampledSurface& surface, const Patch& patch,
                                        const surfel::OsculatingSurface& stored, double radius, Scratch& scratch) {
  surface.sheet(stored.centre, stored.normal, kBorderReach * radius, scratch.near);
  surfel::Border nearest{{}, std::numeric_limits<double>::max()};
  for (size_t i = 0; i < kBorderDirections; ++i) {
    const double turn = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(kBorderDirections);
    const glm::dvec2 direction(std::cos(turn), std::sin(turn));
    double farthest = 0;
    for (const Near& n : scratch.near) {
      farthest = std::max(farthest, glm::dot(direction, stored.place(surface.position(n.point))));
    }
    if (farthest < nearest.distance) nearest = {direction, farthest};
  }
  nearest.distance = (nearest.distance + 0.5 * surface.radius(patch.sample)) / radius;
  return nearest.distance < 1 ? std::optional(nearest) : std::nullopt;
}

/// Writes the surface of a patch over the surfel at its centre. Returns its curvature and border.
surfel::CurvatureCode write(const SampledSurface& surface, const Patch& patch, double radius,
                            const geometry::Box& bounds, Scratch& scratch, surfel::SurfelCloud& cloud) {
  if (patch.reach == 0) return {};
  const surfel::OsculatingSurface stored = surfel::storable(patch.surface);
  surfel::CurvatureCode code{};
  if (patch.curved) code = surfel::encode_curvature(stored.curvature, radius);
  if (const auto border = border_of(surface, patch, stored, radius, scratch)) code[3] = surfel::encode_border(*border);
  const uint32_t row = surface.row(patch.sample);
  cloud.positions[row] = glm::clamp(stored.centre, bounds.min, bounds.max);
  cloud.normals[row] = glm::vec3(stored.normal);
  cloud.radii[row] = static_cast<float>(radius);
  return code;
}

/// Replaces the samples by the patches.
void apply(const SampledSurface& surface, const Cover& chosen, surfel::SurfelCloud& cloud) {
  const geometry::Box bounds = cloud.bounds();
  const std::vector<double> radii = radii_of(surface, chosen);
  const std::vector<glm::vec3> light =
      cloud.colors ? mean_light(surface, chosen, *cloud.colors) : std::vector<glm::vec3>();
  std::vector<surfel::CurvatureCode> codes(cloud.size());
  std::vector<bool> keep(cloud.size());
  Scratch scratch;
  for (size_t i = 0; i < cloud.size(); ++i) keep[i] = cloud.is_scatter(i);
  for (size_t i = 0; i < chosen.patches().size(); ++i) {
    const Patch& patch = chosen.patches()[i];
    const uint32_t row = surface.row(patch.sample);
    keep[row] = true;
    codes[row] = write(surface, patch, radii[i], bounds, scratch, cloud);
    if (cloud.colors) cloud.colors->values[row] = surfel::from_linear(light[i], cloud.colors->bits);
  }
  surfel::add_curvature(codes, cloud);
  keep_rows(keep, cloud);
  cloud.estimated_normals = false;  // fits are as accurate as the normals of a source
  cloud.estimated_radii = false;
}

}  // namespace

SimplifyReport simplify(const ErrorBound& bound, surfel::SurfelCloud& cloud) {
  SURFCAST_EXPECTS(bound.degrees > 0 && (!bound.height || *bound.height > 0));
  SimplifyReport report;
  {
    const SampledSurface surface(cloud);
    if (surface.size() == 0) {
      report.reason = "no point lies on a surface";
      return report;
    }
    Cover chosen = cover(surface, bound);
    report = report_of(surface, chosen, kMinSamplesPerPoint);
    if (!report.pays) {
      chosen.release_patches_below(static_cast<size_t>(kMinSamplesPerPoint));
      report = report_of(surface, chosen, kMinGain);
    }
    if (report.pays) apply(surface, chosen, cloud);
  }
  return report;
}

}  // namespace surfcast::simplify
