#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "geometry/camera.h"
#include "geometry/clip.h"
#include "kinds/brick_block.h"
#include "picture/transfer.h"
#include "render/region.h"
#include "residency/surfel_pool.h"
#include "shared/volume_layout.h"

namespace surfcast::render {

/// A resident brick.
struct VisibleBrick {
  const kinds::BrickBlock* block = nullptr;
  std::span<const uint32_t> pages;  ///< see ResidentBlock
};

/// What the pass over one volume reads.
struct VolumePlan {
  layout::VolumeConstants constants{};
  std::vector<layout::BrickView> bricks;
  std::vector<uint32_t> cells;  ///< see SURFCAST_UNIT_CELLS
  std::vector<uint32_t> pages;  ///< see SURFCAST_UNIT_PAGES
  std::vector<layout::VolumeClip> clips;
  std::vector<glm::uvec4> transfer;  ///< see TransferTable::sums
};

/// How volumes are drawn in one picture.
struct VolumeLook {
  std::vector<picture::TransferPoint> points;
  geometry::Clip clip;
  std::optional<double> spacing{};  ///< see Transfer::spacing
  double step = 1;                  ///< between places on a ray, in samples of a brick's level
};

/// The world's part of a volume: from the first to the last sample along every axis.
struct VolumePlace {
  glm::u32vec3 size{1};
  glm::dmat4x3 index_to_world{1.0};

  [[nodiscard]] glm::dmat3 axes() const;  ///< steps along i, j and k
  /// The distance to which opacities refer: the edge of a cube with the volume of a cell, world units.
  [[nodiscard]] double spacing() const;
};

/// Plans the drawing of the bricks of one volume, at least one, into the light of a region. The plan is the same for
/// every order of the bricks.
VolumePlan plan_volume(std::span<const VisibleBrick> bricks, const VolumeLook& look, const geometry::CameraFrame& frame,
                       const Region& region);

}  // namespace surfcast::render
