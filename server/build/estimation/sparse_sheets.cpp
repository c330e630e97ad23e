#include "estimation/sparse_sheets.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>
#include <optional>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "estimation/nearest_in_tree.h"
#include "estimation/neighbour_offsets.h"
#include "estimation/neighbour_spread.h"
#include "geometry/morton_tree.h"

namespace surfcast::estimation {
namespace {

/// Walls have normals whose vertical component is at most this one: 66 degrees.
constexpr float kSteepest = 0.4F;
/// Beside a denser surface, a point is so many times as far from its neighbours as these are from theirs.
constexpr float kSparser = 2.5F;
/// Distance of a surface to what continues it, in units of the distance of its points to their third nearest.
constexpr double kOnSurface = 0.5;
/// A sheet is no strip: the smallest ratio of the variances along its axes.
constexpr double kBroad = 0.2;
/// How many of twelve neighbours have a plane that is parallel, up to 18 degrees. Chance makes a plane of a few strays,
/// but hardly the same one of all.
constexpr float kParallelPlanes = 0.95F;
constexpr std::ptrdiff_t kAgreeingPlanes = 10;

/// A site beside a surface that is no wall.
struct Candidate {
  uint32_t site = 0;
  double denser = 0;  ///< distance of points of that surface to their twelfth nearest
};

/// Sites among which sheets are looked for, and those of them that may be on one.
struct SheetCandidates {
  std::vector<uint32_t> members;  ///< sites, ascending
  std::vector<Candidate> tested;  ///< some of them
};

bool is_steep(const SheetSearch& search, const glm::vec3& normal) {
  return std::abs(glm::dot(normal, search.up)) <= kSteepest;
}

double distance(const SheetSearch& search, uint32_t a, uint32_t b) {
  return glm::distance(search.sites.positions[a], search.sites.positions[b]);
}

/// The distance of each site to its third nearest.
std::vector<float> find_third_distances(const SheetSearch& search) {
  std::vector<float> thirds(search.sites.size());
  tbb::parallel_for(uint32_t{0}, static_cast<uint32_t>(thirds.size()), [&](uint32_t site) {
    thirds[site] = static_cast<float>(third_distance(search.sites, search.graph, site));
  });
  return thirds;
}

bool is_sparser_than_neighbours(const SheetSearch& search, std::span<const float> thirds, uint32_t site) {
  const float limit = thirds[site] / kSparser;
  const auto denser =
      std::ranges::count_if(search.graph.of(site), [&](uint32_t other) { return thirds[other] <= limit; });
  return 2 * static_cast<size_t>(denser) > kNearNeighbours;
}

enum class Role : uint8_t { kSurface, kWall, kUnresolved };

/// Scatter on the border of a surface is a part of it.
bool continues_surface(const SheetSearch& search, std::span<const float> thirds, std::span<const Role> roles,
                       uint32_t site) {
  const std::span<const uint32_t> neighbours = search.graph.of(site);
  const auto nearest = std::ranges::find_if(neighbours, [&](uint32_t other) { return roles[other] == Role::kSurface; });
  if (nearest == neighbours.end()) return false;
  const glm::dvec3 offset = search.sites.positions[site] - search.sites.positions[*nearest];
  return std::abs(glm::dot(offset, glm::dvec3(search.normals[*nearest]))) < kOnSurface * double{thirds[*nearest]};
}

std::vector<Role> find_roles(const SheetSearch& search, std::span<const float> thirds) {
  std::vector<Role> roles(search.sites.size());
  tbb::parallel_for(uint32_t{0}, static_cast<uint32_t>(roles.size()), [&](uint32_t site) {
    if (is_scatter(search.kinds[site]) || is_sparser_than_neighbours(search, thirds, site)) {
      roles[site] = Role::kUnresolved;
    } else if (is_steep(search, search.normals[site])) {
      roles[site] = Role::kWall;
    }
  });
  return roles;
}

/// For each site on no such surface, the mean distance to their twelfth nearest of the neighbours on surfaces that are
/// no walls; 0 if there are none. Along lines of a scanner, the third nearest would make surfaces look denser.
std::vector<float> find_distances_beside(const SheetSearch& search, std::span<const Role> roles) {
  std::vector<float> beside(roles.size());
  tbb::parallel_for(uint32_t{0}, static_cast<uint32_t>(roles.size()), [&](uint32_t site) {
    if (roles[site] == Role::kSurface) return;
    double sum = 0;
    int count = 0;
    for (const uint32_t other : search.graph.of(site)) {
      if (roles[other] != Role::kSurface) continue;
      sum += distance(search, other, search.graph.of(other).back());
      ++count;
    }
    if (count > 0) beside[site] = static_cast<float>(sum / count);
  });
  return beside;
}

/// The twelve nearest of a point may be on its wall although most of the 32 nearest are not: theirs count, too.
float distance_beside(const SheetSearch& search, std::span<const float> beside, uint32_t site) {
  if (beside[site] > 0) return beside[site];
  const std::span<const uint32_t> neighbours = search.graph.of(site);
  const auto nearest = std::ranges::find_if(neighbours, [&](uint32_t other) { return beside[other] > 0; });
  return nearest == neighbours.end() ? 0 : beside[*nearest];
}

SheetCandidates find_candidates(const SheetSearch& search) {
  const std::vector<float> thirds = find_third_distances(search);
  const std::vector<Role> roles = find_roles(search, thirds);
  const std::vector<float> beside = find_distances_beside(search, roles);
  SheetCandidates candidates;
  for (uint32_t site = 0; site < roles.size(); ++site) {
    if (roles[site] == Role::kSurface || continues_surface(search, thirds, roles, site)) continue;
    candidates.members.push_back(site);
    const float denser = distance_beside(search, beside, site);
    if (denser > 0) candidates.tested.push_back({site, double{denser}});
  }
  return candidates;
}

/// The candidates in a tree for searches of neighbours.
class CandidateTree {
 public:
  CandidateTree(const Sites& sites, std::span<const uint32_t> members)
      : members_(members), positions_(positions_of(sites, members)), tree_(positions_, codes_of(positions_)) {}

  /// True if at least `count` candidates, without the site itself, are nearer to it than `reach`.
  [[nodiscard]] bool has_within(const Sites& sites, uint32_t site, double reach, size_t count) const {
    const glm::dvec3& from = sites.positions[site];
    size_t found = 0;
    tree_.for_each_near({from, from}, reach * reach, [&](const geometry::MortonTree::Run& run) {
      for (uint32_t i = run.first; i < run.last; ++i) {
        found += glm::distance(from, positions_[i]) < reach && members_[i] != site ? 1 : 0;
      }
      return found < count;
    });
    return found >= count;
  }

  /// The candidates nearest to a site, without itself, nearest first.
  [[nodiscard]] std::array<uint32_t, kWideNeighbours> nearest(const Sites& sites, uint32_t site) const {
    const auto nearest = nearest_in_tree<kWideNeighbours>(tree_, positions_, sites.positions[site], kWideNeighbours,
                                                          [&](uint32_t i) { return members_[i] == site; });
    std::array<uint32_t, kWideNeighbours> found{};
    std::ranges::transform(nearest.all(), found.begin(), [this](const Found& other) { return members_[other.second]; });
    return found;
  }

 private:
  static std::vector<glm::dvec3> positions_of(const Sites& sites, std::span<const uint32_t> members) {
    std::vector<glm::dvec3> positions(members.size());
    std::ranges::transform(members, positions.begin(), [&](uint32_t site) { return sites.positions[site]; });
    return positions;
  }

  std::span<const uint32_t> members_;
  std::vector<glm::dvec3> positions_;
  geometry::MortonTree tree_;
};

/// The steep plane through a site and its neighbours, if they lie on one.
std::optional<glm::vec3> steep_plane(const SheetSearch& search, const NeighbourOffsets& offsets) {
  const Covariances covariances = covariances_of(offsets);
  const Spread wide = spread_of(covariances.wide);
  const bool flat = kind_of(spread_of(covariances.near), wide) == PointKind::kSurface;
  if (!flat || wide.middle < kBroad * wide.largest) return std::nullopt;
  const glm::vec3 normal(least_axis(covariances.wide, wide.least));
  return is_steep(search, normal) ? std::optional(normal) : std::nullopt;
}

/// The site as one of a sheet, if it and its neighbours among the candidates lie on a steep plane.
std::optional<SheetSite> sheet_site(const SheetSearch& search, const CandidateTree& tree, const Candidate& candidate) {
  const uint32_t site = candidate.site;
  // The candidates here must be sparser than the surface beside them.
  const double reach = double{kSparser} * candidate.denser;
  if (tree.has_within(search.sites, site, reach, kNearNeighbours)) return std::nullopt;
  const std::array<uint32_t, kWideNeighbours> nearest = tree.nearest(search.sites, site);
  const NeighbourOffsets offsets(search.sites, site, nearest);
  const std::optional<glm::vec3> normal = steep_plane(search, offsets);
  if (!normal) return std::nullopt;
  SheetSite sheet{site, *normal, guess_radius(offsets, kNearNeighbours, *normal, search.sites.unit), {}};
  std::copy_n(nearest.begin(), kNearNeighbours, sheet.neighbours.begin());
  return sheet;
}

/// Those of some sites that are on sheets, as far as they and their neighbours tell, ascending.
std::vector<SheetSite> sites_on_planes(const SheetSearch& search, const SheetCandidates& candidates) {
  const CandidateTree tree(search.sites, candidates.members);
  tbb::enumerable_thread_specific<std::vector<SheetSite>> found;
  tbb::parallel_for(size_t{0}, candidates.tested.size(), [&](size_t i) {
    if (const std::optional<SheetSite> sheet = sheet_site(search, tree, candidates.tested[i]))
      found.local().push_back(*sheet);
  });
  std::vector<SheetSite> all;
  for (const std::vector<SheetSite>& some : found) all.insert(all.end(), some.begin(), some.end());
  std::ranges::sort(all, {}, &SheetSite::site);
  return all;
}

/// The normal of a site: that of its sheet if it may be on one. `sheets` ascend.
const glm::vec3& normal_of(const SheetSearch& search, std::span<const SheetSite> sheets, uint32_t site) {
  const auto sheet = std::ranges::lower_bound(sheets, site, {}, &SheetSite::site);
  return sheet != sheets.end() && sheet->site == site ? sheet->normal : search.normals[site];
}

/// True if most neighbours have parallel planes.
bool is_shared_plane(const SheetSearch& search, std::span<const SheetSite> sheets, const SheetSite& sheet) {
  const auto agreeing = std::ranges::count_if(sheet.neighbours, [&](uint32_t other) {
    return std::abs(glm::dot(sheet.normal, normal_of(search, sheets, other))) > kParallelPlanes;
  });
  return agreeing >= kAgreeingPlanes;
}

}  // namespace

std::vector<SheetSite> find_sparse_sheets(const SheetSearch& search) {
  if (search.graph.degree < kNearNeighbours) return {};
  const SheetCandidates candidates = find_candidates(search);
  if (candidates.members.size() <= kWideNeighbours || candidates.tested.empty()) return {};
  const std::vector<SheetSite> sheets = sites_on_planes(search, candidates);
  std::vector<SheetSite> shared;
  std::ranges::copy_if(sheets, std::back_inserter(shared),
                       [&](const SheetSite& sheet) { return is_shared_plane(search, sheets, sheet); });
  return shared;
}

}  // namespace surfcast::estimation
