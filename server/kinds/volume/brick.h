#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "model/volume.h"

namespace surfcast::volume {

/// A volume is stored as levels of a pyramid, each cut into bricks. Level 0 has the samples of the source. Each further
/// level halves the axes that still have several samples; its samples are means of 2 x 2 x 2, where an odd last sample
/// counts twice. The last level is one brick. Brick b of an axis holds the samples 32 b to 32 b + 31 of its level, and
/// stands for the bricks 2 b and 2 b + 1 of the level below.
using model::kBrickSamples;
/// A brick repeats samples of its neighbours; at the faces of the volume the first and last samples are repeated. A
/// brick draws the source indices of its children. They begin up to half a sample before its own first sample, so cubic
/// reconstruction there reads two samples before it.
inline constexpr uint32_t kHaloBefore = 2;
inline constexpr uint32_t kHaloAfter = 2;
inline constexpr uint32_t kHalo = kHaloBefore + kHaloAfter;

/// Number of levels of a volume with `size` samples along its axes.
[[nodiscard]] uint32_t level_count(const glm::u32vec3& size);
/// How often each axis has been halved at a level.
[[nodiscard]] glm::u32vec3 halvings(const glm::u32vec3& size, uint32_t level);
/// Samples of a level along each axis.
[[nodiscard]] glm::u32vec3 level_size(const glm::u32vec3& size, uint32_t level);
/// Bricks of a level along each axis.
[[nodiscard]] glm::u32vec3 level_bricks(const glm::u32vec3& size, uint32_t level);
/// Samples of a brick along each axis, 1 to 32, without its halo.
[[nodiscard]] glm::u32vec3 brick_count(const glm::u32vec3& size, uint32_t level, const glm::u32vec3& brick);
/// The index in the source of a place in a level: sample i of a level lies at (i + 0.5) 2^h - 0.5, where h are the
/// halvings of the axis.
[[nodiscard]] glm::dvec3 source_index(const glm::u32vec3& size, uint32_t level, const glm::dvec3& index);

/// A box in indices of the source.
struct IndexBox {
  glm::dvec3 low{0};
  glm::dvec3 high{0};
};

/// What is drawn of a volume: from the first to the last sample of each axis. An axis with one sample extends half a
/// step to both sides.
[[nodiscard]] IndexBox volume_box(const glm::u32vec3& size);
/// What is drawn of a brick: 32 * 2^h steps of the source along each axis, within the volume. The boxes of a level fill
/// that of the volume, and the box of a brick is the union of those of its children.
[[nodiscard]] IndexBox brick_box(const glm::u32vec3& size, uint32_t level, const glm::u32vec3& brick);

/// Where a brick lies, and what its codes mean.
struct BrickHeader {
  uint32_t volume = 0;  ///< index into the table of volumes
  uint32_t level = 0;
  glm::u32vec3 brick{0};  ///< its index in its level
  glm::u32vec3 count{1};  ///< samples along each axis without the halo
  double offset = 0;      ///< value = offset + scale * code
  double scale = 0;
  double low = 0;  ///< least and largest value, those of the halo included
  double high = 0;

  [[nodiscard]] double value(uint16_t code) const { return offset + scale * static_cast<double>(code); }
};

/// Stored samples along each axis.
[[nodiscard]] inline glm::u32vec3 stored_size(const glm::u32vec3& count) {
  return count + kHalo;
}
[[nodiscard]] inline uint32_t stored_samples(const glm::u32vec3& count) {
  const glm::u32vec3 size = stored_size(count);
  return size.x * size.y * size.z;
}

struct Brick {
  BrickHeader header;
  /// Of the samples with their halo, stored_size(count) of them, i fastest, then j, then k. The first is sample
  /// -kHaloBefore of each axis.
  std::vector<uint16_t> codes;
};

}  // namespace surfcast::volume
