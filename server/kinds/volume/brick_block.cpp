#include "volume/brick_block.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "geometry/box.h"
#include "volume/brick_coding.h"
#include "volume/packing.h"

namespace surfcast::volume {
namespace {

/// The axis-aligned box in the world around a box of indices.
geometry::Box world_box(const model::Volume& volume, const IndexBox& box) {
  geometry::Box world;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 index((corner & 1) != 0 ? box.high.x : box.low.x, (corner & 2) != 0 ? box.high.y : box.low.y,
                           (corner & 4) != 0 ? box.high.z : box.low.z);
    world.include(volume.index_to_world * glm::dvec4(index, 1));
  }
  return world;
}

/// Distance of neighbouring samples along the axis where it is largest, of the axes that have neighbours.
double largest_step(const model::Volume& volume) {
  const bool single = volume.samples() == 1;
  double step = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (volume.size[axis] > 1 || single) step = std::max(step, glm::length(volume.index_to_world[axis]));
  }
  return step;
}

float rounded_down(double value) {
  const auto rounded = static_cast<float>(value);
  return static_cast<double>(rounded) > value ? std::nextafter(rounded, -std::numeric_limits<float>::infinity())
                                              : rounded;
}

}  // namespace

surfel::Grid bounds_lattice(const model::Volume& volume) {
  const geometry::Box box = world_box(volume, volume_box(volume.size));
  const glm::dvec3 sides = box.max - box.min;
  const glm::dvec3 farthest = glm::max(glm::abs(box.min), glm::abs(box.max));
  const double side = std::max({sides.x, sides.y, sides.z});
  // Fine enough for the smallest brick, coarse enough for 30 bits, and no finer than doubles are there.
  const double finest = std::max({farthest.x, farthest.y, farthest.z}) * 0x1p-50;
  return {glm::dvec3(std::exp2(std::ceil(std::log2(std::max(side * 0x1p-28, finest))))), box.min};
}

model::EncodedBlock brick_block(const Brick& brick, const model::Volume& volume, const surfel::Grid& lattice) {
  const BrickHeader& header = brick.header;
  const geometry::Box box = world_box(volume, brick_box(volume.size, header.level, header.brick));
  const glm::dvec3 first = glm::floor((box.min - lattice.offset) / lattice.scale);
  const glm::dvec3 last = glm::ceil((box.max - lattice.offset) / lattice.scale);
  model::EncodedBlock block;
  block.kind = model::kGridKind;
  block.bytes = encode_brick(brick);
  block.grid = lattice;
  block.origin = glm::i64vec3(first);
  block.extent = glm::u32vec3(last - first);
  block.items = brick_items(header.count);
  // 1.08 as for surfels: selection compares spacings of all kinds.
  block.spacing = static_cast<float>(1.08 * std::ldexp(largest_step(volume), static_cast<int>(header.level)));
  block.max_radius = block.spacing;
  block.brick = {header.volume, header.level, header.brick, rounded_down(header.low), -rounded_down(-header.high)};
  return block;
}

ldc::OctreeKey brick_key(const glm::u32vec3& size, uint32_t level, const glm::u32vec3& brick) {
  return {static_cast<uint8_t>(level_count(size) - 1 - level), brick.x, brick.y, brick.z};
}

}  // namespace surfcast::volume
