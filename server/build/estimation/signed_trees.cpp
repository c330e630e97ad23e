#include "estimation/signed_trees.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "estimation/signed_forest.h"

namespace surfcast::estimation {

void TreeVotes::move_origin(const glm::dvec3& to) {
  const glm::dvec3 d = to - origin;
  spread += area * glm::dot(d, d) - 2 * glm::dot(d, moment);
  moment -= area * d;
  flux -= glm::dot(normal, d);
  origin = to;
}

void TreeVotes::flip() {
  normal = -normal;
  flux = -flux;
  towards = -towards;
  std::swap(agreement, conflict);
}

void TreeVotes::add(TreeVotes other) {
  other.move_origin(origin);
  area += other.area;
  moment += other.moment;
  spread += other.spread;
  normal += other.normal;
  flux += other.flux;
  towards += other.towards;
  agreement += other.agreement;
  conflict += other.conflict;
}

namespace {

/// Largest share of disagreement between neighbours for which signs count as consistent. Smooth and sharp-edged
/// surfaces stay below 0.02, foliage exceeds 0.1.
constexpr double kMaxConflict = 0.05;

/// The agreement of two trees of different parts at the sites that both contain.
struct Bridge {
  uint32_t a = 0;
  uint32_t b = 0;
  double agreement = 0;  ///< sum of n . n'
};

/// Trees of all parts are numbered consecutively. Returns the number of the first tree of each part.
std::vector<uint32_t> first_trees(std::span<const PartSigns> parts) {
  std::vector<uint32_t> first = {0};
  for (const PartSigns& part : parts) first.push_back(first.back() + static_cast<uint32_t>(part.trees.size()));
  return first;
}

std::vector<Bridge> pairs_at_borders(std::span<const PartSigns> parts, const std::vector<uint32_t>& first) {
  std::vector<BorderSite> sites;
  for (size_t i = 0; i < parts.size(); ++i) {
    for (BorderSite site : parts[i].border) {
      site.tree += first[i];
      sites.push_back(site);
    }
  }
  std::sort(sites.begin(), sites.end(), [](const BorderSite& a, const BorderSite& b) {
    return a.place != b.place ? a.place < b.place : a.tree < b.tree;
  });
  std::vector<Bridge> pairs;
  for (size_t i = 0; i < sites.size(); ++i) {
    for (size_t j = i + 1; j < sites.size() && sites[j].place == sites[i].place; ++j) {
      pairs.push_back({sites[i].tree, sites[j].tree, static_cast<double>(glm::dot(sites[i].normal, sites[j].normal))});
    }
  }
  return pairs;
}

/// One bridge for each pair of trees, strongest first.
std::vector<Bridge> find_bridges(std::span<const PartSigns> parts, const std::vector<uint32_t>& first) {
  std::vector<Bridge> pairs = pairs_at_borders(parts, first);
  const auto ends = [](const Bridge& bridge) { return std::pair(bridge.a, bridge.b); };
  std::stable_sort(pairs.begin(), pairs.end(), [&](const Bridge& p, const Bridge& q) { return ends(p) < ends(q); });
  std::vector<Bridge> bridges;
  for (const Bridge& pair : pairs) {
    if (bridges.empty() || ends(bridges.back()) != ends(pair)) {
      bridges.push_back(pair);
    } else {
      bridges.back().agreement += pair.agreement;
    }
  }
  std::stable_sort(bridges.begin(), bridges.end(),
                   [](const Bridge& p, const Bridge& q) { return std::abs(p.agreement) > std::abs(q.agreement); });
  return bridges;
}

bool may_be_room(const Scene& scene) {
  const glm::dvec3 half_size = 0.5 * scene.bounds.max - 0.5 * scene.bounds.min;
  std::array<double, 3> sorted = {half_size.x, half_size.y, half_size.z};
  std::sort(sorted.begin(), sorted.end());
  return scene.z_up || 2 * sorted[0] <= sorted[1];
}

/// The flux of the tree relative to its centroid.
double central_flux(const TreeVotes& tree) {
  return tree.flux - glm::dot(tree.normal, tree.moment) / tree.area;
}

/// True if the tree is closed, or so nearly that the sign of its volume is certain. The normals of a closed surface sum
/// to zero. Otherwise the sum is the area of the holes, and a lid over the holes changes the flux by about this area
/// times its distance.
bool encloses_volume(const TreeVotes& tree) {
  // The flux of a sphere of the same area and spread.
  const double reach = std::sqrt(tree.area * tree.spread - glm::dot(tree.moment, tree.moment));
  const double holes = glm::length(tree.normal) / tree.area;
  const double fullness = std::abs(central_flux(tree)) / reach;
  return fullness > 0.1 && fullness > 2 * holes;
}

struct Decision {
  bool flip = false;
  bool trusted = false;  ///< backed by evidence
};

Decision decide(const TreeVotes& tree, const Scene& scene) {
  constexpr double kTerrain = 0.25;  // share of the area, projected along z
  if (tree.towards != 0) return {tree.towards < 0, true};
  if (scene.z_up && std::abs(tree.normal.z) > kTerrain * tree.area) return {tree.normal.z < 0, true};
  if (tree.area > 0 && central_flux(tree) != 0) {
    return {central_flux(tree) < 0, !may_be_room(scene) && encloses_volume(tree)};
  }
  return {tree.normal.z < 0, false};
}

/// The trees of all parts; trees of one surface are joined.
struct JoinedTrees {
  SignedForest forest;
  std::vector<TreeVotes> votes;  ///< at the root of each joined tree: the votes of all its members

  JoinedTrees(std::span<const PartSigns> parts, const std::vector<uint32_t>& first) : forest(first.back()) {
    for (const auto& [a, b, agreement] : find_bridges(parts, first)) forest.join(a, b, agreement < 0);
    std::vector<TreeVotes> own;
    for (const PartSigns& part : parts) own.insert(own.end(), part.trees.begin(), part.trees.end());
    votes.resize(own.size());
    for (uint32_t i = 0; i < own.size(); ++i) {
      const auto [root, opposed] = forest.find(i);
      if (opposed) own[i].flip();
      if (votes[root].area == 0) votes[root].origin = own[i].origin;
      votes[root].add(own[i]);
    }
  }
};

}  // namespace

ResolvedSigns resolve_signs(std::span<const PartSigns> parts, const Scene& scene) {
  const std::vector<uint32_t> first = first_trees(parts);
  JoinedTrees joined(parts, first);
  std::vector<Decision> decisions(joined.votes.size());
  TreeVotes total;
  double trusted = 0;
  bool all_known = true;
  for (const PartSigns& part : parts) {
    total.area += part.resolved_area;
    total.agreement += part.agreement;
    total.conflict += part.conflict;
    trusted += part.resolved_area;
    all_known = all_known && part.all_known;
  }
  for (size_t i = 0; i < decisions.size(); ++i) {
    TreeVotes& tree = joined.votes[i];
    decisions[i] = decide(tree, scene);
    if (decisions[i].flip) tree.flip();
    total.area += tree.area;
    total.agreement += tree.agreement;
    total.conflict += tree.conflict;
    if (decisions[i].trusted) trusted += tree.area;
  }
  const bool agree = total.conflict <= kMaxConflict * (total.agreement + total.conflict);
  ResolvedSigns signs;
  signs.oriented = all_known ? !scene.normals_stored || agree : trusted >= 0.9 * total.area && total.area > 0 && agree;
  signs.face_up = !signs.oriented && scene.z_up;
  for (size_t i = 0; i < parts.size(); ++i) {
    std::vector<uint8_t>& flipped = signs.flipped.emplace_back(parts[i].trees.size());
    for (uint32_t tree = 0; tree < flipped.size(); ++tree) {
      const auto [root, opposed] = joined.forest.find(first[i] + tree);
      flipped[tree] = opposed != decisions[root].flip ? 1 : 0;
    }
  }
  return signs;
}

}  // namespace surfcast::estimation
