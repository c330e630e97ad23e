#include "geometry/morton_tree.h"

#include <bit>

#include "base/contract.h"

namespace surfcast::geometry {
namespace {

/// Where a run is split: at the first code that has the highest bit in which the codes of the run differ. A run of
/// equal codes is split in the middle.
uint32_t middle_of(std::span<const uint64_t> codes, const MortonTree::Run& run) {
  const uint64_t low = codes[run.first];
  const uint64_t differing = low ^ codes[run.last - 1];
  if (differing == 0) return run.first + (run.last - run.first) / 2;
  const uint64_t bit = std::bit_floor(differing);
  const uint64_t upper = (low & ~(bit - 1)) | bit;
  const auto begin = codes.begin() + run.first;
  const auto end = codes.begin() + run.last;
  return run.first + static_cast<uint32_t>(std::lower_bound(begin, end, upper) - begin);
}

}  // namespace

MortonTree::MortonTree(std::span<const glm::dvec3> points, std::span<const uint64_t> codes,
                       std::span<const float> reaches, size_t leaf)
    : points_(points), reaches_(reaches), leaf_(leaf) {
  SURFCAST_EXPECTS(!points.empty() && codes.size() == points.size() && leaf > 0);
  SURFCAST_EXPECTS(reaches.empty() || reaches.size() == points.size());
  nodes_.reserve(4 * points.size() / leaf + 1);
  build(codes, {0, static_cast<uint32_t>(points.size())});
}

Box MortonTree::box_of(const Run& run) const {
  Box box;
  for (uint32_t i = run.first; i < run.last; ++i) box.include(points_[i]);
  return box;
}

std::vector<MortonTree::Run> MortonTree::leaves() const {
  std::vector<Run> leaves;
  for (const Node& node : nodes_) {
    if (node.leaf) leaves.push_back(node.run);
  }
  return leaves;
}

void MortonTree::build(std::span<const uint64_t> codes, Run run) {
  const size_t index = nodes_.size();
  nodes_.emplace_back();
  Node node;
  node.run = run;
  node.leaf = run.last - run.first <= leaf_;
  if (node.leaf) {
    node.box = box_of(run);
    for (uint32_t i = run.first; i < run.last && !reaches_.empty(); ++i) {
      node.squared_reach = std::max(node.squared_reach, double{reaches_[i]} * double{reaches_[i]});
    }
  } else {
    const uint32_t middle = middle_of(codes, run);
    for (const Run& half : {Run{run.first, middle}, Run{middle, run.last}}) {
      const size_t child = nodes_.size();
      build(codes, half);
      node.box.include(nodes_[child].box);
      node.squared_reach = std::max(node.squared_reach, nodes_[child].squared_reach);
    }
  }
  node.next = static_cast<uint32_t>(nodes_.size());
  nodes_[index] = node;
}

}  // namespace surfcast::geometry
