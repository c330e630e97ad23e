#include "scan/orient_normals.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

#include "scan/links.h"
#include "scan/propagate_signs.h"

namespace surfcast::scan {
namespace {

/// One in this many sites near a border links the trees of two parts. The choice depends only on the position, so both
/// parts choose the same sites.
constexpr uint64_t kBorderSample = 16;

/// The squared distance to the farthest neighbour, which is proportional to the area that a site stands for.
double area_of(const SitesOfPart& part, size_t site) {
  if (part.graph.degree == 0) return 0;
  const glm::dvec3 d = part.sites.positions[part.graph.of(site).back()] - part.sites.positions[site];
  return glm::dot(d, d);
}

/// Orients the normals of known direction individually.
void face_known(const SitesOfPart& part, std::vector<glm::vec3>& normals) {
  for (size_t i = 0; i < normals.size(); ++i) {
    if (glm::dot(normals[i], part.towards[i]) < 0) normals[i] = -normals[i];
  }
}

/// Gives every site its sign relative to the root of its tree, and numbers the trees.
std::vector<uint32_t> number_trees(SignedForest& forest, std::vector<glm::vec3>& normals, PartSigns& signs) {
  std::vector<uint32_t> tree_of(normals.size());
  std::vector<uint32_t> number_of_root(normals.size(), kNoTree);
  for (uint32_t i = 0; i < normals.size(); ++i) {
    const auto [root, opposed] = forest.find(i);
    if (opposed) normals[i] = -normals[i];
    uint32_t& number = number_of_root[root];
    if (number == kNoTree) {
      number = static_cast<uint32_t>(signs.trees.size());
      signs.trees.emplace_back();
    }
    tree_of[i] = number;
  }
  return tree_of;
}

void vote(const SitesOfPart& part, std::span<const glm::vec3> normals, std::span<const uint32_t> tree_of,
          PartSigns& signs) {
  for (size_t i = 0; i < normals.size(); ++i) {
    if (!part.places[i].own) continue;
    TreeVotes& tree = signs.trees[tree_of[i]];
    if (tree.area == 0) tree.origin = part.sites.positions[i];
    const double area = area_of(part, i);
    const glm::dvec3 p = part.sites.positions[i] - tree.origin;
    const glm::dvec3 n(normals[i]);
    tree.area += area;
    tree.moment += area * p;
    tree.spread += area * glm::dot(p, p);
    tree.normal += area * n;
    tree.flux += area * glm::dot(n, p);
    tree.towards += area * static_cast<double>(glm::dot(normals[i], part.towards[i]));
  }
}

/// Adds up the agreement and conflict of linked sites. A link across the border counts half in each part. `tree_of` is
/// empty if all directions are known.
void count_agreement(const SitesOfPart& part, std::span<const glm::vec3> normals, std::span<const uint32_t> tree_of,
                     PartSigns& signs) {
  const auto is_known = [&part](uint32_t site) { return part.known[site] != SiteDirection::kUnknown; };
  for_each_link(part.graph, normals.size(), [&](uint32_t a, uint32_t b) {
    const double share = 0.5 * ((part.places[a].own ? 1 : 0) + (part.places[b].own ? 1 : 0));
    const double similarity = share * static_cast<double>(glm::dot(normals[a], normals[b]));
    const bool mixed = is_known(a) != is_known(b);
    double& agreement = mixed ? signs.trees[tree_of[a]].agreement : signs.agreement;
    double& conflict = mixed ? signs.trees[tree_of[a]].conflict : signs.conflict;
    (similarity < 0 ? conflict : agreement) += std::abs(similarity);
  });
}

/// Stirs all bits of a hash into all others (the finaliser of SplitMix64, Steele et al. 2014).
constexpr uint64_t mix_hash(uint64_t h) {
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ULL;
  h = (h ^ (h >> 27)) * 0x94d049bb133111ebULL;
  return h ^ (h >> 31);
}

/// Decides which places speak for a part's border: a model depends on these numbers.
uint64_t hash_place(const glm::dvec3& p) {
  uint64_t hash = mix_hash(std::bit_cast<uint64_t>(p.x));
  hash = mix_hash(hash + std::bit_cast<uint64_t>(p.y));
  return mix_hash(hash + std::bit_cast<uint64_t>(p.z));
}

void sample_border(const SitesOfPart& part, std::span<const glm::vec3> normals, std::span<const uint32_t> tree_of,
                   PartSigns& signs) {
  for (size_t i = 0; i < normals.size(); ++i) {
    if (!part.places[i].near_border || part.known[i] != SiteDirection::kUnknown) continue;
    const uint64_t place = hash_place(part.sites.positions[i]);
    if (place % kBorderSample == 0) signs.border.push_back({place, normals[i], tree_of[i]});
  }
}

bool all_own_known(const SitesOfPart& part) {
  for (size_t i = 0; i < part.known.size(); ++i) {
    if (part.places[i].own && part.known[i] == SiteDirection::kUnknown) return false;
  }
  return true;
}

}  // namespace

std::vector<uint32_t> orient_normals(const SitesOfPart& part, std::vector<glm::vec3>& normals, PartSigns& signs) {
  face_known(part, normals);
  signs.all_known = all_own_known(part);
  const bool nothing_open =
      std::find(part.known.begin(), part.known.end(), SiteDirection::kUnknown) == part.known.end();
  std::vector<uint32_t> tree_of;
  if (nothing_open) {
    for (size_t i = 0; i < normals.size(); ++i) signs.resolved_area += part.places[i].own ? area_of(part, i) : 0;
  } else {
    SignedForest forest = propagate_signs(part.sites, part.graph, normals);
    tree_of = number_trees(forest, normals, signs);
    vote(part, normals, tree_of, signs);
    sample_border(part, normals, tree_of, signs);
    face_known(part, normals);
  }
  count_agreement(part, normals, tree_of, signs);
  tree_of.resize(normals.size(), kNoTree);
  for (size_t i = 0; i < normals.size(); ++i) {
    if (part.known[i] != SiteDirection::kUnknown) tree_of[i] = kNoTree;
  }
  return tree_of;
}

}  // namespace surfcast::scan
