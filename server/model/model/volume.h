#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x3.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace surfcast::model {

/// The kind of the blocks of volumes. The module volume defines their bytes.
inline constexpr std::string_view kGridKind = "grid";

/// The directions of the axes x, y and z of the world of a volume, where its source states them: R or L, A or P, S for
/// right or left, anterior or posterior, superior.
enum class WorldFrame : uint8_t { kUnstated, kRas, kLas, kLps };
inline constexpr uint8_t kWorldFrames = 4;

inline constexpr size_t kHistogramBins = 1024;
/// Samples of a brick along each axis, without its halo.
inline constexpr uint32_t kBrickSamples = 32;
/// The octree has no room for longer axes.
inline constexpr uint32_t kMaxAxisSamples = kBrickSamples << 20;

/// A regular grid of samples. The samples themselves are in blocks of the kind "grid".
struct Volume {
  std::string name;
  glm::u32vec3 size{0};  ///< samples along i, j and k
  /// From sample indices (i, j, k) to the world: steps along the three axes, in world units, and the centre of sample
  /// (0, 0, 0).
  glm::dmat4x3 index_to_world{1.0};
  WorldFrame frame = WorldFrame::kUnstated;
  std::string length_unit;  ///< of the world, "mm" for example; empty if unknown
  std::string sample_unit;  ///< of values; empty if unknown
  uint8_t type = 0;         ///< of the source's samples, as ScalarColumn::type
  double slope = 1;         ///< value = slope * sample + intercept
  double intercept = 0;
  double low = 0;  ///< least and largest value; values that are not finite count as `low`
  double high = 0;
  /// Samples in kHistogramBins bins of equal width from `low` to `high`; `high` itself is in the last bin.
  std::vector<uint64_t> histogram;

  [[nodiscard]] uint64_t samples() const { return uint64_t{size.x} * size.y * size.z; }
};

/// The place of a block in its volume (volume/brick.h), and its range of values.
struct BrickRecord {
  uint32_t volume = 0;  ///< index into the table of volumes
  uint32_t level = 0;   ///< 0 is the source
  glm::u32vec3 brick{0};
  float low = 0;  ///< of all stored values, those of the halo included; rounded outwards
  float high = 0;
};

}  // namespace surfcast::model
