#pragma once

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include "selection/select_blocks.h"

namespace surfcast::testing {

inline ldc::BlockEntry block_at(const glm::dvec3& centre, double half_side, double spacing = 0.01) {
  ldc::BlockEntry block;
  block.bounds.include(centre - half_side);
  block.bounds.include(centre + half_side);
  block.spacing = spacing;
  block.max_radius = spacing;
  block.items = 1000;
  return block;
}

inline ldc::BlockEntry facing(ldc::BlockEntry block, const glm::vec3& axis, float half_angle) {
  block.normals = geometry::NormalCone{axis, half_angle};
  return block;
}

/// A view from `eye` along -z, 90 degrees, 100 x 100 pixels: eta is 50.
inline geometry::CameraFrame view_from(const glm::dvec3& eye) {
  return *geometry::make_camera_frame({eye, eye + glm::dvec3(0, 0, -1), {0, 1, 0}, 90}, 100, 100);
}

/// Adds children in a row along x, each with `1 / count` of the width and half the spacing. Returns the first.
inline uint32_t split(std::vector<ldc::BlockEntry>& blocks, uint32_t parent, int count, uint32_t surfels) {
  const auto first = static_cast<uint32_t>(blocks.size());
  const geometry::Box box = blocks[parent].bounds;
  const double width = box.size().x / count;
  for (int i = 0; i < count; ++i) {
    ldc::BlockEntry child = blocks[parent];
    child.parent = parent;
    child.bounds.min.x = box.min.x + i * width;
    child.bounds.max.x = child.bounds.min.x + width;
    child.spacing = child.max_radius = 0.5 * blocks[parent].spacing;
    child.items = surfels;
    blocks.push_back(child);
  }
  return first;
}

/// A random tree of octants. Each cell is divided at random, and some of its octants are empty.
inline std::vector<ldc::BlockEntry> random_tree(std::mt19937& random, int depth, bool oriented) {
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<ldc::BlockEntry> blocks{block_at({0, 0, 0}, 1, 0.1)};
  std::vector<int> depths{0};
  for (uint32_t i = 0; i < blocks.size(); ++i) {
    if (depths[i] == depth || (i > 0 && unit(random) < -0.3)) continue;
    for (int octant = 0; octant < 8; ++octant) {
      if (unit(random) < 0) continue;
      const geometry::Box box = blocks[i].bounds;
      const glm::dvec3 quarter = 0.25 * box.size();
      const glm::dvec3 side(octant & 1 ? 1 : -1, octant & 2 ? 1 : -1, octant & 4 ? 1 : -1);
      ldc::BlockEntry child = block_at(box.centre() + side * quarter, quarter.x, 0.5 * blocks[i].spacing);
      child.parent = i;
      child.items = 500 + static_cast<uint32_t>(random() % 16000);
      if (oriented) child = facing(child, glm::normalize(glm::vec3(unit(random), unit(random), unit(random))), 0.5F);
      blocks.push_back(child);
      depths.push_back(depths[i] + 1);
    }
  }
  return blocks;
}

/// True if neither the block nor any of its ancestors is culled.
inline bool in_view(const selection::SelectionTree& tree, const geometry::CameraFrame& frame, uint32_t block) {
  const selection::Frustum frustum(frame, -4, -4, frame.width + 4, frame.height + 4);
  for (uint32_t b = block; b != ldc::BlockEntry::kNoParent; b = tree.tree.blocks()[b].parent) {
    if (!selection::may_be_visible(tree.hulls[b], frustum, frame.eye)) return false;
  }
  return true;
}

/// The number of blocks of the cut that are `block` or one of its ancestors.
inline int times_covered(const selection::SelectionTree& tree, const std::vector<uint32_t>& cut, uint32_t block) {
  int times = 0;
  for (uint32_t b = block; b != ldc::BlockEntry::kNoParent; b = tree.tree.blocks()[b].parent) {
    times += std::binary_search(cut.begin(), cut.end(), b) ? 1 : 0;
  }
  return times;
}

}  // namespace surfcast::testing
