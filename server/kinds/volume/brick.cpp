#include "volume/brick.h"

#include <algorithm>
#include <bit>
#include <glm/common.hpp>

#include "base/contract.h"

namespace surfcast::volume {
namespace {

uint32_t divided_up(uint32_t value, uint32_t by) {
  return value / by + (value % by != 0 ? 1 : 0);
}

/// Halvings after which one sample is left: ceil(log2 n).
uint32_t most_halvings(uint32_t samples) {
  return static_cast<uint32_t>(std::bit_width(samples - 1));
}

uint32_t halved(uint32_t samples, uint32_t times) {
  return ((samples - 1) >> times) + 1;
}

}  // namespace

uint32_t level_count(const glm::u32vec3& size) {
  SURFCAST_EXPECTS(size.x >= 1 && size.y >= 1 && size.z >= 1);
  const uint32_t bricks = divided_up(std::max({size.x, size.y, size.z}), kBrickSamples);
  return 1 + most_halvings(bricks);
}

glm::u32vec3 halvings(const glm::u32vec3& size, uint32_t level) {
  return {std::min(level, most_halvings(size.x)), std::min(level, most_halvings(size.y)),
          std::min(level, most_halvings(size.z))};
}

glm::u32vec3 level_size(const glm::u32vec3& size, uint32_t level) {
  const glm::u32vec3 times = halvings(size, level);
  return {halved(size.x, times.x), halved(size.y, times.y), halved(size.z, times.z)};
}

glm::u32vec3 level_bricks(const glm::u32vec3& size, uint32_t level) {
  const glm::u32vec3 samples = level_size(size, level);
  return {divided_up(samples.x, kBrickSamples), divided_up(samples.y, kBrickSamples),
          divided_up(samples.z, kBrickSamples)};
}

glm::u32vec3 brick_count(const glm::u32vec3& size, uint32_t level, const glm::u32vec3& brick) {
  return glm::min(level_size(size, level) - brick * kBrickSamples, glm::u32vec3(kBrickSamples));
}

glm::dvec3 source_index(const glm::u32vec3& size, uint32_t level, const glm::dvec3& index) {
  const glm::dvec3 step(glm::u32vec3(1) << halvings(size, level));
  return (index + 0.5) * step - 0.5;
}

IndexBox volume_box(const glm::u32vec3& size) {
  IndexBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.low[axis] = size[axis] == 1 ? -0.5 : 0;
    box.high[axis] = size[axis] == 1 ? 0.5 : static_cast<double>(size[axis] - 1);
  }
  return box;
}

IndexBox brick_box(const glm::u32vec3& size, uint32_t level, const glm::u32vec3& brick) {
  const IndexBox whole = volume_box(size);
  const glm::u32vec3 last = level_bricks(size, level) - 1U;
  const glm::dvec3 steps = glm::dvec3(glm::u32vec3(1) << halvings(size, level)) * static_cast<double>(kBrickSamples);
  IndexBox box{glm::dvec3(brick) * steps, glm::dvec3(brick + 1U) * steps};
  for (int axis = 0; axis < 3; ++axis) {
    if (brick[axis] == 0) box.low[axis] = whole.low[axis];
    if (brick[axis] == last[axis]) box.high[axis] = whole.high[axis];
  }
  return box;
}

}  // namespace surfcast::volume
