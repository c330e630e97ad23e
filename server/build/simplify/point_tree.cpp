#include "simplify/point_tree.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>

namespace surfcast::simplify {
namespace {

double squared_distance(const glm::dvec3& p, const glm::dvec3& low, const glm::dvec3& high) {
  const glm::dvec3 d = glm::max(glm::max(low - p, p - high), glm::dvec3(0));
  return glm::dot(d, d);
}

int longest_axis(const glm::dvec3& side) {
  if (side.x >= side.y && side.x >= side.z) return 0;
  return side.y >= side.z ? 1 : 2;
}

}  // namespace

PointTree::PointTree(std::span<const glm::dvec3> points) : points_(points), order_(points.size()) {
  std::iota(order_.begin(), order_.end(), 0U);
  nodes_.push_back({0, static_cast<uint32_t>(points.size())});
  for (uint32_t node = 0; node < nodes_.size(); ++node) split(node);
}

void PointTree::split(uint32_t number) {
  Node& node = nodes_[number];
  if (node.first == node.end) return;
  node.low = node.high = points_[order_[node.first]];
  for (uint32_t i = node.first; i < node.end; ++i) {
    node.low = glm::min(node.low, points_[order_[i]]);
    node.high = glm::max(node.high, points_[order_[i]]);
  }
  if (node.end - node.first <= kLeaf) return;
  const int axis = longest_axis(node.high - node.low);
  const uint32_t middle = node.first + (node.end - node.first) / 2;
  std::nth_element(order_.begin() + node.first, order_.begin() + middle, order_.begin() + node.end,
                   [&](uint32_t a, uint32_t b) {
                     return points_[a][axis] != points_[b][axis] ? points_[a][axis] < points_[b][axis] : a < b;
                   });
  const uint32_t end = node.end;
  const uint32_t first = node.first;
  node.children = static_cast<uint32_t>(nodes_.size());
  nodes_.push_back({first, middle});
  nodes_.push_back({middle, end});
}

void PointTree::within(const glm::dvec3& centre, double radius, std::vector<Near>& found, uint32_t stride) const {
  found.clear();
  const uint32_t leaf = kLeaf / 2 * stride;  // has about as many points of the stride as a leaf has points
  const double square = radius * radius;
  std::array<uint32_t, 128> waiting{};  // a path of halvings has at most 32 nodes, with one beside each
  size_t count = 1;
  while (count > 0) {
    const Node& node = nodes_[waiting.at(--count)];
    if (node.first == node.end || squared_distance(centre, node.low, node.high) > square) continue;
    if (node.children != 0 && node.end - node.first > leaf) {
      waiting.at(count++) = node.children + 1;
      waiting.at(count++) = node.children;
      continue;
    }
    for (uint32_t i = (node.first + stride - 1) / stride * stride; i < node.end; i += stride) {
      const glm::dvec3 d = points_[order_[i]] - centre;
      if (glm::dot(d, d) <= square) found.push_back({order_[i], glm::dot(d, d)});
    }
  }
}

}  // namespace surfcast::simplify
