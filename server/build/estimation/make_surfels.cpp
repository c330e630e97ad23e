#include "estimation/make_surfels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <span>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include "estimation/neighbour_offsets.h"
#include "estimation/neighbour_spread.h"
#include "estimation/neighbours.h"
#include "estimation/spacing.h"
#include "estimation/sparse_sheets.h"

namespace surfcast::estimation {
namespace {

/// Neighbours from which the normal of a site is estimated.
constexpr size_t kDegree = kNearNeighbours;

bool has_normal(const surfel::SurfelCloud& cloud, size_t i) {
  return !cloud.normals.empty() && !std::isnan(cloud.normals[i].x);
}

/// Largest radius where the largest distance of neighbours is known, in units of it. Small pieces of a surface have
/// their next neighbours on others.
constexpr double kWidestStep = 1.25;

/// Properties of the sites that their points determine.
struct SiteFacts {
  std::vector<SitePlace> places;
  std::vector<SiteDirection> known;
  std::vector<glm::vec3> towards;  ///< empty if nothing is known
  std::vector<PointKind> kinds;
  /// The largest radius of sites that are known to lie on a surface, world units; 0 elsewhere. Empty if there are none.
  std::vector<float> widest;
  bool z_up = true;  ///< or y

  [[nodiscard]] bool known_surface(size_t site) const { return !widest.empty() && widest[site] > 0; }

  SiteFacts(size_t sites, bool any_known)
      : places(sites), known(sites), towards(any_known ? sites : 0, glm::vec3(0)), kinds(sites) {}
};

/// Records the direction of a point at its site. The first point at a site counts, but a stored normal takes precedence
/// over a direction to the scanner.
void learn_direction(const surfel::SurfelCloud& cloud, size_t point, size_t site,
                     const std::optional<glm::dvec3>& sensor, SiteFacts& facts) {
  if (has_normal(cloud, point)) {
    if (facts.known[site] == SiteDirection::kStored) return;
    facts.known[site] = SiteDirection::kStored;
    facts.towards[site] = cloud.normals[point];
  } else if (sensor && *sensor != cloud.positions[point] && facts.known[site] == SiteDirection::kUnknown) {
    facts.known[site] = SiteDirection::kToScanner;
    facts.towards[site] = glm::vec3(glm::normalize(*sensor - cloud.positions[point]));
  }
}

SiteFacts find_site_facts(const surfel::SurfelCloud& cloud, const Sites& sites, const PartFrame& frame) {
  const bool any_known = !cloud.normals.empty() || std::any_of(frame.sensors.begin(), frame.sensors.end(),
                                                               [](const auto& sensor) { return sensor.has_value(); });
  SiteFacts facts(sites.size(), any_known);
  facts.z_up = cloud.z_up;
  const bool any_surface = std::any_of(frame.surface_steps.begin(), frame.surface_steps.end(),
                                       [](const auto& step) { return step.has_value(); });
  if (any_surface) facts.widest.resize(sites.size());
  const bool own_sites = sites.size() == cloud.size();
  for (size_t s = 0; s < cloud.sources.size(); ++s) {
    const surfel::SourceRange& source = cloud.sources[s];
    const auto learn = [&](size_t i) {
      const uint32_t site = sites.of_point[i];
      facts.places[site] = frame.place(cloud.positions[i]);
      learn_direction(cloud, i, site, frame.sensors[s], facts);
      if (any_surface && frame.surface_steps[s]) facts.widest[site] = to_radius(kWidestStep * *frame.surface_steps[s]);
    };
    const size_t end = source.first + source.count;
    if (own_sites) {
      tbb::parallel_for(source.first, end, learn);
    } else {
      for (size_t i = source.first; i < end; ++i) learn(i);
    }
  }
  return facts;
}

/// The number of own points for which `use(point)` is true. Calls it for every point, on all threads.
template <typename Use>
uint64_t count_own(const Sites& sites, const SiteFacts& facts, const Use& use) {
  using Range = tbb::blocked_range<size_t>;
  return tbb::parallel_reduce(
      Range(0, sites.of_point.size()), uint64_t{0},
      [&](const Range& range, uint64_t count) {
        for (size_t i = range.begin(); i != range.end(); ++i) {
          if (use(i)) count += facts.places[sites.of_point[i]].own ? 1 : 0;
        }
        return count;
      },
      std::plus<>());
}

bool all_stated(const std::vector<float>& radii) {
  return !radii.empty() && std::all_of(radii.begin(), radii.end(), is_radius);
}

/// World units, within the range of float.
float scatter_radius_of(const Sites& sites, const NeighbourGraph& graph, uint32_t site) {
  return to_radius(scatter_radius(third_distance(sites, graph, site)) * sites.unit);
}

/// What each surfel is, and how large it is as such. `on_surface`: the radius of each site if it is a disc.
Estimates estimates_of(const Sites& sites, const NeighbourGraph& graph, const SiteFacts& facts,
                       std::span<const float> on_surface) {
  Estimates estimates;
  estimates.radii.resize(sites.of_point.size());
  estimates.kinds.resize(sites.of_point.size());
  tbb::parallel_for(size_t{0}, sites.of_point.size(), [&](size_t i) {
    const uint32_t site = sites.of_point[i];
    estimates.kinds[i] = facts.kinds[site];
    estimates.radii[i] = is_scatter(estimates.kinds[i]) ? scatter_radius_of(sites, graph, site) : on_surface[site];
  });
  return estimates;
}

std::vector<SurfaceSample> sample_surfaces(const Sites& sites, const NeighbourGraph& graph, const SiteFacts& facts,
                                           std::span<const float> estimated, const PartFrame& frame) {
  const uint64_t per_sample = points_per_sample(frame.points);
  tbb::enumerable_thread_specific<std::vector<SurfaceSample>> samples;
  using Range = tbb::blocked_range<uint32_t>;
  tbb::parallel_for(Range(0, static_cast<uint32_t>(sites.size())), [&](const Range& range) {
    std::vector<SurfaceSample>& own = samples.local();
    for (uint32_t site = range.begin(); site != range.end(); ++site) {
      const bool usable = facts.kinds[site] == PointKind::kSurface && facts.places[site].own;
      if (!usable || !is_sampled(sites, graph, site, per_sample)) continue;
      own.push_back({sites.positions[site], estimated[site]});
    }
  });
  std::vector<SurfaceSample> all;
  for (const std::vector<SurfaceSample>& own : samples) all.insert(all.end(), own.begin(), own.end());
  return all;
}

/// True if no radius is estimated.
bool radii_kept(const surfel::SurfelCloud& cloud, const PartFrame& frame) {
  return frame.radii == RadiusPolicy::kKeep && all_stated(cloud.radii);
}

/// What the neighbours of every site tell, found while they are at hand.
struct Findings {
  NeighbourGraph graph;
  std::vector<glm::vec3> normals;    ///< those of the scan where it has them
  std::vector<RadiusGuess> guesses;  ///< of radii; none if no radius is estimated
};

/// The normals that the scan has; z elsewhere.
std::vector<glm::vec3> stored_normals(const SiteFacts& facts) {
  std::vector<glm::vec3> normals(facts.known.size(), glm::vec3(0, 0, 1));
  if (facts.towards.empty()) return normals;
  tbb::parallel_for(size_t{0}, normals.size(), [&](size_t i) {
    if (facts.known[i] == SiteDirection::kStored) normals[i] = facts.towards[i];
  });
  return normals;
}

/// Makes scatter of the sites that may be in a layer, but whose neighbours are not.
void settle_layers(const NeighbourGraph& graph, std::span<const glm::vec3> normals, std::span<PointKind> kinds) {
  tbb::parallel_for(size_t{0}, kinds.size(), [&](size_t site) {
    if (kinds[site] != PointKind::kLayer) return;
    std::array<double, kDegree> cosines{};
    const auto end = std::ranges::transform(graph.of(site), cosines.begin(), [&](uint32_t neighbour) {
                       return double{glm::dot(normals[site], normals[neighbour])};
                     }).out;
    if (!is_in_layer({cosines.begin(), end})) kinds[site] = PointKind::kScatter;
  });
}

/// The neighbours of a site on a sheet become those on the same sheet. A scanner that is known stands before the walls,
/// and the points on them are dense.
void settle_sheets(const Sites& sites, SiteFacts& facts, Findings& findings) {
  const auto unknown = [](SiteDirection known) { return known == SiteDirection::kUnknown; };
  if (std::ranges::none_of(facts.known, unknown)) return;
  const glm::vec3 up = facts.z_up ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
  for (const SheetSite& sheet : find_sparse_sheets({sites, findings.graph, facts.kinds, findings.normals, up})) {
    if (!unknown(facts.known[sheet.site])) continue;
    facts.kinds[sheet.site] = PointKind::kSheet;
    findings.normals[sheet.site] = sheet.normal;
    findings.guesses[sheet.site] = sheet.guess;
    std::ranges::copy(sheet.neighbours, findings.graph.ids.begin() + static_cast<std::ptrdiff_t>(sheet.site * kDegree));
  }
}

/// Sets `facts.kinds`, too, if radii are estimated.
Findings study_neighbourhoods(const Sites& sites, bool radii, SiteFacts& facts) {
  Findings findings{{}, stored_normals(facts), std::vector<RadiusGuess>(radii ? sites.size() : 0)};
  const size_t visited = radii ? kWideNeighbours : kDegree;
  findings.graph = find_neighbours(sites, kDegree, visited, [&](uint32_t site, std::span<const uint32_t> neighbours) {
    const bool stored = facts.known[site] == SiteDirection::kStored;
    if (!radii && stored) return;
    const NeighbourOffsets offsets(sites, site, neighbours);
    const Covariances covariances = covariances_of(offsets);
    const Spread near = spread_of(covariances.near);
    if (!stored) findings.normals[site] = glm::vec3(least_axis(covariances.near, near.least));
    if (!radii) return;
    facts.kinds[site] = kind_of_site(near, covariances.wide, offsets.count);
    const bool sheet =
        facts.kinds[site] == PointKind::kLayer && is_in_sheet(offsets, least_axis(covariances.near, near.least));
    if (sheet || facts.known_surface(site)) facts.kinds[site] = PointKind::kSurface;
    findings.guesses[site] = guess_radius(offsets, kDegree, findings.normals[site], sites.unit);
  });
  if (radii) settle_layers(findings.graph, findings.normals, facts.kinds);
  if (radii) settle_sheets(sites, facts, findings);
  return findings;
}

/// Limits the radii of sites on known surfaces.
void limit_radii(const SiteFacts& facts, std::vector<float>& radii) {
  if (facts.widest.empty()) return;
  tbb::parallel_for(size_t{0}, radii.size(), [&](size_t site) {
    if (facts.known_surface(site)) radii[site] = std::min(radii[site], facts.widest[site]);
  });
}

/// Estimates the radius of every surfel and compares those stated with it, unless all are stated and kept.
void find_radii(const Sites& sites, const NeighbourGraph& graph, const SiteFacts& facts,
                std::vector<RadiusGuess> guesses, const PartFrame& frame, PartSurfels& made) {
  const surfel::SurfelCloud& cloud = made.cloud;
  std::vector<float> on_surface;
  if (guesses.empty()) {
    made.estimates = {cloud.radii, std::vector<PointKind>(cloud.size(), PointKind::kStated)};
  } else {
    on_surface = settle_radii(graph, guesses);
    limit_radii(facts, on_surface);
    std::vector<RadiusGuess>().swap(guesses);
    made.estimates = estimates_of(sites, graph, facts, on_surface);
    made.samples = sample_surfaces(sites, graph, facts, on_surface, frame);
  }
  made.radii = compare_radii(cloud, frame.inputs, sites, graph, facts.places, made.estimates.kinds, on_surface);
}

/// Copies the normals of the sites to points without one. Returns the tree of each point, or kNoTree.
std::vector<uint32_t> fill_normals(const Sites& sites, const NeighbourGraph& graph, const SiteFacts& facts,
                                   std::vector<glm::vec3> normals, bool sides, surfel::SurfelCloud& cloud,
                                   PartSigns& signs, SurfelReport& report) {
  std::vector<uint32_t> tree_of(sides ? 0 : sites.size(), kNoTree);
  if (sides)
    tree_of = orient_normals({sites, graph, facts.known, facts.towards, facts.places, facts.kinds}, normals, signs);
  std::vector<uint32_t> trees(cloud.size(), kNoTree);
  cloud.normals.resize(cloud.size(), glm::vec3(std::nanf("")));
  report.normals_estimated += count_own(sites, facts, [&](size_t i) {
    const bool missing = !has_normal(cloud, i);
    if (missing) cloud.normals[i] = normals[sites.of_point[i]];
    if (missing) trees[i] = tree_of[sites.of_point[i]];
    return missing;
  });
  return trees;
}

}  // namespace

void SurfelReport::add(const SurfelReport& part) {
  points_read += part.points_read;
  not_finite += part.not_finite;
  duplicates += part.duplicates;
  zero_normals += part.zero_normals;
  normals_estimated += part.normals_estimated;
}

PartSurfels make_surfels(surfel::SurfelCloud cloud, const PartFrame& frame, PartSigns& signs, SurfelReport& report) {
  Sites sites = find_sites(cloud.positions, frame.bounds);
  SiteFacts facts = find_site_facts(cloud, sites, frame);
  Findings findings = study_neighbourhoods(sites, !radii_kept(cloud, frame), facts);
  PartSurfels made;
  made.cloud = std::move(cloud);
  find_radii(sites, findings.graph, facts, std::move(findings.guesses), frame, made);
  made.trees =
      fill_normals(sites, findings.graph, facts, std::move(findings.normals), frame.sides, made.cloud, signs, report);
  if (frame.keep_neighbours) made.neighbourhoods = Neighbourhoods{std::move(sites), std::move(findings.graph)};
  return made;
}

void apply_signs(const ResolvedSigns& signs, size_t part, PartSurfels& surfels) {
  tbb::parallel_for(size_t{0}, surfels.cloud.size(), [&](size_t i) {
    surfels.cloud.normals[i] = signs.apply(surfels.cloud.normals[i], part, surfels.trees[i]);
  });
  surfels.cloud.oriented = signs.oriented;
}

}  // namespace surfcast::estimation
