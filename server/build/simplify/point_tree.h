#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace surfcast::simplify {

/// A point of a query and its squared distance.
struct Near {
  uint32_t point = 0;
  double square = 0;
};

/// Finds the points within a ball whose radius may be many spacings: scan/neighbours.h finds a fixed number. A binary
/// tree over the points, halved at the median of the longest side. Safe to call from several threads at once.
class PointTree {
 public:
  /// The points must outlive the tree.
  explicit PointTree(std::span<const glm::dvec3> points);

  /// Replaces `found` by the points within `radius` of `centre`, in a fixed order; with a stride by one in so many of
  /// them, evenly spread.
  void within(const glm::dvec3& centre, double radius, std::vector<Near>& found, uint32_t stride = 1) const;

 private:
  static constexpr uint32_t kLeaf = 16;

  struct Node {
    uint32_t first = 0;
    uint32_t end = 0;
    uint32_t children = 0;  ///< index of the first of two; 0: a leaf
    glm::dvec3 low{0};
    glm::dvec3 high{0};
  };

  void split(uint32_t node);

  std::span<const glm::dvec3> points_;
  std::vector<uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace surfcast::simplify
