#include "estimation/orient_normals.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <unordered_map>
#include <utility>

#include <tbb/parallel_for.h>

#include "estimation/links.h"
#include "estimation/propagate_signs.h"

namespace surfcast::estimation {
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

/// Sites are added up in chunks of this size, whatever the number of threads, so that sums do not depend on it.
constexpr size_t kSumChunk = 65536;

size_t sum_chunks_of(size_t sites) {
  return (sites + kSumChunk - 1) / kSumChunk;
}

/// Orients the normals of known direction individually.
void face_known(const SitesOfPart& part, std::vector<glm::vec3>& normals) {
  if (part.towards.empty()) return;
  tbb::parallel_for(size_t{0}, normals.size(), [&](size_t i) {
    if (glm::dot(normals[i], part.towards[i]) < 0) normals[i] = -normals[i];
  });
}

/// Gives every site its sign relative to its tree. Returns the tree of each site.
std::vector<uint32_t> take_signs(SurfacePieces pieces, std::vector<glm::vec3>& normals, PartSigns& signs) {
  tbb::parallel_for(size_t{0}, normals.size(), [&](size_t i) {
    if (pieces.opposed[i] != 0) normals[i] = -normals[i];
  });
  signs.trees.resize(pieces.count);
  return std::move(pieces.piece);
}

/// Sums over the sites or links of a chunk.
class ChunkSums {
 public:
  /// The sums of a tree. `origin` becomes its origin if it is new.
  TreeVotes& tree(uint32_t tree, const glm::dvec3& origin) {
    if (tree != last_tree_ || trees_.empty()) {
      const auto [place, added] = places_.try_emplace(tree, trees_.size());
      if (added) trees_.push_back({tree, {}});
      if (added) trees_.back().second.origin = origin;
      last_tree_ = tree;
      last_ = place->second;
    }
    return trees_[last_].second;
  }
  void add_link(double similarity) { (similarity < 0 ? conflict_ : agreement_) += std::abs(similarity); }

  void add_to(PartSigns& signs) const {
    signs.agreement += agreement_;
    signs.conflict += conflict_;
    for (const auto& [tree, votes] : trees_) {
      TreeVotes& all = signs.trees[tree];
      if (all.area == 0) all.origin = votes.origin;
      all.add(votes);
    }
  }

 private:
  std::vector<std::pair<uint32_t, TreeVotes>> trees_;
  std::unordered_map<uint32_t, size_t> places_;  ///< of the trees in the list
  uint32_t last_tree_ = 0;
  size_t last_ = 0;
  double agreement_ = 0;
  double conflict_ = 0;
};

/// Calls `use(site, sums)` for all sites, chunk by chunk on all threads, and adds up the sums of the chunks in order.
template <typename Use>
void add_up(size_t sites, PartSigns& signs, const Use& use) {
  std::vector<ChunkSums> sums(sum_chunks_of(sites));
  tbb::parallel_for(size_t{0}, sums.size(), [&](size_t chunk) {
    for (size_t i = chunk * kSumChunk; i < std::min(sites, (chunk + 1) * kSumChunk); ++i) use(i, sums[chunk]);
  });
  for (const ChunkSums& chunk : sums) chunk.add_to(signs);
}

void vote(const SitesOfPart& part, std::span<const glm::vec3> normals, std::span<const uint32_t> tree_of,
          PartSigns& signs) {
  add_up(normals.size(), signs, [&](size_t i, ChunkSums& sums) {
    if (!part.places[i].own) return;
    TreeVotes& tree = sums.tree(tree_of[i], part.sites.positions[i]);
    const double area = area_of(part, i);
    const glm::dvec3 p = part.sites.positions[i] - tree.origin;
    const glm::dvec3 n(normals[i]);
    tree.area += area;
    tree.moment += area * p;
    tree.spread += area * glm::dot(p, p);
    tree.normal += area * n;
    tree.flux += area * glm::dot(n, p);
    if (!part.towards.empty()) tree.towards += area * static_cast<double>(glm::dot(normals[i], part.towards[i]));
  });
}

/// Adds up the agreement and conflict of linked sites. A link across the border counts half in each part. `tree_of` is
/// empty if all directions are known.
void count_agreement(const SitesOfPart& part, const Links& links, std::span<const glm::vec3> normals,
                     std::span<const uint32_t> tree_of, PartSigns& signs) {
  const auto is_known = [&part](uint32_t site) { return part.known[site] != SiteDirection::kUnknown; };
  add_up(normals.size(), signs, [&](size_t site, ChunkSums& sums) {
    links.for_each(site, site + 1, [&](uint32_t a, uint32_t b) {
      const double share = 0.5 * ((part.places[a].own ? 1 : 0) + (part.places[b].own ? 1 : 0));
      const double similarity = share * static_cast<double>(glm::dot(normals[a], normals[b]));
      if (is_known(a) == is_known(b)) {
        sums.add_link(similarity);
      } else {
        TreeVotes& tree = sums.tree(tree_of[a], part.sites.positions[a]);
        (similarity < 0 ? tree.conflict : tree.agreement) += std::abs(similarity);
      }
    });
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
  const Links links(part.graph, normals.size());
  std::vector<uint32_t> tree_of;
  if (nothing_open) {
    for (size_t i = 0; i < normals.size(); ++i) signs.resolved_area += part.places[i].own ? area_of(part, i) : 0;
  } else {
    tree_of = take_signs(propagate_signs(part.sites, links, normals, part.kinds), normals, signs);
    vote(part, normals, tree_of, signs);
    sample_border(part, normals, tree_of, signs);
    face_known(part, normals);
  }
  count_agreement(part, links, normals, tree_of, signs);
  tree_of.resize(normals.size(), kNoTree);
  for (size_t i = 0; i < normals.size(); ++i) {
    if (part.known[i] != SiteDirection::kUnknown) tree_of[i] = kNoTree;
  }
  return tree_of;
}

}  // namespace surfcast::estimation
