#pragma once

#include <glm/mat4x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "residency/packed_block.h"
#include "volume/brick.h"
#include "volume/packing.h"

namespace surfcast::kinds {

/// The header of a block that is a brick of a volume (DrawnAs::kVolume). Its texels are those of volume::pack_brick.
class BrickBlock : public residency::BlockHeader {
 public:
  BrickBlock(const volume::Brick& brick, const glm::u32vec3& size, const glm::dmat4x3& index_to_world)
      : header_(brick.header), size_(size), index_to_world_(index_to_world), ranges_(volume::sub_brick_ranges(brick)) {}

  [[nodiscard]] const volume::BrickHeader& header() const { return header_; }
  /// Samples of the volume, and its place (model::Volume).
  [[nodiscard]] const glm::u32vec3& size() const { return size_; }
  [[nodiscard]] const glm::dmat4x3& index_to_world() const { return index_to_world_; }
  [[nodiscard]] const std::vector<volume::CodeRange>& sub_bricks() const { return ranges_; }

  /// Bricks are not projected.
  [[nodiscard]] glm::vec4 scale(int /*unit*/) const override { return glm::vec4(0); }
  void add_runs(const selection::RadiusRange& /*wanted*/, std::vector<residency::TexelRun>& /*runs*/) const override {}

 private:
  volume::BrickHeader header_;
  glm::u32vec3 size_;
  glm::dmat4x3 index_to_world_;
  std::vector<volume::CodeRange> ranges_;
};

}  // namespace surfcast::kinds
