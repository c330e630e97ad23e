#include "scan/orient_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "geometry/box.h"
#include "scan/signed_forest.h"

namespace surfcast {
namespace {

/// Neighbours of each site that signs spread to; more only costs time.
constexpr size_t kLinks = 8;

/// Share of disagreement between neighbours up to which signs count as consistent. Smooth and sharp-edged surfaces
/// stay below 0.02, normals of foliage come out above 0.1.
constexpr double kMostConflict = 0.05;

struct Link {
  uint32_t a;
  uint32_t b;
};

std::span<const uint32_t> links_of(const NeighbourGraph& graph, size_t site) {
  return graph.of(site).first(std::min(kLinks, graph.degree));
}

/// Calls `use(a, b)` once for every pair of linked sites.
template <typename Use>
void for_each_link(const NeighbourGraph& graph, size_t sites, const Use& use) {
  for (uint32_t a = 0; a < sites; ++a) {
    for (const uint32_t b : links_of(graph, a)) {
      const auto back = links_of(graph, b);
      if (a < b || std::find(back.begin(), back.end(), a) == back.end()) use(a, b);
    }
  }
}

/// Links by falling |n . n'|, in steps of 1/4095: a counting sort, and stable, so that the order is always the same.
std::vector<Link> sorted_links(const NeighbourGraph& graph, std::span<const glm::vec3> normals) {
  constexpr size_t kSteps = 4096;
  const auto step_of = [&normals](uint32_t a, uint32_t b) {
    const float similarity = std::min(std::abs(glm::dot(normals[a], normals[b])), 1.0F);
    return static_cast<size_t>((1.0F - similarity) * (kSteps - 1));
  };
  std::array<size_t, kSteps + 1> starts{};
  for_each_link(graph, normals.size(), [&](uint32_t a, uint32_t b) { ++starts[step_of(a, b) + 1]; });
  for (size_t i = 0; i < kSteps; ++i) starts[i + 1] += starts[i];
  std::vector<Link> links(starts[kSteps]);
  for_each_link(graph, normals.size(), [&](uint32_t a, uint32_t b) { links[starts[step_of(a, b)]++] = {a, b}; });
  return links;
}

SignedForest spread_signs(const NeighbourGraph& graph, std::span<const glm::vec3> normals) {
  SignedForest forest(normals.size());
  for (const auto& [a, b] : sorted_links(graph, normals)) forest.join(a, b, glm::dot(normals[a], normals[b]) < 0);
  return forest;
}

/// The square of the distance to the farthest neighbour: in proportion to the area a site stands for.
double area_of(const Sites& sites, const NeighbourGraph& graph, size_t site) {
  const glm::dvec3 d = sites.positions[graph.of(site).back()] - sites.positions[site];
  return glm::dot(d, d);
}

/// Sums over the sites of one tree, weighted by area.
struct Tree {
  double area = 0;
  double towards = 0;      ///< agreement with the known directions
  glm::dvec3 centroid{0};  ///< times area
  glm::dvec3 normal{0};
  double volume = 0;  ///< n . (p - centroid): three times the enclosed volume (divergence theorem)
  double reach = 0;   ///< |p - centroid|: what `volume` would be on a sphere
  bool flip = false;
  bool trusted = false;
};

struct SignedTrees {
  std::vector<Tree> trees;
  std::vector<uint32_t> tree_of;  ///< index in `trees` for every site
};

/// Gives every site the sign it has relative to its tree's root, and numbers the trees.
SignedTrees number_trees(SignedForest& forest, std::vector<glm::vec3>& normals) {
  constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();
  SignedTrees signed_trees{{}, std::vector<uint32_t>(normals.size())};
  std::vector<uint32_t> number_of_root(normals.size(), kNone);
  for (uint32_t i = 0; i < normals.size(); ++i) {
    const auto [root, opposed] = forest.find(i);
    if (opposed) normals[i] = -normals[i];
    uint32_t& number = number_of_root[root];
    if (number == kNone) {
      number = static_cast<uint32_t>(signed_trees.trees.size());
      signed_trees.trees.emplace_back();
    }
    signed_trees.tree_of[i] = number;
  }
  return signed_trees;
}

void measure_trees(const Sites& sites, const NeighbourGraph& graph, std::span<const glm::vec3> towards,
                   std::span<const glm::vec3> normals, SignedTrees& signed_trees) {
  for (size_t i = 0; i < sites.size(); ++i) {
    Tree& tree = signed_trees.trees[signed_trees.tree_of[i]];
    const double area = area_of(sites, graph, i);
    tree.area += area;
    tree.towards += area * static_cast<double>(glm::dot(normals[i], towards[i]));
    tree.centroid += area * sites.positions[i];
    tree.normal += area * glm::dvec3(normals[i]);
  }
  for (size_t i = 0; i < sites.size(); ++i) {
    Tree& tree = signed_trees.trees[signed_trees.tree_of[i]];
    const glm::dvec3 from_centroid = sites.positions[i] - tree.centroid / tree.area;
    const double area = area_of(sites, graph, i);
    tree.volume += area * glm::dot(glm::dvec3(normals[i]), from_centroid);
    tree.reach += area * glm::length(from_centroid);
  }
}

/// What is known of a scene as a whole when the sign of a tree is decided.
struct Scene {
  bool z_up = false;
  bool may_be_room = false;  ///< at least twice as wide, both ways, as high: a closed surface may be seen from within
};

Scene describe_scene(const Sites& sites, bool z_up) {
  Box box;
  for (const glm::dvec3& p : sites.positions) box.include(p);
  const glm::dvec3 size = box.size();
  std::array<double, 3> sorted = {size.x, size.y, size.z};
  std::sort(sorted.begin(), sorted.end());
  return {z_up, z_up || 2 * sorted[0] <= sorted[1]};
}

/// Whether the tree is closed, or so nearly that its volume is sure. The normals of a closed surface sum to zero; what
/// they do sum to is the area of the holes, and a lid over them takes away about that times its distance.
bool encloses_volume(const Tree& tree) {
  const double holes = glm::length(tree.normal) / tree.area;
  const double fullness = std::abs(tree.volume) / tree.reach;
  return fullness > 0.1 && fullness > 2 * holes;
}

/// Decides the sign of one tree and whether that is more than a guess.
void decide(Tree& tree, const Scene& scene) {
  constexpr double kTerrain = 0.25;  // of the vote when all of the area faces up
  if (tree.towards != 0) {
    tree.flip = tree.towards < 0;
    tree.trusted = true;
  } else if (scene.z_up && std::abs(tree.normal.z) > kTerrain * tree.area) {
    tree.flip = tree.normal.z < 0;
    tree.trusted = true;
  } else if (tree.volume != 0) {
    tree.flip = tree.volume < 0;
    tree.trusted = !scene.may_be_room && encloses_volume(tree);
  } else {
    tree.flip = tree.normal.z < 0;
  }
}

/// Turns the trees; whether most of the area was decided by more than a guess.
bool apply_signs(SignedTrees& signed_trees, const Scene& scene, std::vector<glm::vec3>& normals) {
  double area = 0;
  double trusted = 0;
  for (Tree& tree : signed_trees.trees) {
    decide(tree, scene);
    area += tree.area;
    if (tree.trusted) trusted += tree.area;
  }
  for (size_t i = 0; i < normals.size(); ++i) {
    if (signed_trees.trees[signed_trees.tree_of[i]].flip) normals[i] = -normals[i];
  }
  return trusted >= 0.9 * area;
}

/// Turns the normals whose sign is known, each by itself. Whether that was all of them.
bool face_known(std::span<const glm::vec3> towards, std::vector<glm::vec3>& normals) {
  bool all = true;
  for (size_t i = 0; i < normals.size(); ++i) {
    if (glm::dot(normals[i], towards[i]) < 0) normals[i] = -normals[i];
    all = all && towards[i] != glm::vec3(0);
  }
  return all;
}

}  // namespace

bool signs_agree(const NeighbourGraph& graph, std::span<const glm::vec3> normals) {
  if (graph.degree == 0) return true;
  double agreement = 0;
  double conflict = 0;
  for_each_link(graph, normals.size(), [&](uint32_t a, uint32_t b) {
    const auto similarity = static_cast<double>(glm::dot(normals[a], normals[b]));
    (similarity < 0 ? conflict : agreement) += std::abs(similarity);
  });
  return conflict <= kMostConflict * (agreement + conflict);
}

bool orient_normals(const Sites& sites, const NeighbourGraph& graph, std::span<const glm::vec3> towards, bool z_up,
                    std::vector<glm::vec3>& normals) {
  if (face_known(towards, normals)) return true;
  if (graph.degree == 0) return false;
  SignedForest forest = spread_signs(graph, normals);
  SignedTrees trees = number_trees(forest, normals);
  measure_trees(sites, graph, towards, normals, trees);
  const bool decided = apply_signs(trees, describe_scene(sites, z_up), normals);
  face_known(towards, normals);
  if (decided && signs_agree(graph, normals)) return true;
  if (z_up) {
    for (size_t i = 0; i < normals.size(); ++i) {
      if (towards[i] == glm::vec3(0) && normals[i].z < 0) normals[i] = -normals[i];
    }
  }
  return false;
}

}  // namespace surfcast
